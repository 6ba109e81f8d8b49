"""Takes pictures of the page in every state on every size, for a person: `make page-sheets`.

The robot is the stand-in of the page's tests, which can be in every state at once.
"""

import argparse
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from io import BytesIO
from pathlib import Path

from browser_rig import PHONE
from PIL import Image, ImageDraw
from playwright.sync_api import Browser, Page, sync_playwright
from sound_rig import launch
from stand_in import CODE, SKILLS, Robot

from edgevox.agent.phrases.load import phrasebook

NAME = "robot-apartment-2"
PEER = "Anna's phone"
GAP_PX, TITLE_PX, ACROSS_PX = 16, 18, 2400
DRAWN_MS = 700
"""What moves on the page has come to rest."""


@dataclass(frozen=True)
class Look:
    """A window, and how its person reads."""

    name: str
    window: dict
    language: str = "en-GB"
    dark: bool = False
    text: int = 100


SIDE = {**PHONE, "viewport": {"width": 844, "height": 390}}
TABLET = {"viewport": {"width": 768, "height": 1024}, "has_touch": True}
LAPTOP, DESK = ({"viewport": {"width": w, "height": h}} for w, h in ((1024, 768), (1440, 900)))
LOOKS = (
    Look("phone", PHONE),
    Look("phone-dark", PHONE, dark=True),
    Look("phone-de", PHONE, "de-DE"),
    Look("phone-ar", PHONE, "ar", dark=True),
    Look("phone-200", PHONE, text=200),
    Look("side", SIDE),
    Look("side-ar", SIDE, "ar"),
    Look("tablet", TABLET),
    Look("laptop", LAPTOP, dark=True),
    Look("desk", DESK),
    Look("desk-dark-de", DESK, "de-DE", dark=True),
    Look("desk-ar", DESK, "ar"),
)


def part(name: str) -> Callable[[Page, Robot], None]:
    def show(page: Page, _: Robot) -> None:
        for one in page.locator(f".tab[data-panel={name}]").all():
            if one.is_visible():
                one.click()
                return

    return show


def other_has_control(page: Page, robot: Robot) -> None:
    robot.tell(type="lease", holder="x", name=PEER, mine=False, waiting=[])


def asked_for_control(page: Page, robot: Robot) -> None:
    page.locator(".lease button.primary").click()
    page.locator(".lease button.on").wait_for()
    waiting = [{"client": "y", "name": PEER}]
    robot.tell(type="lease", holder="me", name="me", mine=True, waiting=waiting)
    page.locator(".lease button.on").click()


def asks_back(page: Page, robot: Robot) -> None:
    robot.tell(type="talk", kind="asked", turn=9, text="Shall I go to the kitchen?", open=True)


def stopped(page: Page, robot: Robot) -> None:
    robot.tell(type="stop", engaged=True, by=PEER, since=1_764_400_000.0)


def all_at_once(page: Page, robot: Robot) -> None:
    other_has_control(page, robot)
    robot.tell(type="recording", running=True)
    asks_back(page, robot)
    stopped(page, robot)


def point_of_the_map(page: Page, robot: Robot) -> None:
    part("see")(page, robot)
    page.locator(".map").click()


def stop_lost(page: Page, robot: Robot) -> None:
    robot.silent = True
    page.locator("html[data-link=gone]").wait_for()
    page.locator("button.stop").dispatch_event("pointerdown", {"button": 0})


STATES: dict[str, Callable[[Page, Robot], None]] = {
    **{name: part(name) for name in ("talk", "see", "do", "know", "settings")},
    "point": point_of_the_map,
    "other": other_has_control,
    "asked": asked_for_control,
    "question": asks_back,
    "stopped": stopped,
    "all": all_at_once,
    "lost": stop_lost,
}


def decided(skill: str, **arguments: str) -> tuple[str, dict]:
    calls = [{"skill": skill, "arguments": arguments}]
    return "decided", {"calls": calls, "stage": "template", "confidence": 1.0}


