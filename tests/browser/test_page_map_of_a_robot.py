"""The map of a real agent, tapped: the robot goes there and is seen to, or the point has a name."""

from collections.abc import Iterator
from contextlib import ExitStack
from pathlib import Path

import pytest
from browser_rig import DESK, PATIENCE_MS, let_in, page_words, take_the_turn
from playwright.sync_api import Browser, Page, expect
from ports import free_port
from test_page_drives import until
from waiting import Heard

from edgevox.apps.agent.build import build_parts, start_parts
from edgevox.apps.agent.parts import AgentParts
from edgevox.core.agent_events import GoalChanged, GoalStatus
from edgevox.core.settings import load_settings
from edgevox.robots.flat.apartment import ApartmentRobot

NEAR_M = 0.3
"""A robot that arrived is so near to what was tapped; a pixel of the page is some 2 cm."""
POINT = (7.0, 2.4)
"""In the kitchen, metres, map frame."""


@pytest.fixture
def served(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> Iterator[tuple[AgentParts, str]]:
    """An agent with its robot, and the link that lets in."""
    settings = {
        "text_mode": True,
        "llm": "none",
        "console": True,
        "console_tls": "off",
        "console_port": free_port(),
        "console_folder": str(tmp_path / "console"),
        "places": tmp_path / "places",
    }
    with ExitStack() as stack:
        made = build_parts(stack, load_settings(settings), ApartmentRobot(speed=4.0))
        start_parts(stack, made)
        yield made, next(one for one in capsys.readouterr().out.split() if "#pair=" in one)


@pytest.fixture
def parts(served: tuple[AgentParts, str]) -> AgentParts:
    return served[0]


@pytest.fixture
def page(browser: Browser, served: tuple[AgentParts, str]) -> Iterator[Page]:
    context = browser.new_context(locale="en-GB", **DESK)
    context.set_default_timeout(PATIENCE_MS)
    broken: list[str] = []
    page = context.new_page()
    page.on("pageerror", lambda error: broken.append(str(error)))
    let_in(page, served[1])
    take_the_turn(page)
    page.locator(".facts .fact").first.wait_for()  # it is drawn
    yield page
    context.close()
    assert not broken


def tap(page: Page, parts: AgentParts, x_m: float, y_m: float) -> None:
    """Where the page draws this point while it shows the whole map."""
    world = parts.body.world
    wide, high = page.locator(".map").evaluate("e => [e.clientWidth, e.clientHeight]")
    x0, y0, x1, y1 = world.x_min_m, world.y_min_m, world.x_max_m, world.y_max_m
    scale = min((wide - 24) / (x1 - x0), (high - 24) / (y1 - y0))
    at = {
        "x": wide / 2 + (x_m - (x0 + x1) / 2) * scale,
        "y": high / 2 - (y_m - (y0 + y1) / 2) * scale,
    }
    page.locator(".map").click(position=at)
    page.locator(".tap-sheet").wait_for()


def test_a_tap_brings_the_robot_there_and_it_is_seen_to_arrive(
    page: Page, parts: AgentParts
) -> None:
    goals = Heard[GoalChanged]()
    parts.bus.subscribe(GoalChanged, goals.add)
    tap(page, parts, *POINT)
    page.get_by_role("button", name="Go there").click()
    until(page, lambda: "navigate_xy" in succeeded(goals))
    pose = parts.body.pose()
    assert abs(pose.x_m - POINT[0]) < NEAR_M
    assert abs(pose.y_m - POINT[1]) < NEAR_M
    expect(page.locator(".facts")).to_contain_text(f"{pose.x_m:.1f}, {pose.y_m:.1f} m")
    expect(page.locator(".goal")).to_be_hidden()


def test_a_point_that_was_named_by_a_tap_is_known_unasked_and_driven_to_by_its_name(
    page: Page, parts: AgentParts
) -> None:
    goals = Heard[GoalChanged]()
    parts.bus.subscribe(GoalChanged, goals.add)
    tap(page, parts, *POINT)
    page.get_by_label("Name of this place").fill("bike stand")
    page.keyboard.press("Enter")
    expect(page.locator(".toast.good")).to_have_text(page_words("place_kept", name="bike stand"))
    place = parts.body.place_memory.find("bike stand")
    assert (place.x, place.y) == pytest.approx(POINT, abs=0.05)
    page.locator(".write input").fill("go to the bike stand")
    page.locator(".write input").press("Enter")
    until(page, lambda: "navigate_to" in succeeded(goals))
    pose = parts.body.pose()
    assert abs(pose.x_m - place.x) < NEAR_M
    assert abs(pose.y_m - place.y) < NEAR_M


def succeeded(goals: Heard[GoalChanged]) -> list[str]:
    """The skills whose goals were reached so far."""
    return [one.skill for one in goals.messages if one.status is GoalStatus.SUCCEEDED]
