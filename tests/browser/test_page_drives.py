"""The joystick: a beat while it is held, one zero when it is let go, nothing else."""

import time
from collections.abc import Callable

import pytest
from browser_rig import Opens, page_words, settled, stop_clock, take_the_turn
from guards import HUNG_S
from playwright.sync_api import Page, expect
from stand_in import Robot


def until(page: Page, true: Callable[[], bool]) -> None:
    deadline_s = time.monotonic() + HUNG_S
    while not true():
        assert time.monotonic() < deadline_s, "it did not come"
        page.wait_for_timeout(20)


def hold(page: Page, *, x: float = 0.5, y: float = 0.1) -> None:
    box = page.locator(".stick").bounding_box()
    assert box
    page.mouse.move(box["x"] + box["width"] / 2, box["y"] + box["height"] / 2)
    page.mouse.down()
    move(page, x=x, y=y)


def move(page: Page, *, x: float = 0.7, y: float = 0.2) -> None:
    """Move the stick if it is held."""
    box = page.locator(".stick").bounding_box()
    assert box
    page.mouse.move(box["x"] + x * box["width"], box["y"] + y * box["height"])


def still(robot: Robot) -> list[dict[str, object]]:
    return [d for d in robot.commands("drive") if not d["linear"] and not d["angular"]]


def drives(page: Page, robot: Robot) -> None:
    """Wait until the robot was told three times to drive."""
    until(page, lambda: len(robot.commands("drive")) >= 3)


def quiet(page: Page, robot: Robot) -> None:
    """Wait until three pings came, which is as long as many beats."""
    before = len(robot.commands("ping"))
    until(page, lambda: len(robot.commands("ping")) > before + 2)


def test_ahead_beats_and_letting_go_is_exactly_one_zero(opens: Opens, robot: Robot) -> None:
    page = opens()
    hold(page)
    until(page, lambda: sum(d["linear"] > 0.3 for d in robot.commands("drive")) >= 4)
    page.mouse.up()
    until(page, lambda: bool(robot.commands("drive")) and not robot.commands("drive")[-1]["linear"])
    quiet(page, robot)
    sent = robot.commands("drive")
    assert still(robot) == sent[-1:]
    assert max(abs(d["linear"]) for d in sent) <= 0.5


def test_the_top_speed_is_a_part_of_the_robots_and_this_browser_remembers_it(
    opens: Opens, robot: Robot
) -> None:
    page = opens()
    speed = page.get_by_role("slider", name=page_words("top_speed"))
    expect(speed).to_have_attribute("aria-valuetext", "0.50 m/s")
    speed.fill("0.25")
    expect(speed).to_have_attribute("aria-valuetext", "0.13 m/s")
    page.reload()
    take_the_turn(page)
    expect(speed).to_have_value("0.25")
    page.locator(".stick").focus()
    page.keyboard.down("ArrowUp")
    drives(page, robot)
    page.keyboard.down("ArrowLeft")
    until(page, lambda: robot.commands("drive")[-1]["angular"] > 0)
    page.keyboard.up("ArrowUp")
    until(page, lambda: not robot.commands("drive")[-1]["linear"])
    assert {one["linear"] for one in robot.commands("drive")} == {0.125, 0}
    assert {one["angular"] for one in robot.commands("drive")} == {0.25, 0}


@pytest.mark.parametrize("kept", ["4", "-1", "0", "fast"])
def test_the_stick_never_asks_for_more_than_the_robots_speed(
    opens: Opens, robot: Robot, kept: str
) -> None:
    page = opens()
    page.evaluate("kept => localStorage.setItem('edgevox-stick', kept)", kept)
    page.reload()
    take_the_turn(page)
    page.locator(".stick").focus()
    page.keyboard.down("ArrowUp")
    drives(page, robot)
    assert {one["linear"] for one in robot.commands("drive")} == {0.5}


def test_back_in_its_middle_the_stick_is_let_go_once(opens: Opens, robot: Robot) -> None:
    page = opens()
    hold(page)
    drives(page, robot)
    hold(page, y=0.5)
    until(page, lambda: bool(still(robot)))
    quiet(page, robot)
    page.mouse.up()
    quiet(page, robot)
    assert still(robot) == robot.commands("drive")[-1:]


