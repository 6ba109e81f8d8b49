"""The harness between a scenario and a real conversation."""

import threading
import time
from contextlib import contextmanager

import pytest
from guards import HUNG_S

from edgevox.agent.agents import Agent
from edgevox.agent.conversation import Conversation
from edgevox.agent.skills import SkillSet, skill
from edgevox.apps.agent import play
from edgevox.apps.agent.play import ConversationHarness
from edgevox.core.bus import Bus
from edgevox.core.errors import EdgeVoxError
from edgevox.scenario.format import parse_scenario
from edgevox.scenario.judge import Source
from edgevox.scenario.run import run_scenario

LOOKS = 50
"""So often it is looked whether the robot moves yet: more often than at a goal that is not late."""


class Body:
    """A body in real time: it cannot be advanced, and takes no velocities."""

    name = "robot-real"

    @property
    def time_s(self):
        return time.monotonic()

    def state(self):
        return {"name": self.name}

    def halt(self, reason):
        return False


class HeldBody(Body):
    """A body in lockstep, that moves for two moments of its time for each goal.

    A goal begins to move it only once somebody has waited for that, or has let time pass without.
    """

    def __init__(self):
        self._left = self._looks = 0
        self._changed = threading.Condition()
        self.moved = []
        """For each moment, whether a goal moved it."""

    @property
    def time_s(self):
        return 0.05 * len(self.moved)

    @property
    def in_motion(self):
        with self._changed:
            self._looks += 1
            self._changed.notify_all()
            return self._left > 0

    def advance(self, seconds):
        with self._changed:
            self.moved.append(self._left > 0)
            self._left = max(0, self._left - 1)
            self._changed.notify_all()

    def move(self):
        with self._changed:
            looks, passed = self._looks + LOOKS, len(self.moved)
            assert self._changed.wait_for(
                lambda: self._looks >= looks or len(self.moved) > passed, HUNG_S
            )
            self._left = 2
            assert self._changed.wait_for(lambda: not self._left, HUNG_S)


@skill(templates=["where are you"], done="I am here.", moves=False)
def get_pose(goal):
    """Say where the robot is."""


@skill(templates=["dance"], says="Dancing.", done="That was my dance.")
def dance(goal):
    """Dance until somebody ends it."""
    goal.token.wait(60)
    goal.token.check()


@contextmanager
def played_on(body, *more):
    bus = Bus()
    skills = SkillSet([get_pose, dance, *more])
    conversation = Conversation([Agent("a", "", skills)], bus, halt=lambda reason: False)
    conversation.start()
    one = ConversationHarness(bus, conversation, body)
    try:
        yield one
    finally:
        one.come_to_rest(5.0)
        one.close()
        conversation.close()


@pytest.fixture
def harness():
    with played_on(Body()) as one:
        yield one


def of(source, seen):
    return [one.data for one in seen if one.source is source]


def test_when_words_are_said_their_answer_and_their_events_have_been_seen(harness):
    harness.say("where are you", 10)
    seen = harness.look()
    assert of(Source.ANSWER, seen) == ["I am here."]
    assert [one["status"] for one in of(Source.EVENT, seen) if one["kind"] == "skill_goal"] == [
        "accepted",
        "running",
        "succeeded",
    ]
    assert of(Source.STATE, seen) == [{"name": "robot-real"}]


def seen_until(harness, wanted):
    """What is seen up to an event that is wanted."""
    seen = []
    for _ in range(200):
        seen += harness.let_pass(0.05)
        if any(wanted(event) for event in of(Source.EVENT, seen)):
            return seen
    raise AssertionError(f"not seen; but {seen}")


def test_a_goal_may_run_on_after_its_words_were_answered_and_is_stopped_by_a_stop_word(harness):
    harness.say("dance", 10)
    seen = seen_until(harness, lambda event: event.get("status") == "running")
    assert of(Source.ANSWER, seen) == ["Dancing."]
    harness.say("stop", 10)
    seen = seen_until(harness, lambda event: event["kind"] == "skill_cancelled")
    assert of(Source.ANSWER, seen) == ["Stopped."]
    assert "safety_preempt" in [event["kind"] for event in of(Source.EVENT, seen)]


def test_a_skill_that_is_refused_and_a_velocity_that_nobody_takes_are_errors(harness):
    with pytest.raises(EdgeVoxError, match="skill: got 'fly'"):
        harness.run("fly", {})
    with pytest.raises(EdgeVoxError, match="drive: got 'robot-real', expected a robot that takes"):
        harness.steer(1.0, 0.0)


def test_a_body_whose_time_is_real_is_played_in_real_time(harness):
    scenario = parse_scenario(
        "steps:\n"
        "  - wait: 0.2\n"
        "  - run: dance\n"
        "  - expect: {event: {status: running}}\n"
        "    within: 60\n"
        "  - interrupt: true\n"
        "  - expect: {event: {status: cancelled}}\n"
        "    within: 60\n",
        "s.yaml",
    )
    outcomes = []
    assert run_scenario(scenario, harness, outcomes.append)
    assert outcomes[0].time_s >= 0.2
    assert outcomes[0].real_s >= 0.2


@pytest.mark.parametrize(("asked", "moments"), [("hop", 2), ("hop and then hop", 4)])
def test_no_time_passes_until_a_goal_has_begun_to_move_the_robot(asked, moments):
    """However long its thread takes to begin, or to follow the one before it."""
    body = HeldBody()

    @skill(templates=["hop"], says="Hopping.", done="I hopped.")
    def hop(goal):
        """Hop."""
        body.move()

    with played_on(body, hop) as harness:
        harness.say(asked, HUNG_S)
        for _ in range(5):
            harness.let_pass(0.05)
    assert body.moved[:5] == [True] * moments + [False] * (5 - moments)


def test_a_goal_that_does_not_move_the_robot_does_not_hold_its_time_up_for_ever(monkeypatch):
    monkeypatch.setattr(play, "MOST_THINK_S", 0.05)
    body = HeldBody()
    with played_on(body) as harness:
        harness.run("dance", {})
        for _ in range(3):
            harness.let_pass(0.05)
    assert body.moved[:3] == [False] * 3
