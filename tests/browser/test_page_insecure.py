"""A page by plain HTTP, not on the robot itself: it says why it neither hears nor is heard."""

from browser_rig import DESK, PATIENCE_MS, page_words, take_the_turn
from playwright.sync_api import Playwright, expect
from sound_rig import launch
from stand_in import CODE, Robot
from test_page_drives import until


def test_without_https_it_says_that_neither_microphone_nor_voice_comes(
    playwright: Playwright, robot: Robot
) -> None:
    elsewhere = robot.url.replace("127.0.0.1", "robot.example")
    browser = launch(playwright, "--host-resolver-rules=MAP robot.example 127.0.0.1")
    context = browser.new_context(locale="en-GB", **DESK)
    context.set_default_timeout(PATIENCE_MS)
    context.add_cookies([{"name": "edgevox", "value": CODE, "url": elsewhere}])
    page = context.new_page()
    page.goto(elsewhere)
    page.locator("html[data-link=ready]").wait_for()
    take_the_turn(page)
    expect(page.locator(".sound [role=status]")).to_have_text(page_words("sound_insecure"))
    for button in page.locator(".sound button").all():
        expect(button).to_be_disabled()
    page.locator(".write input").fill("go to the kitchen")
    page.locator(".write input").press("Enter")
    expect(page.locator(".write input")).to_have_value("")
    until(page, lambda: robot.commands("text"))
    browser.close()
