"""A stopped robot of the apartment refuses whatever would move it until somebody resumes.

Time passes in its world only as far as the test says.
"""

import threading
from contextlib import ExitStack

import phrases
import pytest
from few_languages import few
from guards import HUNG_S

from edgevox.agent.phrases.load import phrasebook
from edgevox.agent.skills import SkillFailed
from edgevox.agent.text.reasons import because
from edgevox.apps.agent.build import build_parts, start_parts
from edgevox.core.agent_events import (
    GoalChanged,
    GoalRejected,
    ProgramChanged,
    SoftwareStopChanged,
    ToolCalled,
)
from edgevox.core.commands import Interrupt, RunSkill, SetLanguage, TextInput, Way
from edgevox.core.errors import EdgeVoxError
from edgevox.core.events import Responded
from edgevox.core.languages import LANGUAGES
from edgevox.core.settings import load_settings
from edgevox.robots.capabilities import Twist2D
from edgevox.robots.flat.apartment import ApartmentRobot
from edgevox.robots.limits import Steering

STOPPED = because("software_stop")
REFUSED = phrases.refused("software_stop")
BRAKED_S = 0.1
STEP_S = 0.2
STILL = 1e-6
"""A robot that brakes ends at a speed of 1e-17 m/s."""


class Agent:
    """A whole agent, as `edgevox-agent` puts it together, with a robot whose time is held."""

    def __init__(self, robot, stack):
        settings = load_settings({"text_mode": True, "llm": "none", "confirm": "never"}, None)
        self.robot, self.parts = robot, build_parts(stack, settings, robot)
        self.stop, self.talk = self.parts.software_stop, self.parts.conversation
        self.said, self.news, self.runs = [], threading.Condition(), threading.Event()
        self.programs, self.changes = [], []
        bus = self.parts.bus
        bus.subscribe(Responded, self._hear)
        bus.subscribe(GoalChanged, lambda goal: goal.feedback is None or self.runs.set())
        bus.subscribe(ProgramChanged, lambda one: self.programs.append(str(one.status)))
        bus.subscribe(SoftwareStopChanged, self.changes.append)
        self.called, self.rejected = [], []
        bus.subscribe(ToolCalled, self.called.append)
        bus.subscribe(GoalRejected, self.rejected.append)
        start_parts(stack, self.parts)

    def say(self, text):
        """Say it; no time passes in the world until it has answered."""
        known = len(self.said)
        self.parts.command_router.submit(TextInput(text))
        with self.news:
            assert self.news.wait_for(lambda: len(self.said) > known, HUNG_S)
        return self.said[known]

    def until_said(self, text):
        with self.news:
            assert self.news.wait_for(lambda: any(text in one for one in self.said), HUNG_S)

    def drive(self):
        """Set out for the kitchen, and be on the way."""
        self.say("go to the kitchen")
        self.until_it_moves()

    def until_it_moves(self):
        assert self.runs.wait(HUNG_S)
        while not self.moves:
            self.robot.advance(STEP_S)

    @property
    def moves(self):
        velocity = self.robot.velocity()
        return abs(velocity.linear_m_s) + abs(velocity.angular_rad_s) > STILL

    def stays(self):
        """Whether it stands, and goes on standing while much time passes."""
        before = self.robot.pose()
        self.robot.advance(5.0)
        now = self.robot.pose()
        return not self.moves and (now.x_m, now.y_m) == pytest.approx((before.x_m, before.y_m))

    def _hear(self, event):
        with self.news:
            self.said.append(event.text)
            self.news.notify_all()


@pytest.fixture
def agent():
    with ExitStack() as stack:
        yield Agent(ApartmentRobot(speed=0.0), stack)


def test_a_drive_ends_within_a_tenth_of_a_second_and_why_is_said(agent):
    agent.drive()
    agent.stop.stop("a phone")
    agent.robot.advance(BRAKED_S)
    assert not agent.moves
    agent.until_said(phrases.failed("software_stop"))
    assert agent.changes == [SoftwareStopChanged(engaged=True, by="a phone")]
    assert agent.stays()


def test_who_is_steered_by_velocities_stands_too(agent):
    agent.robot.set_velocity(Twist2D(0.3, 0.5))
    agent.robot.advance(STEP_S)
    assert agent.moves
    agent.stop.stop("a phone")
    agent.robot.advance(BRAKED_S)
    assert not agent.moves
    assert agent.stays()


