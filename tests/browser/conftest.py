"""A real Chromium, and a stand-in for the robot's server."""

from collections.abc import Iterator

import pytest
from browser_rig import DESK, PATIENCE_MS, Opens, stop_clock, take_the_turn
from playwright.sync_api import Browser, BrowserContext, Page, Playwright, expect, sync_playwright
from sound_rig import launch
from stand_in import CODE, Robot
from steady_piper import steady_piper

expect.set_options(timeout=PATIENCE_MS)


@pytest.fixture(scope="session", autouse=True)
def _steady() -> Iterator[None]:
    with steady_piper():
        yield


@pytest.fixture(scope="module")
def playwright() -> Iterator[Playwright]:
    """One for each file: while it is there the thread has a loop, and other tests run their own."""
    with sync_playwright() as playwright:
        yield playwright


@pytest.fixture(scope="module")
def browser(playwright: Playwright) -> Iterator[Browser]:
    browser = launch(playwright)
    yield browser
    browser.close()


@pytest.fixture
def robot() -> Iterator[Robot]:
    with Robot() as robot:
        yield robot


@pytest.fixture
def opens(browser: Browser, robot: Robot) -> Iterator[Opens]:
    """Opens a page that is let in, in a browser of its own; what breaks in it fails the test."""
    contexts: list[BrowserContext] = []
    broken: list[str] = []

    def open_page(
        *, locale: str = "en-GB", command: bool = True, stopped_clock: bool = False, **how: object
    ) -> Page:
        context = browser.new_context(locale=locale, **(how or DESK))
        contexts.append(context)
        context.set_default_timeout(PATIENCE_MS)
        context.add_cookies([{"name": "edgevox", "value": CODE, "url": robot.url}])
        page = context.new_page()
        page.on("pageerror", lambda error: broken.append(str(error)))
        if stopped_clock:
            page.clock.install()
        page.goto(robot.url)
        page.locator("html[data-link=ready]").wait_for()
        if command:
            take_the_turn(page)
        if stopped_clock:
            stop_clock(page)
        return page

    yield open_page
    for context in contexts:
        context.close()
    assert not broken