def test_the_stick_stands_still_when_a_goal_or_what_is_known_of_the_robot_comes_or_goes(
    opens: Opens, robot: Robot
) -> None:
    robot.live = {}
    page = opens()
    before = page.locator(".stick").bounding_box()
    robot.live = {
        "goal": {"distance": 3.0, "progress": 0.5},
        "velocity": {"linear": 0.3, "angular": 0.0},
        "pose": {"x": 1.0, "y": 2.0, "heading": 0.0},
        "hand": {"open": True, "holding": ""},
    }
    page.locator(".goal").wait_for()
    assert page.locator(".fact").count() == 3
    assert page.locator(".stick").bounding_box() == before
    robot.live = {}
    page.locator(".goal").wait_for(state="hidden")
    assert page.locator(".stick").bounding_box() == before


def test_a_held_stick_asks_for_the_same_while_a_question_moves_it(
    opens: Opens, robot: Robot
) -> None:
    page = opens()
    hold(page)
    drives(page, robot)
    before = page.locator(".stick").bounding_box()
    robot.tell(type="talk", kind="asked", turn=1, text="Shall I go?", open=True)
    page.locator(".question").wait_for()
    assert page.locator(".stick").bounding_box() != before
    page.mouse.move(before["x"] + before["width"] / 2, before["y"] + 0.1 * before["height"] + 1)
    count = len(robot.commands("drive"))
    until(page, lambda: len(robot.commands("drive")) > count + 2)
    page.mouse.up()
    assert all(one["linear"] > 0.3 for one in robot.commands("drive")[: count + 2])


def test_a_press_that_was_aimed_at_what_has_just_moved_away_is_none_but_stop_always_is_one(
    opens: Opens, robot: Robot
) -> None:
    page = opens()
    page.clock.install()
    stop_clock(page)
    robot.tell(type="talk", kind="asked", turn=1, text="Shall I go?", open=True)
    yes = page.get_by_role("button", name=page_words("yes"))
    yes.click()
    hold(page)
    page.mouse.up()
    page.locator("button.stop").click()
    until(page, lambda: bool(robot.commands("stop")))
    page.locator(".resume").click()
    page.clock.run_for(500)
    settled(page)
    yes.click()
    until(page, lambda: bool(robot.commands("answer")))
    assert len(robot.commands("answer")) == 1
    assert not robot.commands("resume")
    assert not robot.commands("drive")


def test_lost_focus_halts(opens: Opens, robot: Robot) -> None:
    page = opens()
    hold(page)
    drives(page, robot)
    page.evaluate("window.dispatchEvent(new Event('blur'))")
    until(page, lambda: bool(still(robot)))
    assert robot.commands("drive")[-1] == still(robot)[-1]


def test_arrow_keys_drive_while_they_are_down(opens: Opens, robot: Robot) -> None:
    page = opens()
    page.locator(".stick").focus()
    page.keyboard.down("ArrowUp")
    drives(page, robot)
    page.keyboard.up("ArrowUp")
    until(page, lambda: len(still(robot)) == 1)
    assert all(d["linear"] == 0.5 and d["angular"] == 0 for d in robot.commands("drive")[:-1])


def test_nothing_is_sent_without_the_turn(opens: Opens, robot: Robot) -> None:
    page = opens(command=False)
    robot.tell(type="lease", holder="x", name="Ada", mine=False, waiting=[])
    page.locator(".joystick.disabled").wait_for()
    hold(page)
    quiet(page, robot)
    page.mouse.up()
    assert not robot.commands("drive")
    assert not robot.commands("lease")


def test_a_stick_that_is_held_does_not_take_back_what_was_given_away(
    opens: Opens, robot: Robot
) -> None:
    page = opens()
    hold(page)
    drives(page, robot)
    robot.tell(type="lease", holder=None, name=None, mine=False, waiting=[])
    until(page, lambda: bool(still(robot)))
    count = len(robot.commands("drive"))
    move(page)
    quiet(page, robot)
    assert len(robot.commands("drive")) == count
    assert [one["action"] for one in robot.commands("lease")] == ["take"]


def test_a_stop_lets_go_of_the_stick(opens: Opens, robot: Robot) -> None:
    page = opens()
    hold(page)
    drives(page, robot)
    robot.tell(type="stop", engaged=True, by="Ada")
    until(page, lambda: bool(still(robot)))
    count = len(robot.commands("drive"))
    quiet(page, robot)
    assert len(robot.commands("drive")) == count


