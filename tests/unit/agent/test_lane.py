import threading

import phrases
import pytest

from edgevox.agent.goals import lane as lanes
from edgevox.agent.goals.goal import Goal
from edgevox.agent.goals.lane import Lane, Plan
from edgevox.agent.skills import SkillFailed, skill
from edgevox.core.agent_events import AgentEvent, GoalChanged, GoalStatus, as_json
from edgevox.core.bus import Bus
from edgevox.core.cancel import Cancelled
from edgevox.core.motion.deadlines import Deadlines


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
    bus.subscribe(AgentEvent, lambda e: heard.append((str(e.kind), as_json(e))))
    return heard


@pytest.fixture
def ended():
    return []


@pytest.fixture
def deadlines():
    one = Deadlines("deadlines")
    one.start()
    yield one
    one.close()


@pytest.fixture
def lane(ended, deadlines):
    one = Lane("test", deadlines, ended.append)
    one.start()
    yield one
    one.close()
    for thread in threading.enumerate():
        if thread.name == "edgevox-goals-test":
            thread.join(60)
            assert not thread.is_alive()


@pytest.fixture
def goal(bus):
    def make(skill_, **arguments):
        return Goal(skill_, arguments, turn=1, bus=bus)

    return make


def running(bus):
    started = threading.Event()
    bus.subscribe(GoalChanged, lambda e: started.set() if e.status == "running" else None)
    return started


def test_a_goal_ends_with_its_result(lane, goal, events, ended):
    one = goal(arrive, where="kitchen")
    lane.replace(Plan([one]))
    assert one.wait(60)
    assert one.status is GoalStatus.SUCCEEDED
    assert one.result == {"where": "kitchen"}
    assert [data["status"] for _, data in events] == ["accepted", "running", "succeeded"]
    assert lane.wait_idle(60)
    assert ended == [one]


def test_a_stop_while_its_begin_is_told_keeps_a_skill_from_beginning(lane, goal, bus):
    began = threading.Event()

    @skill()
    def move(goal):
        """Move before it looks whether it may."""
        began.set()

    one = goal(move)

    def stop(event):
        if event.status is GoalStatus.RUNNING:
            one.token.cancel("stop")

    bus.subscribe(GoalChanged, stop)
    lane.replace(Plan([one]))

    assert one.wait(60)
    assert (one.status, one.error) == (GoalStatus.CANCELLED, "stop")
    assert not began.is_set()


def test_a_failure_carries_its_reason_and_stops_the_rest_of_the_plan(lane, goal, ended):
    first, second = goal(fail), goal(arrive, where="kitchen")
    lane.replace(Plan([first, second]))
    assert second.wait(60)
    assert (first.status, first.error) == (GoalStatus.FAILED, "the door is shut")
    assert (second.status, second.error) == (GoalStatus.CANCELLED, "fail failed")
    assert lane.wait_idle(60)
    assert ended == [first]


def test_a_skill_that_breaks_fails_its_goal_and_the_runner_goes_on(lane, goal, caplog):
    broken, after = goal(break_down), goal(arrive, where="kitchen")
    lane.replace(Plan([broken]))
    assert broken.wait(60)
    assert broken.status is GoalStatus.FAILED
    assert "oops" in broken.error
    lane.replace(Plan([after]))
    assert after.wait(60)
    assert after.status is GoalStatus.SUCCEEDED


def test_a_new_plan_preempts_the_running_one_which_ends_as_cancelled(lane, goal, bus, events):
    started = running(bus)
    old, new = goal(drive, where="kitchen"), goal(arrive, where="bedroom")
    lane.replace(Plan([old]))
    assert started.wait(60)
    lane.replace(Plan([new]))
    assert new.wait(60)
    assert (old.status, old.error) == (
        GoalStatus.CANCELLED,
        phrases.why("preempted", skill="arrive"),
    )
    assert new.status is GoalStatus.SUCCEEDED
    assert ("skill_cancelled", phrases.why("preempted", skill="arrive")) in [
        (kind, data.get("reason")) for kind, data in events
    ]


def test_a_plan_that_never_ran_ends_as_cancelled_too(lane, goal, bus):
    started = running(bus)
    first, second, third = (goal(drive, where=w) for w in ("a", "b", "c"))
    lane.replace(Plan([first]))
    assert started.wait(60)
    lane.replace(Plan([second]))
    lane.replace(Plan([third]))
    assert second.wait(60)
    assert second.status is GoalStatus.CANCELLED
    lane.cancel("enough")
    assert third.wait(60)
    assert lane.wait_idle(60)


