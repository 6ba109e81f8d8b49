import threading

import pytest

from edgevox.agent.goals import Goal, GoalRunner, Status
from edgevox.agent.skills import SkillFailed, skill
from edgevox.core.bus import Bus
from edgevox.core.cancel import Cancelled
from edgevox.core.events import AgentEvent


@skill()
def drive(goal, where: str):
    """Drive until somebody cancels."""
    goal.report(progress=0.5)
    goal.token.wait(60)
    raise Cancelled(goal.token.reason)


@skill()
def arrive(goal, where: str):
    """Arrive at once."""
    return {"where": where}


@skill()
def fail(goal):
    """Fail with a reason."""
    raise SkillFailed("the door is shut")


@skill()
def break_down(goal):
    """Raise what no skill should."""
    raise ZeroDivisionError("oops")


@pytest.fixture
def bus():
    return Bus()


@pytest.fixture
def events(bus):
    heard = []
    bus.subscribe(AgentEvent, lambda e: heard.append((str(e.kind), dict(e.data))))
    return heard


@pytest.fixture
def ended():
    return []


@pytest.fixture
def runner(ended):
    runner = GoalRunner(on_end=ended.append)
    runner.start()
    yield runner
    runner.close()
    assert not [t for t in threading.enumerate() if t.name == "edgevox-goals"]


@pytest.fixture
def goal(bus):
    def make(skill_, **arguments):
        return Goal(skill_, arguments, turn=1, bus=bus)

    return make


def running(bus):
    started = threading.Event()
    bus.subscribe(AgentEvent, lambda e: started.set() if e.data["status"] == "running" else None)
    return started


def test_a_goal_ends_with_its_result(runner, goal, events, ended):
    one = goal(arrive, where="kitchen")
    runner.submit([one])
    assert one.wait(60)
    assert one.status is Status.SUCCEEDED
    assert one.result == {"where": "kitchen"}
    assert [data["status"] for _, data in events] == ["accepted", "running", "succeeded"]
    assert runner.wait_idle(5)
    assert ended == [one]


def test_a_failure_carries_its_reason_and_stops_the_rest_of_the_plan(runner, goal, ended):
    first, second = goal(fail), goal(arrive, where="kitchen")
    runner.submit([first, second])
    assert second.wait(60)
    assert (first.status, first.error) == (Status.FAILED, "the door is shut")
    assert (second.status, second.error) == (Status.CANCELLED, "fail failed")
    assert runner.wait_idle(5)
    assert ended == [first]


def test_a_skill_that_breaks_fails_its_goal_and_the_runner_goes_on(runner, goal, caplog):
    broken, after = goal(break_down), goal(arrive, where="kitchen")
    runner.submit([broken])
    assert broken.wait(60)
    assert broken.status is Status.FAILED
    assert "oops" in broken.error
    runner.submit([after])
    assert after.wait(60)
    assert after.status is Status.SUCCEEDED


def test_a_new_plan_preempts_the_running_one_which_ends_as_cancelled(runner, goal, bus, events):
    started = running(bus)
    old, new = goal(drive, where="kitchen"), goal(arrive, where="bedroom")
    runner.submit([old])
    assert started.wait(60)
    runner.submit([new])
    assert new.wait(60)
    assert (old.status, old.error) == (Status.CANCELLED, "pre-empted by arrive")
    assert new.status is Status.SUCCEEDED
    assert ("skill_cancelled", "pre-empted by arrive") in [
        (kind, data.get("reason")) for kind, data in events
    ]


def test_a_plan_that_never_ran_ends_as_cancelled_too(runner, goal, bus):
    started = running(bus)
    first, second, third = (goal(drive, where=w) for w in ("a", "b", "c"))
    runner.submit([first])
    assert started.wait(60)
    runner.submit([second])
    runner.submit([third])
    assert second.wait(60)
    assert second.status is Status.CANCELLED
    runner.cancel("enough")
    assert third.wait(60)
    assert runner.wait_idle(5)


def test_cancel_ends_the_running_goal_and_the_rest_of_its_plan(runner, goal, bus):
    started = running(bus)
    first, second = goal(drive, where="a"), goal(arrive, where="b")
    runner.submit([first, second])
    assert started.wait(60)
    assert runner.cancel("stop") is True
    assert second.wait(60)
    assert first.error == "stop"
    assert second.status is Status.CANCELLED
    assert runner.wait_idle(5)
    assert runner.cancel("again") is False


def test_closing_cancels_what_runs(goal, bus):
    started = running(bus)
    runner = GoalRunner(on_end=lambda _: None)
    runner.start()
    one = goal(drive, where="a")
    runner.submit([one])
    assert started.wait(60)
    runner.close()
    assert one.status is Status.CANCELLED
