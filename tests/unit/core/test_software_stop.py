"""The software stop holds until somebody resumes, whoever else forbids motion meanwhile."""

import phrases
import pytest

from edgevox.agent.phrases.load import phrasebook
from edgevox.agent.policy import Denied, Guard
from edgevox.agent.skills import SkillFailed
from edgevox.agent.text.reasons import because
from edgevox.core.agent_events import SoftwareStopChanged
from edgevox.core.bus import Bus
from edgevox.core.commands import Way
from edgevox.core.errors import InvalidValue
from edgevox.core.languages import LANGUAGES
from edgevox.core.motion.interlock import Holder, Interlock, InterlockComponent
from edgevox.core.motion.software_stop import SoftwareStop, StopState
from edgevox.core.reason import NO_REASON
from edgevox.core.status import Level
from edgevox.robots.capabilities import Twist2D
from edgevox.robots.limits import Steering

STOPPED, OTHER = because("software_stop"), because("other_agent")
NOON_S = 1_800_000_000.0


class Rig:
    """The stop of a robot that writes down, in order, what is asked of it and what is told."""

    def __init__(self):
        self.interlock, self.bus = Interlock(), Bus()
        self.happened = []
        self.bus.subscribe(SoftwareStopChanged, self.happened.append)
        self.stop = SoftwareStop(self.interlock, self.bus, self.halt, STOPPED, now=lambda: NOON_S)
        self.meanwhile = lambda: None

    def halt(self, reason):
        self.happened.append("halt")
        return True

    def set_velocity(self, twist):
        self.happened.append(twist)
        self.meanwhile()


@pytest.fixture
def rig():
    return Rig()


def test_a_press_halts_and_is_told_once_and_each_further_press_halts_again(rig):
    rig.stop.stop("a phone")
    assert rig.happened[-1] == SoftwareStopChanged(engaged=True, by="a phone")
    assert "halt" in rig.happened
    assert rig.stop.state == StopState(engaged=True, by="a phone", since=NOON_S)
    rig.happened.clear()
    rig.stop.stop("another")
    assert set(rig.happened) == {"halt"}
    assert rig.stop.state.by == "a phone"


def test_the_body_is_halted_before_anybody_is_told_of_what_was_ended(rig):
    rig.interlock.on_engage(lambda _: lambda: rig.happened.append("told"))
    rig.stop.stop("a phone")
    assert rig.happened.index("halt") < rig.happened.index("told")


def test_it_halts_also_where_somebody_else_breaks_on_hearing_of_it(rig):
    def broken(reason):
        raise ZeroDivisionError

    rig.interlock.on_engage(broken)
    rig.happened.clear()
    with pytest.raises(ZeroDivisionError):
        rig.stop.stop("a phone")
    assert "halt" in rig.happened
    assert rig.interlock.reason == STOPPED


def test_it_stays_until_somebody_resumes_which_is_told_once(rig):
    rig.stop.resume("nobody had stopped it")
    assert rig.happened == []
    rig.stop.stop("a phone")
    rig.stop.resume("a tablet")
    rig.stop.resume("a tablet")
    assert [one for one in rig.happened if one != "halt"] == [
        SoftwareStopChanged(engaged=True, by="a phone"),
        SoftwareStopChanged(engaged=False, by="a tablet"),
    ]
    assert rig.interlock.reason is NO_REASON
    assert not rig.stop.state.engaged


def test_whoever_listens_hears_each_state_until_they_leave(rig):
    states = []
    forget = rig.stop.listen(states.append)
    rig.stop.stop("a phone")
    forget()
    rig.stop.resume("a phone")
    assert states == [StopState(engaged=True, by="a phone", since=NOON_S)]


@pytest.mark.parametrize("first", [True, False])
def test_whoever_else_forbids_motion_releases_only_what_is_theirs(rig, first):
    if first:
        rig.interlock.engage(Holder.PRESENCE, OTHER)
    rig.stop.stop("a phone")
    rig.interlock.engage(Holder.PRESENCE, OTHER)
    assert rig.interlock.reason == (OTHER if first else STOPPED)
    rig.interlock.release(Holder.PRESENCE)
    assert rig.interlock.reason == STOPPED
    rig.interlock.engage(Holder.PRESENCE, OTHER)
    rig.stop.resume("a phone")
    assert rig.interlock.reason == OTHER
    rig.interlock.release(Holder.PRESENCE)
    assert rig.interlock.reason is NO_REASON


def test_its_component_warns_for_as_long_and_names_who_holds_it(rig):
    component = InterlockComponent(rig.interlock)
    assert component.status().level is Level.OK
    rig.stop.stop("a phone")
    rig.interlock.engage(Holder.PRESENCE, OTHER)
    said = component.status()
    assert said.level is Level.WARN
    assert "I was stopped" in said.message
    assert said.values == {
        "engaged": True,
        "holders": "software_stop, presence",
        "streams_ended": 0,
    }
    assert not component.checks, "a stopped robot is healthy: nobody is to restart it"


def test_no_velocity_but_a_stand_is_followed_while_it_is_stopped(rig):
    steering = Steering(rig, rig.interlock, Guard().velocity)
    rig.stop.stop("a phone")
    rig.happened.clear()
    with pytest.raises(SkillFailed, check=phrases.because("software_stop")):
        steering.steer(0.3, 0.0)
    assert rig.happened == []
    steering.steer(0.0, 0.0)
    assert rig.happened == [Twist2D(0.0, 0.0)]


def test_a_velocity_that_comes_at_the_very_moment_of_the_press_leaves_it_halted(rig):
    """The press falls between the question whether it may move and the velocity."""
    steering = Steering(rig, rig.interlock, Guard().velocity)
    rig.meanwhile = lambda: rig.stop.stop("a phone")
    with pytest.raises(SkillFailed, check=phrases.because("software_stop")):
        steering.steer(0.3, 0.0)
    assert rig.happened[-1] == "halt"


@pytest.mark.parametrize("wrong", [(float("nan"), 0.0), (0.0, float("inf"))])
def test_what_is_no_number_is_not_followed(rig, wrong):
    with pytest.raises(InvalidValue):
        Steering(rig, rig.interlock, Guard().velocity).steer(*wrong)
    assert rig.happened == []


def test_the_policy_is_asked_of_a_velocity_by_its_own_way(rig, tmp_path):
    file = tmp_path / "policy.yaml"
    file.write_text("rules: {console_operator: {cmd_vel: deny}}\n")
    guard = Guard(file)
    assert guard.velocity(0.3, 0.0) == (0.3, 0.0)
    with pytest.raises(Denied) as denied:
        guard.velocity(0.3, 0.0, Way.CONSOLE_OPERATOR)
    assert denied.value.way is Way.CONSOLE_OPERATOR
    assert guard.velocity(0.0, 0.0, Way.CONSOLE_OPERATOR) == (0.0, 0.0)


@pytest.mark.parametrize("code", LANGUAGES)
def test_the_reason_is_said_in_every_language(code):
    reason = phrasebook(code).reason(STOPPED)
    assert (reason == str(STOPPED)) == (code == "en")
    assert reason.rstrip(".") in phrasebook(code).refusal(STOPPED)
