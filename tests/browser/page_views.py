"""How the tests look at the page: by a phone or at a desk, with patience, checked by axe."""

from collections.abc import Callable
from pathlib import Path

from playwright.sync_api import Page

AXE = Path(__file__).parents[2] / ".venv/page/node_modules/axe-core/axe.min.js"
PATIENCE_MS = 60_000
PHONE = {"viewport": {"width": 390, "height": 844}, "is_mobile": True, "has_touch": True}
DESK = {"viewport": {"width": 1440, "height": 900}}

Opens = Callable[..., Page]
