"""A robot of the apartment whose agent is to end: what it does then goes on, and nothing after it.

Time passes in its world only as far as the test says; the drain waits for it.
"""

import threading
from contextlib import ExitStack

import phrases
import pytest
from guards import HUNG_S

from edgevox.agent.skills import SkillFailed
from edgevox.agent.text.reasons import because
from edgevox.apps.agent.build import build_parts, start_parts
from edgevox.core.agent_events import DrainChanged, DrainStatus, GoalChanged, ProgramChanged
from edgevox.core.commands import TextInput
from edgevox.core.settings import load_settings
from edgevox.core.status import ComponentName, Level
from edgevox.robots.capabilities import Twist2D
from edgevox.robots.flat.apartment import ApartmentRobot
from edgevox.robots.limits import Steering

DRAINING = because("draining")
LONG_S = 600.0
STEP_S = 0.2


class Agent:
    """A whole agent, as `edgevox-agent` puts it together, with a robot whose time is held."""

    def __init__(self, stack):
        asked = {"text_mode": True, "llm": "none", "confirm": "never", "drain_s": LONG_S}
        self.robot = ApartmentRobot(speed=0.0)
        self.parts = build_parts(stack, load_settings(asked, None), self.robot)
        self.runs, self.begun, self.over = threading.Event(), threading.Event(), threading.Event()
        self.ends, self.programs = [], []
        bus = self.parts.bus
        bus.subscribe(GoalChanged, lambda goal: goal.feedback is None or self.runs.set())
        bus.subscribe(ProgramChanged, self.programs.append)
        bus.subscribe(DrainChanged, self._hear)
        start_parts(stack, self.parts)

    def drives(self, words):
        self.parts.command_router.submit(TextInput(words))
        assert self.runs.wait(HUNG_S)
        self.until(lambda: self.moves)

    def drain(self):
        self.parts.drain.begin("SIGTERM")
        assert self.begun.wait(HUNG_S)

    def until(self, so):
        """Let time pass in the world until this is so."""
        while not so():
            self.robot.advance(STEP_S)
            self.over.wait(0.01)  # let the goal's own thread see what has become of it

    @property
    def moves(self):
        return abs(self.robot.velocity().linear_m_s) > 1e-6

    def _hear(self, event):
        (self.begun if event.status is DrainStatus.DRAINING else self.over).set()
        self.ends.append(event.status)


@pytest.fixture
def agent():
    with ExitStack() as stack:
        yield Agent(stack)


def test_a_drive_arrives_and_what_is_asked_after_it_is_refused(agent):
    agent.drives("go to the kitchen")
    agent.drain()
    with pytest.raises(SkillFailed, check=phrases.because("draining")):
        agent.parts.conversation.start_goal("navigate_to", {"room": "bedroom"})
    agent.until(agent.over.is_set)
    assert agent.ends[-1] is DrainStatus.DRAINED
    assert agent.robot.state()["room"] == "kitchen"


def test_a_patrol_ends_at_its_next_step(agent):
    agent.drives("patrol between the kitchen and the office until I say stop")
    agent.drain()
    agent.until(agent.over.is_set)
    last = agent.programs[-1]
    assert (str(last.status), last.reason) == ("failed", DRAINING)


def test_who_steers_by_velocities_is_halted_at_once(agent):
    agent.robot.set_velocity(Twist2D(0.3, 0.0))
    agent.robot.advance(STEP_S)
    assert agent.moves
    agent.drain()
    agent.until(agent.over.is_set)
    assert not agent.moves
    with pytest.raises(SkillFailed, check=phrases.because("draining")):
        Steering(agent.robot, agent.parts.interlock, agent.parts.guard.velocity).steer(0.3, 0.0)


def test_the_software_stop_ends_a_drive_that_was_let_go_on(agent):
    agent.drives("go to the bedroom")
    agent.drain()
    agent.parts.software_stop.stop("a phone")
    agent.until(agent.over.is_set)
    assert agent.robot.state()["room"] != "bedroom"
    assert not agent.moves


def test_diagnostics_and_health_say_it(agent):
    assert agent.parts.health.ready().well
    agent.drain()
    assert agent.over.wait(HUNG_S)
    assert agent.parts.health.ready().checks["drain"] == "drained"
    assert agent.parts.health.live().well
    (said,) = agent.parts.components.statuses([ComponentName.INTERLOCK])
    assert (said.level, said.values["holders"]) == (Level.WARN, "drain")
