"""The harness between a scenario and a real conversation."""

import time

import pytest

from edgevox.agent.agents import Agent
from edgevox.agent.conversation import Conversation
from edgevox.agent.skills import SkillSet, skill
from edgevox.apps.conversation_harness import ConversationHarness
from edgevox.core.bus import Bus
from edgevox.core.errors import EdgeVoxError
from edgevox.scenario.reading import parse_scenario
from edgevox.scenario.run_scenario import run_scenario
from edgevox.scenario.scenario_judge import Source


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


@skill(templates=["where are you"], done="I am here.", moves=False)
def get_pose(goal):
    """Say where the robot is."""


@skill(templates=["dance"], says="Dancing.", done="That was my dance.")
def dance(goal):
    """Dance until somebody ends it."""
    goal.token.wait(60)
    goal.token.check()


@pytest.fixture
def harness():
    bus = Bus()
    skills = SkillSet([get_pose, dance])
    conversation = Conversation([Agent("a", "", skills)], bus, halt=lambda reason: False)
    conversation.start()
    one = ConversationHarness(bus, conversation, Body())
    yield one
    one.come_to_rest(5.0)
    one.close()
    conversation.close()


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
