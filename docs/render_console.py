"""Talks to each robot on its console and takes pictures of the page: docs/images/console-*.webp.

Robots, server, page and browser are the real ones; the language model is left out. Chromium must be
there (Debian's). Takes some minutes.
"""

import re
import shutil
import tempfile
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from io import BytesIO
from pathlib import Path

from PIL import Image
from playwright.sync_api import Browser, Page, expect, sync_playwright

from edgevox.apps.agent.build import build_parts, start_parts
from edgevox.apps.console.build_context import build_context
from edgevox.apps.robots import build_body
from edgevox.console.console_server import ConsoleServer
from edgevox.core.settings import load_settings

IMAGES = Path(__file__).parent / "images"
DESK, PHONE = (1366, 800), (390, 800)
GAP_PX = 24
QUALITY = 80
LIMIT_MS = 60_000


@dataclass(frozen=True, slots=True)
class Robot:
    """A robot, what it is told, and how long it is watched before the picture."""

    name: str
    told: str
    watched_ms: int


ROBOTS = (
    Robot("robot-apartment", "go to the kitchen", 2500),
    Robot("robot-irsim", "go to the kitchen", 2500),
    Robot("robot-panda", "put the red cube into the right bin", 5000),
    Robot("robot-humanoid", "walk forward", 3000),
)


def main() -> None:
    """Take all pictures: a desk by day beside a phone by night, and the other way round."""
    with sync_playwright() as play:
        browser = play.chromium.launch(
            executable_path=shutil.which("chromium"), args=["--no-sandbox"]
        )
        for robot in ROBOTS:
            with served(robot.name) as address:
                desk, phone = pages(browser, address)
                tell(desk, robot)
                for scheme, other in (("light", "dark"), ("dark", "light")):
                    desk.emulate_media(color_scheme=scheme)  # type: ignore[arg-type]
                    phone.emulate_media(color_scheme=other)  # type: ignore[arg-type]
                    pictures = [Image.open(BytesIO(one.screenshot())) for one in (desk, phone)]
                    file = IMAGES / f"console-{robot.name.removeprefix('robot-')}-{scheme}.webp"
                    beside(pictures).save(file, quality=QUALITY)
        browser.close()


@contextmanager
def served(name: str) -> Iterator[str]:
    """A robot with its console on loopback; the address that pairs a browser."""
    with ExitStack() as stack:
        folder = Path(stack.enter_context(tempfile.TemporaryDirectory()))
        settings = load_settings({"text_mode": True, "llm": "none"})
        parts = build_parts(stack, settings, build_body(name, settings))
        start_parts(stack, parts)
        server = ConsoleServer(build_context(parts), folder)
        server.start()
        stack.callback(server.close)
        yield server.offer_code()[1]


def pages(browser: Browser, address: str) -> tuple[Page, Page]:
    """The page on a desk and on a phone, both let in by one pairing."""
    desk = browser.new_context(viewport={"width": DESK[0], "height": DESK[1]}).new_page()
    desk.goto(address)
    desk.get_by_role("button", name="Pair").click()
    desk.get_by_role("button", name="Take control").click(timeout=LIMIT_MS)
    phone = browser.new_context(
        viewport={"width": PHONE[0], "height": PHONE[1]},
        has_touch=True,
        storage_state=desk.context.storage_state(),
    ).new_page()
    phone.goto(address.partition("#")[0])
    expect(phone.get_by_role("button", name=re.compile("stop", re.IGNORECASE)).last).to_be_visible(
        timeout=LIMIT_MS
    )
    return desk, phone


def tell(desk: Page, robot: Robot) -> None:
    """Type it, and watch what happens."""
    words = desk.get_by_role("textbox", name=re.compile("type", re.IGNORECASE))
    words.fill(robot.told)
    words.press("Enter")
    expect(desk.get_by_text(robot.told, exact=True).first).to_be_visible(timeout=LIMIT_MS)
    desk.wait_for_timeout(robot.watched_ms)


def beside(pictures: list[Image.Image]) -> Image.Image:
    """Both in one picture, side by side, with nothing behind them."""
    width = sum(one.width for one in pictures) + GAP_PX
    sheet = Image.new("RGBA", (width, max(one.height for one in pictures)))
    left = 0
    for one in pictures:
        sheet.paste(one, (left, 0))
        left += one.width + GAP_PX
    return sheet


if __name__ == "__main__":
    main()
