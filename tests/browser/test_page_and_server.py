"""The page and the server that it comes from: what is pressed reaches the robot."""

from collections.abc import Callable, Iterator

import pytest
from browser_rig import let_in, page_words, take_the_turn
from console_rig import Rig, console
from playwright.sync_api import Browser, Page, expect
from test_page_drives import hold, until

from edgevox.core.commands import RunSkill, TextInput, Way
from edgevox.core.events import Decided, Responded, Transcribed
from edgevox.core.log import Said, get_logger
from edgevox.ops.logs import TurnLines

PATIENCE_MS = 60_000
log = get_logger("edgevox.tested_page")


@pytest.fixture
def rig(tmp_path) -> Iterator[Rig]:
    with console(tmp_path, follow_log=follow_log) as rig:
        yield rig


def follow_log(tell) -> Callable[[], None]:
    lines = TurnLines(tell)
    lines.open()
    return lines.close


@pytest.fixture
def page(browser: Browser, rig: Rig) -> Iterator[Page]:
    """Paired by the code of a link, as a phone is by the picture in the terminal."""
    context = browser.new_context(locale="en-GB", viewport={"width": 1440, "height": 900})
    context.set_default_timeout(PATIENCE_MS)
    broken: list[str] = []
    page = context.new_page()
    page.on("pageerror", lambda error: broken.append(str(error)))
    let_in(page, rig.server.offer_code()[1])
    yield page
    context.close()
    assert not broken


def test_stop_needs_no_turn_and_reaches_the_robot(page: Page, rig: Rig) -> None:
    page.keyboard.press("Space")
    assert rig.stop.engaged.wait(60)
    expect(page.locator(".stopped")).to_be_visible()


def test_words_reach_it_as_an_operators_and_come_back(page: Page, rig: Rig) -> None:
    page.locator(".write input").fill("go to the kitchen")
    page.locator(".write input").press("Enter")
    until(page, lambda: bool(rig.submitted))
    assert rig.submitted == [TextInput("go to the kitchen", Way.CONSOLE_OPERATOR)]
    rig.bus.publish(Transcribed("go to the kitchen", 1))
    rig.bus.publish(Decided((("navigate_to", {"room": "kitchen"}),), "template", 1.0, 1))
    rig.bus.publish(Responded("Going to the kitchen.", 1))
    expect(page.locator(".bubble.robots")).to_have_text("Going to the kitchen.")
    expect(page.locator(".why p")).to_have_text("navigate_to(kitchen) · by a template · 100 % sure")


def test_a_page_that_is_loaded_again_shows_the_last_turns(page: Page, rig: Rig) -> None:
    for turn in range(1, 23):
        rig.bus.publish(Transcribed(f"sentence {turn}", turn))
    expect(page.locator(".bubble.mine")).to_have_count(22)
    page.reload()
    expect(page.locator(".bubble.mine")).to_have_count(20)
    expect(page.locator(".bubble.mine").last).to_have_text("sentence 22")


def test_the_stick_steers_and_letting_go_halts(page: Page, rig: Rig) -> None:
    take_the_turn(page)
    hold(page)
    until(page, lambda: len(rig.robot.steered) >= 3)
    page.mouse.up()
    assert rig.robot.halted.wait(60)
    assert rig.robot.steered[0][0] > 0


def test_what_is_looked_at_comes(page: Page, rig: Rig) -> None:
    expect(page.locator(".facts")).to_contain_text("1.0, 2.0 m")


def test_a_browser_that_is_thrown_out_is_asked_for_a_code(page: Page, rig: Rig) -> None:
    (session,) = rig.server.sessions.all()
    rig.server.sessions.revoke(session.id)
    page.locator(".code").wait_for()


def test_the_log_of_this_turn_is_shown_and_no_words_of_people(page: Page, rig: Rig) -> None:
    expect(page.locator(".facts")).to_contain_text("1.0, 2.0 m")  # it looks
    log.warning("goal_failed", turn=1, skill="dance")
    log.warning("turn_slow", turn=2, text=Said("my secret"))
    log.warning("pairing", code="424242")
    log.warning("goal_failed", goal="7", skill="walk")
    page.locator(".side-switch [data-panel=know]").click()
    lines = page.get_by_role("heading", name="Log").locator("..").locator(".lines li")
    expect(lines).to_have_count(2)
    expect(lines.nth(0)).to_contain_text("goal_failed  skill=walk")
    expect(lines.nth(1)).to_contain_text("turn_slow  text=<9 characters>")


FORGET = {
    "name": "forget_place",
    "label": "forget a place",
    "lasting": True,
    "schema": {
        "type": "object",
        "properties": {"place": {"enum": ["charger", "shelf"]}},
        "required": ["place"],
    },
}


def test_what_forgets_chooses_nothing_by_itself_and_asks_first(browser: Browser, tmp_path) -> None:
    told = {"capabilities": {}, "skills": [FORGET]}
    with console(tmp_path, describe=lambda _: told) as rig:
        context = browser.new_context(locale="en-GB", viewport={"width": 1440, "height": 900})
        page = context.new_page()
        page.set_default_timeout(PATIENCE_MS)
        let_in(page, rig.server.offer_code()[1])
        take_the_turn(page)
        page.locator(".side-switch:visible .tab[data-panel=do]").click()
        run = page.get_by_role("button", name=f"{page_words('run')}: forget a place")
        asked = page.get_by_role("alertdialog")
        expect(page.get_by_label("place", exact=True)).to_have_value("")
        run.click()
        expect(asked).to_have_count(0)
        page.get_by_label("place", exact=True).select_option(label="shelf")
        run.click()
        expect(asked).to_contain_text("forget a place: shelf? This cannot be undone.")
        asked.get_by_role("button", name="No").click()
        assert rig.submitted == []
        run.click()
        asked.get_by_role("button", name="Yes").click()
        until(page, lambda: bool(rig.submitted))
        assert rig.submitted == [RunSkill("forget_place", {"place": "shelf"}, Way.CONSOLE_OPERATOR)]
        expect(page.locator(".recent button")).to_have_count(0)
        context.close()


def test_the_pairing_of_this_browser_is_given_up_only_when_it_was_asked(
    page: Page, rig: Rig
) -> None:
    page.locator(".tab[data-panel=settings]:visible").first.click()
    leave = page.get_by_role("button", name=page_words("log_out"))
    leave.click()
    asked = page.get_by_role("alertdialog")
    expect(asked.get_by_role("button", name="No")).to_be_focused()
    page.keyboard.press("Enter")
    expect(leave).to_be_focused()
    assert len(rig.server.sessions.all()) == 1
    leave.click()
    asked.get_by_role("button", name="Yes").click()
    until(page, lambda: rig.server.sessions.all() == [])
    page.locator(".code").wait_for()  # Chromium may hang where a page is closed that loads
