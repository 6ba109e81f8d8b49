"""A phone, upright and on its side: name, control, Stop, its banner and a question stay there."""

import re
from itertools import combinations

import pytest
from browser_rig import PHONE, Opens, page_words, settled
from playwright.sync_api import Page, expect
from stand_in import Robot
from test_page_drives import until

NAME = "robot-apartment-of-the-second-floor"
PARTS = ("talk", "see", "do", "know", "settings")
SIDE = {**PHONE, "viewport": {"width": 844, "height": 390}}
UPRIGHT = pytest.param(PHONE, id="upright")
ON_ITS_SIDE = pytest.param(SIDE, id="on its side")
LETTERS = """(name, count) => {
    const range = document.createRange();
    range.setStart(name.firstChild, 0);
    range.setEnd(name.firstChild, count);
    return range.getBoundingClientRect().width; }"""


def busy(page: Page, robot: Robot, *, name: str = "Chrome Linux of the second floor") -> None:
    """All at once: another operator, a recording, a question, a stop."""
    robot.tell(type="lease", holder="x", name=name, mine=False, waiting=[])
    robot.tell(type="recording", running=True)
    robot.tell(type="talk", kind="asked", turn=1, text="Shall I go to the kitchen?", open=True)
    robot.tell(type="stop", engaged=True, by=name, since=1.0)
    expect(page.locator(".stopped")).to_be_visible()
    settled(page)


def reachable(page: Page, part: str) -> None:
    """It can be brought into the window, and takes the press there."""
    page.locator(part).click(trial=True)


def unshifted(page: Page) -> None:
    """Nothing has moved aside, nor can be moved."""
    moved = """() => [...document.querySelectorAll("html, body, .shell")].map((e) => {
        e.scrollLeft = 999;
        return e.scrollLeft; })"""
    assert page.evaluate(moved) == [0, 0, 0]


@pytest.mark.parametrize("device", [UPRIGHT, ON_ITS_SIDE])
def test_stop_its_banner_and_the_question_stand_in_every_part(
    opens: Opens, robot: Robot, device: dict
) -> None:
    page = opens(**device, command=False)
    busy(page, robot)
    for part in PARTS:
        page.locator(f".tabs [data-panel={part}]").click()
        for shown in ("button.stop", ".resume", ".question button.primary"):
            expect(page.locator(shown)).to_be_in_viewport(ratio=1)
    page.get_by_role("button", name=page_words("yes")).click()
    until(page, lambda: [one["yes"] for one in robot.commands("answer")] == [True])


@pytest.mark.parametrize("device", [UPRIGHT, ON_ITS_SIDE])
def test_the_robots_name_keeps_eight_letters_and_control_of_it_its_place(
    opens: Opens, robot: Robot, device: dict
) -> None:
    robot.hello["robot"] = NAME
    page = opens(**device, command=False)
    busy(page, robot)
    name = page.locator("h1")
    assert name.bounding_box()["width"] >= name.evaluate(LETTERS, 8)
    ask = page.locator(".lease").get_by_role("button", name=page_words("ask_turn"))
    expect(ask).to_be_in_viewport(ratio=1)
    ask.click()
    unshifted(page)


@pytest.mark.parametrize("device", [UPRIGHT, ON_ITS_SIDE])
def test_text_of_twice_its_size_keeps_everything_in_reach(
    opens: Opens, robot: Robot, device: dict
) -> None:
    robot.hello["robot"] = NAME
    page = opens(**device, command=False)
    page.evaluate("document.documentElement.style.fontSize = '200%'")
    name = page.locator("h1")
    assert name.bounding_box()["width"] >= name.evaluate(LETTERS, 8)
    for shown in (
        ".lease button.primary",
        ".write input",
        ".write button",
        ".sound .round >> nth=1",
    ):
        reachable(page, shown)
    busy(page, robot)
    page.locator(".lease").get_by_role("button", name=page_words("ask_turn")).click(trial=True)
    page.get_by_role("button", name=page_words("no")).click(trial=True)
    page.locator(".resume").scroll_into_view_if_needed()
    for part in PARTS:
        reachable(page, f".tabs [data-panel={part}]")
        expect(page.locator("button.stop")).to_be_in_viewport(ratio=1)
    unshifted(page)


@pytest.mark.parametrize("device", [UPRIGHT, ON_ITS_SIDE])
def test_a_tapped_point_stays_in_sight_above_what_can_be_done_with_it(
    opens: Opens, device: dict
) -> None:
    page = opens(**device)
    page.locator(".tabs [data-panel=see]").click()
    page.locator(".facts .fact").first.wait_for()
    map_, sheet = page.locator(".map"), page.locator(".tap-sheet")

    def tapped(y_px: float) -> list[float]:
        map_.click(position={"x": size["width"] / 2, "y": y_px})
        told = re.findall(r"[\d.]+", sheet.locator("strong").inner_text())
        return [float(one) for one in told]

    size = map_.bounding_box()
    low = size["height"] - 40
    point = pytest.approx(tapped(low), abs=0.05)
    above = sheet.bounding_box()["y"] - size["y"] - 12
    assert 31 < above < low, "the pin has its place, and the sheet covers where it was"
    assert tapped(above) == point
    page.keyboard.press("Escape")
    expect(sheet).to_be_hidden()
    assert tapped(low) == point, "the map stands where it did"


@pytest.mark.parametrize("device", [UPRIGHT, ON_ITS_SIDE])
def test_map_stick_microphone_and_stop_stand_beside_each_other(opens: Opens, device: dict) -> None:
    page = opens(**device)
    page.locator(".tabs [data-panel=see]").click()
    boxes = []
    for shown in (".map", ".stick", ".steer .hold", "button.stop"):
        expect(page.locator(shown)).to_be_in_viewport(ratio=1)
        boxes.append(page.locator(shown).bounding_box())
    assert min(boxes[0]["width"], boxes[0]["height"]) > 200
    for one, other in combinations(boxes, 2):
        assert any(
            first[start] + first[size] <= then[start]
            for start, size in (("x", "width"), ("y", "height"))
            for first, then in ((one, other), (other, one))
        )
