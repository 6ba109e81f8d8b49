"""What an action needs of the conversation: goals from outside the language."""

import threading

import phrases
import pytest

from edgevox.agent.agents import Agent
from edgevox.agent.conversation import Conversation
from edgevox.agent.goals.executor import MAX_BACKGROUND
from edgevox.agent.skills import SkillFailed, SkillSet, UnknownSkill, skill
from edgevox.core.agent_events import AgentEvent, GoalRejected, GoalStatus, as_json
from edgevox.core.bus import Bus
from edgevox.core.cancel import Cancelled
from edgevox.core.commands import Interrupt, RunSkill
from edgevox.core.errors import InvalidValue
from edgevox.core.events import Responded


class Rig:
    """A conversation whose skills wait until the test lets them end."""

    def __init__(self):
        self.bus, self.events, self.said = Bus(), [], []
        self.bus.subscribe(AgentEvent, self.events.append)
        self.bus.subscribe(Responded, lambda e: self.said.append(e.text))
        self.began, self.go_on = threading.Semaphore(0), threading.Event()
        self.conversation = Conversation(
            [Agent("robot", "", self._skills())], self.bus, halt=lambda reason: False
        )
        self.conversation.start()

    def _skills(self):
        def work(goal):
            self.began.release()
            forget = goal.token.on_cancel(self.go_on.set)
            assert self.go_on.wait(60)
            forget()
            if goal.token.cancelled:
                self.go_on.clear()
                raise Cancelled(goal.token.reason)
            return {}

        @skill(says="Driving.", done="Arrived.")
        def drive(goal, metres: int = 1):
            """Drive."""
            return work(goal)

        @skill(moves=False, done="Seen.")
        def look(goal):
            """Look."""
            return work(goal)

        return SkillSet([drive, look])


@pytest.fixture
def rig():
    rig = Rig()
    yield rig
    rig.conversation.close()
    names = {thread.name for thread in threading.enumerate()}
    assert not [n for n in names if n.startswith(("edgevox-conversation", "edgevox-goals"))]


@pytest.mark.parametrize(
    ("name", "arguments", "error"),
    [
        ("fly", {}, UnknownSkill),
        ("drive", {"metres": "far"}, InvalidValue),
        ("drive", {"speed": 1}, InvalidValue),
    ],
)
def test_a_goal_that_cannot_be_is_rejected_and_changes_nothing(rig, name, arguments, error):
    running = rig.conversation.start_goal("drive", {})
    assert rig.began.acquire(timeout=60)
    seen = len(rig.events)
    for refuse in (rig.conversation.check_goal, rig.conversation.start_goal):
        with pytest.raises(error):
            refuse(name, arguments)
    (told,) = rig.events[seen:]
    assert isinstance(told, GoalRejected)
    assert running.status is GoalStatus.RUNNING
    rig.go_on.set()
    assert running.wait(60)


def test_a_goal_keeps_the_id_that_it_was_given_and_is_never_spoken_of(rig):
    rig.go_on.set()
    goal = rig.conversation.start_goal("drive", {"metres": 2}, "abc")
    assert rig.conversation.wait_idle(10)
    assert goal.status is GoalStatus.SUCCEEDED
    call, *lives = [as_json(event) for event in rig.events]
    assert (call["source"], call["arguments"], call["turn"]) == ("action", {"metres": 2}, 0)
    assert {data["goal_id"] for data in lives} == {"abc"}
    assert rig.said == []


def test_it_preempts_and_is_preempted(rig):
    rig.conversation.submit(RunSkill("drive", {}))
    assert rig.began.acquire(timeout=60)
    mine = rig.conversation.start_goal("drive", {})
    assert rig.began.acquire(timeout=60)
    rig.conversation.submit(RunSkill("drive", {}))
    assert mine.wait(60)
    assert mine.status is GoalStatus.CANCELLED
    assert rig.began.acquire(timeout=60)
    rig.go_on.set()
    assert rig.conversation.wait_idle(10)
    ends = [e for e in rig.events if as_json(e).get("status") == "cancelled"]
    assert len(ends) == 2
    assert rig.said[-1] == "Arrived."


def test_what_moves_nothing_runs_beside_and_in_order(rig):
    drive = rig.conversation.start_goal("drive", {})
    first = rig.conversation.start_goal("look", {})
    second = rig.conversation.start_goal("look", {})
    assert rig.began.acquire(timeout=60)
    assert rig.began.acquire(timeout=60)
    assert (drive.status, first.status) == (GoalStatus.RUNNING, GoalStatus.RUNNING)
    assert second.status is GoalStatus.ACCEPTED
    rig.go_on.set()
    assert all(goal.wait(60) for goal in (drive, first, second))
    assert second.status is GoalStatus.SUCCEEDED


def test_an_interrupt_ends_what_runs_and_waits_beside(rig):
    first = rig.conversation.start_goal("look", {})
    assert rig.began.acquire(timeout=60)
    second = rig.conversation.start_goal("look", {})
    rig.conversation.submit(Interrupt())
    assert first.wait(60)
    assert second.wait(60)
    assert {first.status, second.status} == {GoalStatus.CANCELLED}


def test_too_many_that_wait_are_refused(rig):
    rig.conversation.start_goal("look", {})
    assert rig.began.acquire(timeout=60)
    waiting = [rig.conversation.start_goal("look", {}) for _ in range(MAX_BACKGROUND)]
    with pytest.raises(SkillFailed, check=phrases.because("goals_wait", skill="look", count="64")):
        rig.conversation.start_goal("look", {})
    rig.conversation.check_goal("drive", {})
    rig.go_on.set()
    assert all(goal.wait(60) for goal in waiting)


def test_after_the_end_a_goal_ends_at_once(rig):
    rig.conversation.close()
    for name in ("drive", "look"):
        goal = rig.conversation.start_goal(name, {})
        assert goal.wait(0)
        assert (goal.status, goal.error) == (GoalStatus.CANCELLED, phrases.why("shutting_down"))