def test_cancel_ends_the_running_goal_and_the_rest_of_its_plan(lane, goal, bus):
    started = running(bus)
    first, second = goal(drive, where="a"), goal(arrive, where="b")
    lane.replace(Plan([first, second]))
    assert started.wait(60)
    assert lane.cancel("stop") is True
    assert second.wait(60)
    assert first.error == "stop"
    assert second.status is GoalStatus.CANCELLED
    assert lane.wait_idle(60)
    assert lane.cancel("again") is False


def test_closing_cancels_what_runs(goal, bus, deadlines):
    started = running(bus)
    lane = Lane("closing", deadlines)
    lane.start()
    one = goal(drive, where="a")
    lane.append(Plan([one]))
    assert started.wait(60)
    lane.close()
    assert one.status is GoalStatus.CANCELLED


def test_a_plan_that_comes_when_it_is_closed_ends_as_cancelled(goal, deadlines):
    lane = Lane("closed", deadlines)
    lane.close()
    one, other = goal(arrive, where="a"), goal(arrive, where="b")
    lane.append(Plan([one]))
    lane.replace(Plan([other]))
    assert (one.error, other.error) == (phrases.why("shutting_down"),) * 2


def test_plans_that_are_appended_run_in_their_order_and_pre_empt_nothing(lane, goal, bus, ended):
    started = running(bus)
    first, *others = goal(drive, where="a"), goal(arrive, where="b"), goal(arrive, where="c")
    for one in (first, *others):
        lane.append(Plan([one]))
    assert started.wait(60)
    assert lane.waiting == 2
    first.token.cancel("enough")
    assert others[-1].wait(60)
    assert lane.wait_idle(60)
    assert ended == [first, *others]
    assert [one.status for one in ended] == ["cancelled", "succeeded", "succeeded"]


@pytest.fixture
def wander():
    """A skill that never looks at its token, and an event that lets it go."""
    free = threading.Event()

    @skill()
    def wander(goal):
        """Wander until it is freed."""
        free.wait(60)
        return {"late": True}

    yield wander, free
    free.set()


def test_a_skill_that_hangs_is_left_alone_and_the_lane_goes_on(
    lane, goal, bus, ended, wander, monkeypatch
):
    monkeypatch.setattr(lanes, "GRACE_S", 0.0)
    started = running(bus)
    hangs, rest, after = goal(wander[0]), goal(arrive, where="b"), goal(arrive, where="c")
    lane.replace(Plan([hangs, rest]))
    assert started.wait(60)
    lane.replace(Plan([after]))
    assert after.wait(60)
    assert lane.wait_idle(60)
    assert (hangs.status, hangs.error) == (
        GoalStatus.CANCELLED,
        phrases.why("preempted", skill="arrive"),
    )
    assert (rest.status, after.status) == (GoalStatus.CANCELLED, GoalStatus.SUCCEEDED)
    assert ended == [hangs, after]
    assert lane.busy is False


def test_what_hangs_ends_once_whenever_it_comes_back(lane, goal, events, ended, wander):
    late = goal(wander[0])
    lane.append(Plan([late], limit_s=0.0))
    assert late.wait(60)
    wander[1].set()
    after = goal(arrive, where="kitchen")
    lane.append(Plan([after]))
    assert after.wait(60)
    assert lane.wait_idle(60)
    assert (late.status, late.error) == (
        GoalStatus.FAILED,
        phrases.why("took_too_long", skill="wander", seconds="0"),
    )
    assert ended == [late, after]
    assert [data["status"] for _, data in events if data["skill"] == "wander"][-1] == "failed"


def test_a_limit_that_is_not_reached_ends_nothing(lane, goal):
    one = goal(arrive, where="kitchen")
    lane.append(Plan([one], limit_s=3600.0))
    assert one.wait(60)
    assert one.status is GoalStatus.SUCCEEDED


def test_where_the_machine_gives_no_more_threads_the_lane_goes_on_when_the_skill_does(
    lane, goal, wander, monkeypatch, caplog
):
    hangs, after = goal(wander[0]), goal(arrive, where="kitchen")

    def refuse(_):
        raise RuntimeError("can't start new thread")

    monkeypatch.setattr(threading.Thread, "start", refuse)
    lane.append(Plan([hangs], limit_s=0.0))
    lane.append(Plan([after]))
    assert hangs.wait(60)
    wander[1].set()
    assert after.wait(60)
    assert (hangs.status, after.status) == (GoalStatus.FAILED, GoalStatus.SUCCEEDED)
