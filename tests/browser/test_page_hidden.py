"""A page in a tab that nobody looks at: its timers run once a second, and it claims nothing wrong.

Playwright's own pages never are hidden, so that this browser is left as it is.
"""

import subprocess
from collections.abc import Iterator

import pytest
from browser_rig import PATIENCE_MS
from playwright.sync_api import BrowserContext, Page, Playwright
from stand_in import CODE, LIVE, Robot

pytestmark = pytest.mark.long

NOTE = """() => {
  window.links = [];
  const root = document.documentElement;
  const note = () => links.push(root.dataset.link);
  new MutationObserver(note).observe(root, { attributeFilter: ['data-link'] });
}"""
SLEEPS = """() => new Promise((done) => {
  let last = 0;
  const timer = setInterval(() => {
    const now = performance.now();
    if (last && now - last > 900) {
      clearInterval(timer);
      done();
    }
    last = now;
  }, 100);
})"""
"""Ends once a timer of 0.1 s takes more than 0.9, as the browser has it in a hidden page."""


@pytest.fixture(scope="module")
def context(playwright: Playwright, tmp_path_factory) -> Iterator[BrowserContext]:
    chromium = subprocess.Popen(
        [
            "chromium",
            "--headless=new",
            "--no-sandbox",
            "--no-first-run",
            "--remote-debugging-port=0",
            f"--user-data-dir={tmp_path_factory.mktemp('browser')}",
        ],
        stderr=subprocess.PIPE,
        text=True,
    )
    try:
        address = next(line.split()[-1] for line in chromium.stderr if "DevTools listening" in line)
        browser = playwright.chromium.connect_over_cdp(address, no_defaults=True)
        browser.contexts[0].set_default_timeout(PATIENCE_MS)
        yield browser.contexts[0]
        browser.close()
    finally:
        chromium.terminate()
        chromium.communicate(timeout=60)


@pytest.fixture
def page(context: BrowserContext, robot: Robot) -> Iterator[Page]:
    """A page that is let in; like a real robot this one tells a page nothing that does not look."""
    robot.live = None
    context.add_cookies([{"name": "edgevox", "value": CODE, "url": robot.url}])
    there = set(context.pages)
    page = context.new_page()
    page.goto(robot.url)
    page.locator("html[data-link=ready]").wait_for()
    page.evaluate(NOTE)
    yield page
    for one in set(context.pages) - there:
        one.close()


def hide(page: Page) -> None:
    page.context.new_page().bring_to_front()
    page.evaluate(SLEEPS)
    assert page.evaluate("document.hidden")


def test_a_hidden_page_does_not_take_its_own_sleep_for_a_robot_that_is_gone(
    page: Page, robot: Robot
) -> None:
    hide(page)
    pings = len(robot.commands("ping"))
    while len(robot.commands("ping")) < pings + 4:
        page.wait_for_timeout(100)
    assert page.evaluate("links") == []


def test_a_page_that_is_seen_again_says_that_the_robot_is_gone(page: Page, robot: Robot) -> None:
    hide(page)
    robot.silent = True
    page.evaluate(SLEEPS)
    assert page.evaluate("links") == []
    page.bring_to_front()
    page.locator("html[data-link=gone]").wait_for()
    assert page.evaluate("links[0]") == "gone"


def test_a_page_that_is_seen_again_shows_the_robot_that_is_there(page: Page, robot: Robot) -> None:
    hide(page)
    robot.live = LIVE
    page.bring_to_front()
    page.locator(".facts .fact").first.wait_for(state="attached")
    assert page.evaluate("links") == []