def test_a_robot_that_falls_silent_gets_no_more_than_a_few(opens: Opens, robot: Robot) -> None:
    page = opens()
    hold(page)
    drives(page, robot)
    robot.silent = True
    sent = len(robot.commands("drive"))
    page.locator("html[data-link=gone]").wait_for()
    assert len(robot.commands("drive")) <= sent + 5


def test_a_key_let_go_with_shift_halts(opens: Opens, robot: Robot) -> None:
    page = opens()
    page.locator(".stick").focus()
    page.keyboard.down("w")
    drives(page, robot)
    page.keyboard.down("Shift")
    page.keyboard.up("W")
    quiet(page, robot)
    assert still(robot) == robot.commands("drive")[-1:]


def test_the_pressed_button_let_go_under_another_halts(opens: Opens, robot: Robot) -> None:
    page = opens()
    hold(page)
    drives(page, robot)
    page.mouse.down(button="right")
    page.mouse.up()
    quiet(page, robot)
    assert still(robot) == robot.commands("drive")[-1:]


def test_after_lost_focus_a_stick_that_is_still_held_drives_no_more(
    opens: Opens, robot: Robot
) -> None:
    page = opens()
    hold(page)
    drives(page, robot)
    page.evaluate("window.dispatchEvent(new Event('blur'))")
    until(page, lambda: bool(still(robot)))
    count = len(robot.commands("drive"))
    page.mouse.move(5, 5)
    quiet(page, robot)
    assert len(robot.commands("drive")) == count


def test_after_a_stop_is_over_a_stick_that_is_still_held_drives_no_more(
    opens: Opens, robot: Robot
) -> None:
    page = opens()
    hold(page)
    drives(page, robot)
    robot.tell(type="stop", engaged=True, by="Ada")
    until(page, lambda: bool(still(robot)))
    count = len(robot.commands("drive"))
    robot.tell(type="stop", engaged=False)
    page.mouse.move(5, 5)
    quiet(page, robot)
    assert len(robot.commands("drive")) == count


def test_a_stick_takes_a_free_robot_and_drives_when_it_is_pressed_again(
    opens: Opens, robot: Robot
) -> None:
    page = opens(command=False)
    hold(page)
    page.locator(".lease button.on").wait_for()
    move(page)
    quiet(page, robot)
    assert not robot.commands("drive")
    page.mouse.up()
    hold(page)
    drives(page, robot)


def test_a_key_takes_a_free_robot_and_drives_when_it_is_pressed_again(
    opens: Opens, robot: Robot
) -> None:
    page = opens(command=False)
    page.locator(".stick").focus()
    page.keyboard.down("ArrowUp")
    page.locator(".lease button.on").wait_for()
    page.keyboard.down("ArrowLeft")
    until(page, lambda: bool(robot.commands("drive")))
    assert not any(d["linear"] for d in robot.commands("drive"))


def test_a_stick_pressed_during_a_stop_drives_only_when_it_is_pressed_again(
    opens: Opens, robot: Robot
) -> None:
    page = opens()
    robot.tell(type="stop", engaged=True, by="Ada")
    page.locator(".resume").wait_for()
    hold(page)
    robot.tell(type="stop", engaged=False)
    page.locator(".resume").wait_for(state="hidden")
    move(page)
    quiet(page, robot)
    assert not any(d["linear"] or d["angular"] for d in robot.commands("drive"))


def test_a_stop_from_elsewhere_says_to_let_go_and_the_stick_drives_when_it_is_pressed_again(
    opens: Opens, robot: Robot
) -> None:
    page = opens()
    hold(page)
    drives(page, robot)
    robot.answers["drive"] = {"reason": "let_go", "message": "stopped: release the stick"}
    page.locator(".toast", has_text="Stopped: release the stick.").first.wait_for()
    quiet(page, robot)
    count = len(robot.commands("drive"))
    move(page)
    quiet(page, robot)
    assert len(robot.commands("drive")) == count, "it is held on, and sends nothing"

    del robot.answers["drive"]
    page.mouse.up()
    until(page, lambda: not robot.commands("drive")[-1]["linear"])
    count = len(robot.commands("drive"))
    hold(page)
    until(page, lambda: any(d["linear"] for d in robot.commands("drive")[count:]))
