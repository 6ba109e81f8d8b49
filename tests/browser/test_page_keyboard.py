"""By keyboard and for readers: what is chosen is said, and what has the keyboard keeps it."""

import copy

import pytest
from browser_rig import PHONE, Opens, page_words
from playwright.sync_api import Locator, Page, expect
from stand_in import STATUS, Robot


def by_keyboard(page: Page, part: Locator) -> None:
    """Reach it without the pointer."""
    page.keyboard.press("Tab")
    part.focus()


@pytest.mark.parametrize(("bar", "device"), [("side-switch", {}), ("tabs", PHONE)])
def test_one_part_is_the_current_one_and_its_button_keeps_the_keyboard(
    opens: Opens, robot: Robot, bar: str, device: dict
) -> None:
    page = opens(**device)
    buttons = page.locator(f".{bar}:visible .tab")
    for part in ("know", "settings", "do"):
        chosen = page.locator(f".{bar} [data-panel={part}]")
        by_keyboard(page, chosen)
        page.keyboard.press("Enter")
        expect(page.locator(f".panel.{part}")).to_be_visible()
        expect(chosen).to_be_focused()
        current = [one.get_attribute("aria-current") for one in buttons.all()]
        assert sorted(current) == ["false"] * (len(current) - 1) + ["true"]
        expect(chosen).to_have_attribute("aria-current", "true")


def test_a_line_of_the_health_keeps_the_keyboard_and_stays_open_when_it_changes(
    opens: Opens, robot: Robot
) -> None:
    page = opens()
    page.locator(".side-switch [data-panel=know]").click()
    line = page.locator(".diagnostic", has_text="llm")
    line.locator("summary").focus()
    page.keyboard.press("Enter")
    told = copy.deepcopy(STATUS)
    told["diagnostics"][1] |= {"message": "works", "level": 0, "values": {"tokens_s": 30}}
    del told["diagnostics"][0]
    robot.tell(**told)
    expect(line.locator("summary")).to_contain_text(page_words("level_good"))
    expect(line).to_contain_text("30")
    expect(line.get_by_role("img")).to_have_attribute("aria-label", page_words("level_good"))
    expect(line.locator("summary")).to_be_focused()
    expect(page.locator(".diagnostic")).to_have_count(2)


def test_a_setting_keeps_the_keyboard_when_the_robot_tells_its_settings(
    opens: Opens, robot: Robot
) -> None:
    page = opens()
    page.locator(".side-switch [data-panel=settings]").click()
    muted = page.get_by_role("switch", name=page_words("muted"))
    muted.focus()
    robot.tell(type="controls", muted=True)
    expect(muted).to_have_attribute("aria-checked", "true")
    expect(muted).to_be_focused()


def test_taking_control_keeps_the_keyboard_on_control(opens: Opens, robot: Robot) -> None:
    page = opens(command=False)
    page.get_by_role("button", name=page_words("take_turn")).focus()
    page.keyboard.press("Enter")
    expect(page.get_by_role("button", name=page_words("you_command"))).to_be_focused()


def test_the_space_bar_presses_what_the_keyboard_has_reached(opens: Opens, robot: Robot) -> None:
    page = opens()
    by_keyboard(page, page.locator(".side-switch [data-panel=know]"))
    page.keyboard.press("Space")
    expect(page.locator(".panel.know")).to_be_visible()
    line = page.locator(".diagnostic", has_text="llm")
    line.locator("summary").focus()
    page.keyboard.press("Space")
    expect(line).to_have_attribute("open", "")
    assert not robot.commands("stop")


def test_the_space_bar_stops_where_there_is_nothing_to_press(opens: Opens, robot: Robot) -> None:
    page = opens()
    for count, part in enumerate((".map", ".stick", ".conversation", "button.stop"), 1):
        by_keyboard(page, page.locator(part))
        page.keyboard.press("Space")
        expect(page.locator(".stopped")).to_be_visible()
        assert len(robot.commands("stop")) == count, part
        page.locator(".resume").press("Enter")
        expect(page.locator(".stopped")).to_be_hidden()


def test_after_a_click_the_space_bar_stops_and_does_not_do_again_what_was_clicked(
    opens: Opens, robot: Robot
) -> None:
    page = opens()
    page.locator(".skill button").first.click()
    page.keyboard.press("Space")
    expect(page.locator(".stopped")).to_be_visible()
    assert len(robot.commands("skill")) == 1
    assert len(robot.commands("stop")) == 1