def test_a_patrol_ends_and_does_not_go_on_when_somebody_resumes(agent):
    agent.say("patrol between the kitchen and the office until I say stop")
    agent.until_it_moves()
    agent.stop.stop("a phone")
    agent.until_said(phrases.failed("software_stop"))
    agent.robot.advance(BRAKED_S)
    agent.stop.resume("a phone")
    assert agent.stays()
    assert agent.programs[-1] == "cancelled"


def by_goal(way):
    def ask(agent):
        for begin in (agent.talk.check_goal, agent.talk.start_goal):
            with pytest.raises(SkillFailed) as failed:
                begin("navigate_xy", {"x": 3.0, "y": 4.0}, way=way)
            assert failed.value.reason == STOPPED

    return ask


def by_words(text):
    return lambda agent: pytest.fail("taken") if agent.say(text) != REFUSED else None


def by_command(agent):
    agent.parts.command_router.submit(RunSkill("navigate_to", {"room": "kitchen"}))
    agent.until_said(REFUSED)


def by_velocity(agent):
    steering = Steering(agent.robot, agent.parts.interlock, agent.parts.guard.velocity)
    with pytest.raises(SkillFailed) as failed:
        steering.steer(0.3, 0.0)
    assert failed.value.reason == STOPPED


WAYS = {
    "a sentence": by_words("go to the kitchen"),
    "a program now": by_words("go to the office and back twice"),
    "a program later": by_words("in five minutes go to the kitchen"),
    "a patrol": by_words("patrol between the kitchen and the office"),
    "a command": by_command,
    "the action": by_goal(Way.ACTION),
    "goal_pose": by_goal(Way.GOAL_POSE),
    "the console": by_goal(Way.CONSOLE_OPERATOR),
    "cmd_vel": by_velocity,
}


@pytest.mark.parametrize("way", WAYS)
def test_whatever_would_move_it_is_refused_with_the_reason_and_is_no_call(agent, way):
    agent.stop.stop("a phone")
    WAYS[way](agent)
    assert agent.stays()
    assert not agent.talk.programs.kept
    assert agent.called == []
    told = set() if way == "cmd_vel" else {STOPPED.code}
    assert {one.reason.code for one in agent.rejected} == told


@pytest.mark.parametrize(
    "calls", [("navigate_xy", {"x": 999.0, "y": 0.0}), ("fly", {}), ("navigate_to", {"room": 1})]
)
@pytest.mark.parametrize("way", [Way.GOAL_POSE, Way.CONSOLE_OPERATOR, Way.COMMAND])
def test_a_call_that_cannot_be_is_told_as_a_rejection_and_not_as_a_call(agent, way, calls):
    agent.parts.command_router.submit(RunSkill(*calls, way))
    with agent.news:
        assert agent.news.wait_for(lambda: agent.said, HUNG_S)
    with pytest.raises(EdgeVoxError):
        agent.talk.start_goal(*calls, way=way)
    assert agent.called == []
    assert [(one.skill, one.way) for one in agent.rejected] == [(calls[0], str(way))] * 2


@pytest.mark.parametrize("arguments", [{"x": 1}, {"": None}, {"reason": "now" * 100}])
@pytest.mark.parametrize("way", [Way.ACTION, Way.COMMAND, Way.CONSOLE_OPERATOR])
def test_a_stop_with_wrong_arguments_is_still_a_stop(agent, way, arguments):
    agent.drive()
    agent.talk.check_goal("stop", arguments, way)
    agent.talk.start_goal("stop", arguments, way=way)
    agent.robot.advance(BRAKED_S)
    assert agent.stays()


def test_it_answers_and_heeds_stop_words_and_interrupts_meanwhile(agent):
    agent.stop.stop("a phone")
    assert "percent" in agent.say("what is your battery level")
    assert agent.say("stop") == phrases.said("standing")
    agent.talk.submit(Interrupt())
    assert agent.stop.state.engaged
    assert agent.say("go to the kitchen") == REFUSED


def test_once_somebody_resumes_it_moves_when_it_is_asked_and_not_before(agent):
    agent.stop.stop("a phone")
    agent.say("go to the kitchen")
    agent.stop.resume("a tablet")
    assert agent.stays()
    agent.drive()
    assert agent.moves


@pytest.mark.parametrize("code", few(LANGUAGES))
def test_the_refusal_is_said_in_the_language_that_is_spoken(agent, code):
    agent.parts.command_router.submit(SetLanguage(code))
    agent.stop.stop("a phone")
    agent.parts.command_router.submit(RunSkill("navigate_to", {"room": "kitchen"}))
    agent.until_said(phrasebook(code).reason(STOPPED).rstrip("."))
    assert agent.stays()
