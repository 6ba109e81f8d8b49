"""What the tests of the page share: the sizes of its windows, and how long they wait."""

import json
from collections.abc import Callable
from pathlib import Path

import pytest
from playwright.sync_api import Error, Page

_TOP = Path(__file__).parents[2]
MODULES = _TOP / ".venv/page/node_modules"
AXE = MODULES / "axe-core/axe.min.js"
RULES = ["wcag2a", "wcag2aa", "wcag21a", "wcag21aa", "wcag22aa", "best-practice"]
PATIENCE_MS = 60_000
PHONE = {"viewport": {"width": 390, "height": 844}, "is_mobile": True, "has_touch": True}
DESK = {"viewport": {"width": 1440, "height": 900}}
DEVICES = [
    pytest.param(DESK, "light", id="desk-light"),
    pytest.param(PHONE, "dark", id="phone-dark"),
    pytest.param(DESK, "dark", id="desk-dark", marks=pytest.mark.long),
    pytest.param(PHONE, "light", id="phone-light", marks=pytest.mark.long),
]
"""With the colours that somebody wants there."""

Opens = Callable[..., Page]


def let_in(page: Page, link: str) -> None:
    """Pair by the link, as a phone does by the picture in the terminal."""
    page.goto(link)
    page.locator(".pair button.primary").click()
    page.locator("html[data-link=ready]").wait_for()


def page_words(key: str, language: str = "en", **values: object) -> str:
    """The page's text for this key."""
    file = _TOP / f"edgevox/console/page/languages/{language}.json"
    return json.loads(file.read_text(encoding="utf-8"))[key].format(**values)


def settled(page: Page) -> None:
    """Wait until presses count again, after something has moved the page's controls."""
    page.locator("html:not([data-moved])").wait_for()


def take_the_turn(page: Page) -> None:
    settled(page)
    page.locator(".lease button.primary").click()
    page.locator(".lease button.on").wait_for()


def problems(page: Page) -> list[str]:
    """What axe finds in what is shown now."""
    page.evaluate(AXE.read_text(encoding="utf-8"))
    found = page.evaluate(
        "tags => axe.run(document, {runOnly: tags}).then(r => r.violations)", RULES
    )
    return [f"{one['id']}: {node['html']}" for one in found for node in one["nodes"]]


def stop_clock(page: Page) -> None:
    """Hold the page's time from now on, however long a call to the browser takes."""
    ahead_s = 0.05
    while True:
        try:
            page.clock.pause_at(page.evaluate("Date.now() / 1000") + ahead_s)
        except Error:  # that time was over before the browser had heard of it
            ahead_s *= 2
        else:
            return
