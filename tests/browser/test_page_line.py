"""Honest when the robot is gone: grey within a second, nothing sent later, back by itself."""

from browser_rig import Opens, page_words
from playwright.sync_api import Browser, expect
from stand_in import CODE, Robot

HIDE = """hidden => {
  Object.defineProperty(document, 'hidden', { value: hidden, configurable: true });
  document.dispatchEvent(new Event('visibilitychange'));
}"""


def test_silence_greys_the_page_and_what_is_typed_then_is_never_sent(
    opens: Opens, robot: Robot
) -> None:
    page = opens()
    robot.silent = True
    page.locator("html[data-link=gone]").wait_for()
    expect(page.locator(".notice.bad").first).to_be_visible()
    page.locator(".write input").fill("go to the kitchen")
    page.locator(".write input").press("Enter")
    expect(page.locator(".notes")).to_contain_text("Not sent")
    robot.silent = False
    page.locator("html[data-link=ready]").wait_for()
    page.locator(".lease button.primary:visible, .lease button.on:visible").first.wait_for()
    assert not robot.commands("text")
    expect(page.locator(".write input")).to_have_value("go to the kitchen")


def test_a_silence_is_seen_within_a_second(opens: Opens, robot: Robot) -> None:
    page = opens(stopped_clock=True)
    robot.silent = True
    robot.tell(type="talk", kind="state", state="thinking")
    expect(page.locator(".chip.state")).to_have_text("thinking")  # the last that it hears
    state = page.locator("html")
    page.clock.run_for(500)
    expect(state).to_have_attribute("data-link", "ready")
    page.clock.run_for(500)
    expect(state).to_have_attribute("data-link", "gone")


def test_the_silence_of_a_page_that_is_seen_again_counts_from_then(
    opens: Opens, robot: Robot
) -> None:
    page = opens(stopped_clock=True)
    state = page.locator("html")
    robot.live = None
    robot.silent = True
    page.evaluate(HIDE, True)
    page.clock.run_for(60_000)
    expect(state).to_have_attribute("data-link", "ready")
    page.evaluate(HIDE, False)
    page.clock.run_for(500)
    expect(state).to_have_attribute("data-link", "ready")
    page.clock.run_for(500)
    expect(state).to_have_attribute("data-link", "gone")


def test_a_closed_line_comes_back_without_the_turn(opens: Opens, robot: Robot) -> None:
    page = opens()
    robot.drop()
    page.locator(".lease button.primary").wait_for()
    page.locator("html[data-link=ready]").wait_for()


def test_a_cookie_that_is_revoked_leads_to_the_pairing(opens: Opens, robot: Robot) -> None:
    page = opens()
    page.context.clear_cookies()
    robot.drop(4401)
    page.locator(".code").wait_for()


def test_pairing_by_code_and_a_wrong_one(browser: Browser, robot: Robot) -> None:
    page = browser.new_page(locale="en-GB")
    page.goto(robot.url)
    page.locator(".code").fill("111111")
    page.locator(".pair button.primary").click()
    expect(page.get_by_role("alert")).to_have_text(page_words("pair_wrong"))
    page.locator(".code").fill(CODE)
    page.locator(".pair button.primary").click()
    page.locator("html[data-link=ready]").wait_for()
    page.close()


def test_the_code_of_a_link_is_filled_in_and_needs_one_press(
    browser: Browser, robot: Robot
) -> None:
    page = browser.new_page(locale="en-GB")
    page.goto(f"{robot.url}/#pair={CODE}")
    page.locator(".pair button.primary").click()
    page.locator("html[data-link=ready]").wait_for()
    assert CODE not in page.url
    page.close()
