"""The page of many robots, in a real browser: what is shown, and for whom it is readable."""

from collections.abc import Iterator, Mapping

import pytest
from browser_rig import DEVICES, problems
from playwright.sync_api import Browser, expect

from edgevox.apps.fleet.serve import FleetRobot, FleetWatch, State, fleet_server
from edgevox.ops.http_server import HttpServer

STATES: Mapping[str, tuple[State, Mapping[str, str]]] = {
    "kitchen": ("ready", {}),
    "ward": ("unwell", {"stt": "its thread has ended"}),
    "yard": ("gone", {"network": "no route to host"}),
    "attic": ("unknown", {}),
}


@pytest.fixture
def served() -> Iterator[HttpServer]:
    robots = {
        name: FleetRobot(health=f"http://{name}:1", console=f"https://{name}:8443")
        for name in STATES
    }
    by_address = {f"http://{name}:1": state for name, state in STATES.items()}
    watch = FleetWatch(robots, lambda robot: by_address[robot.health])
    watch.look()
    server = fleet_server(watch, 0)
    server.start()
    yield server
    server.close()


@pytest.mark.parametrize(("device", "colours"), DEVICES)
def test_axe_finds_nothing(
    browser: Browser, served: HttpServer, device: dict[str, object], colours: str
) -> None:
    context = browser.new_context(**device, color_scheme=colours)
    page = context.new_page()
    broken: list[str] = []
    page.on("pageerror", lambda error: broken.append(str(error)))
    page.goto(f"http://127.0.0.1:{served.port}")
    expect(page.locator("tbody tr")).to_have_count(len(STATES))
    expect(page.locator("#summary")).to_have_text("1 of 4 robots ready")
    assert problems(page) == []
    assert not broken
    served.close()
    expect(page.locator("body")).to_have_class("stale")
    assert problems(page) == []
    context.close()
