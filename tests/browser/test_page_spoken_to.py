"""Words said into the page, by the real ears: the robot in the apartment goes where it is told."""

from collections.abc import Callable, Iterator
from contextlib import ExitStack
from pathlib import Path

import numpy as np
import pytest
from playwright.sync_api import Playwright, expect
from ports import free_port
from sound_rig import PATIENCE_MS, microphone, paired, silence, spoken, write
from test_page_drives import until
from waiting import Heard

from edgevox.apps.agent.build import build_parts, start_parts
from edgevox.apps.agent.parts import AgentParts
from edgevox.core.agent_events import GoalCancelled, GoalChanged, GoalStatus, SafetyPreempted
from edgevox.core.commands import TextInput
from edgevox.core.events import Transcribed
from edgevox.core.settings import load_settings
from edgevox.robots.flat.apartment import ApartmentRobot

pytestmark = pytest.mark.long

Starts = Callable[..., tuple[AgentParts, str]]


@pytest.fixture
def start(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> Iterator[Starts]:
    """An agent that hears nothing but its console, and the link that lets in."""
    with ExitStack() as stack:

        def begin(*, speed: float = 4.0, **settings: object) -> tuple[AgentParts, str]:
            wanted: dict[str, object] = {
                "audio_in": "none",
                "audio_out": "none",
                "llm": "none",
                "console": True,
                "console_tls": "off",
                "console_port": free_port(),
                "console_folder": str(tmp_path / "console"),
            }
            parts = build_parts(
                stack, load_settings(wanted | settings), ApartmentRobot(speed=speed)
            )
            start_parts(stack, parts)
            printed = capsys.readouterr().out
            return parts, next(one for one in printed.split() if "#pair=" in one)

        yield begin


@pytest.fixture(scope="module")
def kitchen() -> np.ndarray:
    return spoken("Go to the kitchen.")


def test_it_goes_where_it_is_told_while_the_button_is_held_and_is_seen_to_arrive(
    start: Starts, playwright: Playwright, tmp_path: Path, kitchen: np.ndarray
) -> None:
    parts, link = start(wakeword="hey jarvis")
    heard, goals = Heard[Transcribed](), Heard[GoalChanged]()
    parts.bus.subscribe(Transcribed, heard.add)
    parts.bus.subscribe(GoalChanged, goals.add)
    file = write(tmp_path / "kitchen.wav", silence(1.0), kitchen, silence(20.0))
    with microphone(playwright, file) as browser, paired(browser, link) as page:
        page.locator(".sound .hold").hover()
        page.mouse.down()
        until(page, lambda: heard.messages)
        page.mouse.up()
        assert "kitchen" in heard.messages[0].text.lower()
        until(page, lambda: GoalStatus.SUCCEEDED in [one.status for one in goals.messages])
        pose = parts.body.pose()
        where = f"{pose.x_m:.1f}, {pose.y_m:.1f} m"
        expect(page.locator(".facts")).to_contain_text(where, timeout=PATIENCE_MS)
        expect(page.locator(".talk-card")).to_contain_text("kitchen")
    assert parts.body.place_at(pose.x_m, pose.y_m) == "kitchen"


def test_a_stop_word_into_the_open_microphone_needs_no_wake_word_and_stands_it_still(
    start: Starts, playwright: Playwright, tmp_path: Path
) -> None:
    parts, link = start(wakeword="hey jarvis", speed=0.3)
    stopped, ends = Heard[SafetyPreempted](), Heard[GoalCancelled]()
    parts.bus.subscribe(SafetyPreempted, stopped.add)
    parts.bus.subscribe(GoalCancelled, ends.add)
    file = write(tmp_path / "stop.wav", silence(2.0), spoken("Stop!"), silence(20.0))
    with microphone(playwright, file) as browser, paired(browser, link) as page:
        parts.command_router.submit(TextInput("go to the kitchen"))
        until(page, lambda: parts.body.velocity().linear_m_s > 0.05)
        page.get_by_role("button", name="Open microphone").click()
        until(page, lambda: stopped.messages and ends.messages)
        until(page, lambda: abs(parts.body.velocity().linear_m_s) < 0.01)
    pose = parts.body.pose()
    assert parts.body.place_at(pose.x_m, pose.y_m) != "kitchen"