TALK = [
    ("heard", {"text": "where are you?"}),
    decided("get_pose"),
    ("response", {"text": "I am in the living room."}),
    ("heard", {"text": "go to the kitchen", "confidence": 0.93}),
    decided("navigate_to", room="kitchen"),
    ("response", {"text": "I am on my way to the kitchen."}),
]


def main() -> None:
    """Take them all, or only some."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--looks", nargs="*", default=[one.name for one in LOOKS])
    parser.add_argument("--states", nargs="*", default=["pair", "first", *STATES])
    arguments = parser.parse_args()
    arguments.folder.mkdir(parents=True, exist_ok=True)
    with sync_playwright() as playwright:
        browser = launch(playwright)
        for look in LOOKS:
            if look.name in arguments.looks:
                taken = [(name, taken_of(browser, look, name)) for name in arguments.states]
                sheet_of(taken).save(arguments.folder / f"{look.name}.png")
        browser.close()


def told_in(language: str) -> dict:
    """What the robot tells of its skills in a language: one of them is its own, in English."""
    phrases = phrasebook(language)
    rooms = SKILLS[0]["schema"]["properties"]["room"]["enum"]
    word = {one: phrases.without_article(str(phrases.word(one))) for one in rooms}
    own = {"label": phrases.skills["navigate_to"].can, "language": language, "description": ""}
    skills = [{**SKILLS[0], **own}, *({**one, "language": "en"} for one in SKILLS[1:])]
    room = phrases.without_article(phrases.arguments["room"])
    return {"skills": skills, "words": word, "arguments": {"room": f"{room[:1].upper()}{room[1:]}"}}


def taken_of(browser: Browser, look: Look, state: str) -> Image.Image:
    """The page in this state, as this person sees it."""
    with Robot() as robot, window(browser, look) as page:
        robot.hello["robot"] = NAME
        robot.hello |= told_in(look.language[:2])
        robot.hello["talk"] = [
            {"type": "talk", "kind": kind, "turn": 1 + at // 3, **told}
            for at, (kind, told) in enumerate(TALK)
        ]
        if state != "pair":
            page.context.add_cookies([{"name": "edgevox", "value": CODE, "url": robot.url}])
        page.goto(robot.url + {"pair": f"/#pair={CODE}&phone", "first": "/#phone"}.get(state, ""))
        page.locator(
            ".pair, html[data-link=ready] .first, html[data-link=ready] .talk-card"
        ).first.wait_for()
        page.evaluate("size => document.documentElement.style.fontSize = size", f"{look.text}%")
        if state in STATES:
            STATES[state](page, robot)
        page.wait_for_timeout(DRAWN_MS)
        return Image.open(BytesIO(page.screenshot()))


@contextmanager
def window(browser: Browser, look: Look) -> Iterator[Page]:
    """A browser of its own."""
    scheme = "dark" if look.dark else "light"
    context = browser.new_context(locale=look.language, color_scheme=scheme, **look.window)
    yield context.new_page()
    context.close()


def sheet_of(pictures: list[tuple[str, Image.Image]]) -> Image.Image:
    """All of them in rows, each below its name."""
    across = max(1, ACROSS_PX // (pictures[0][1].width + GAP_PX))
    wide, high = (size + GAP_PX for size in pictures[0][1].size)
    rows = -(-len(pictures) // across)
    sheet = Image.new(
        "RGB", (min(across, len(pictures)) * wide, rows * (high + TITLE_PX)), "#808080"
    )
    draw = ImageDraw.Draw(sheet)
    for at, (name, picture) in enumerate(pictures):
        left, top = at % across * wide, at // across * (high + TITLE_PX)
        draw.text((left + GAP_PX // 2, top + 2), name, fill="white")
        sheet.paste(picture, (left + GAP_PX // 2, top + TITLE_PX))
    return sheet


if __name__ == "__main__":
    main()
