"""Stop works for anybody, from anywhere on the page, and stays until somebody resumes."""

import pytest
from browser_rig import PHONE, Opens
from playwright.sync_api import Page, expect
from stand_in import HELLO, Robot


def stopped(page: Page) -> None:
    expect(page.locator(".stopped")).to_be_visible(timeout=60_000)


def test_the_button_stops_at_the_press_and_says_who_did(opens: Opens, robot: Robot) -> None:
    page = opens()
    page.locator("button.stop").dispatch_event("pointerdown", {"button": 0})
    stopped(page)
    expect(page.locator(".stopped p")).to_contain_text("client-1")
    assert len(robot.commands("stop")) == 1


def test_one_click_is_one_stop(opens: Opens, robot: Robot) -> None:
    page = opens()
    page.locator("button.stop").click()
    stopped(page)
    page.locator(".resume").click()
    expect(page.locator(".stopped")).to_be_hidden()
    assert len(robot.commands("stop")) == 1


def test_a_viewer_without_the_turn_stops_too_and_cannot_resume(opens: Opens, robot: Robot) -> None:
    robot.hello = {**HELLO, "role": "viewer"}
    page = opens(command=False)
    page.locator("button.stop").click()
    stopped(page)
    expect(page.locator(".resume")).to_be_disabled()


def test_everybody_sees_it(opens: Opens, robot: Robot) -> None:
    first, second = opens(), opens(command=False)
    first.locator("button.stop").click()
    stopped(second)


@pytest.mark.parametrize("focus", ["button.stop", ".do-card .skill button", ".map", ".stick"])
def test_the_space_bar_stops_wherever_the_focus_is(opens: Opens, robot: Robot, focus: str) -> None:
    page = opens()
    page.locator(focus).first.focus()
    page.keyboard.press("Space")
    stopped(page)
    assert len(robot.commands("stop")) == 1
    assert not robot.commands("skill")


def test_the_space_bar_is_a_space_where_somebody_types(opens: Opens, robot: Robot) -> None:
    page = opens()
    words = page.locator(".write input")
    words.focus()
    page.keyboard.type("go to")
    expect(words).to_have_value("go to")
    page.keyboard.press("Enter")
    expect(words).to_have_value("")
    assert [one["text"] for one in robot.commands("text")] == ["go to"]
    assert not robot.commands("stop")


def test_the_button_is_in_sight_on_every_part_of_a_phone(opens: Opens, robot: Robot) -> None:
    page = opens(**PHONE)
    for part in ("talk", "see", "do", "know", "settings"):
        page.locator(f".tabs [data-panel={part}]").click()
        expect(page.locator("button.stop")).to_be_in_viewport(ratio=1)
    height = page.locator("button.stop").evaluate("e => e.getBoundingClientRect().height")
    assert height >= 56


def test_what_was_stopped_before_a_page_came_is_told_to_it(opens: Opens, robot: Robot) -> None:
    robot.hello = {**HELLO, "stop": {"engaged": True, "by": "Ada"}}
    page = opens(command=False)
    expect(page.locator(".stopped p")).to_contain_text("Ada")


@pytest.mark.parametrize("focus", [".resume", ".do-card .skill button", ".lease button.on"])
def test_a_space_bar_held_down_presses_nothing_when_it_is_let_go(
    opens: Opens, robot: Robot, focus: str
) -> None:
    robot.hello = {**HELLO, "stop": {"engaged": True, "by": "Ada"}}
    page = opens()
    page.locator(focus).first.focus()
    for _ in range(3):
        page.keyboard.down("Space")  # the second and third are the keyboard's own repeats
    page.keyboard.up("Space")
    sent = len(robot.commands("ping"))
    while len(robot.commands("ping")) < sent + 2:
        page.wait_for_timeout(20)
    assert len(robot.commands("stop")) == 1
    assert not robot.commands("resume")
    assert not robot.commands("skill")
    assert [one["action"] for one in robot.commands("lease")] == ["take"]


@pytest.mark.parametrize("focus", [".write input", "input[type=number]", ".skill select"])
def test_the_space_bar_stops_where_it_would_write_nothing(
    opens: Opens, robot: Robot, focus: str
) -> None:
    page = opens()
    page.locator(focus).first.focus()
    page.keyboard.press("Space")
    stopped(page)


@pytest.mark.parametrize("size", [(932, 430), (800, 390), (390, 420), (320, 256)])
@pytest.mark.parametrize("locale", ["de-DE", "ar-EG"])
def test_the_button_stays_in_sight_where_there_is_little_room(
    opens: Opens, robot: Robot, size: tuple[int, int], locale: str
) -> None:
    robot.hello = {**HELLO, "stop": {"engaged": True, "by": "Ada's old telephone in the kitchen"}}
    page = opens(locale=locale, viewport={"width": size[0], "height": size[1]}, has_touch=True)
    robot.silent = True
    page.locator("html[data-link=gone]").wait_for()
    button = page.locator("button.stop")
    expect(button).to_be_in_viewport(ratio=1)
    assert button.evaluate(
        "e => { const r = e.getBoundingClientRect();"
        " return [.1, .5, .9].every(at => e.contains(document.elementFromPoint("
        "r.left + r.width / 2, r.top + at * r.height))); }"
    )
