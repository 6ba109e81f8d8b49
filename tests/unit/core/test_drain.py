"""A drain lets goals end within its bound, begins nothing new, and leaves the robot standing."""

import math
import threading

import pytest
from support.clock import HeldClock

from edgevox.agent.phrases.load import phrasebook
from edgevox.agent.skills import SkillFailed
from edgevox.agent.text.reasons import because
from edgevox.core.agent_events import DrainChanged, DrainStatus
from edgevox.core.bus import Bus
from edgevox.core.cancel import CancelToken
from edgevox.core.languages import LANGUAGES
from edgevox.core.motion.drain import BLIND_S, Drain
from edgevox.core.motion.interlock import Holder, Interlock, InterlockComponent
from edgevox.core.reason import NO_REASON
from edgevox.core.status import Level

DRAINING = because("draining")
BOUND_S, STAND_S = 20.0, 8.0
WAIT_S = 60.0
UNTRUE = "what is heard on odom cannot be true"


class Rig:
    """A robot whose goal and brakes end when the test's clock says so."""

    def __init__(self, bound_s=BOUND_S):
        self.clock, self.interlock, self.bus = HeldClock(), Interlock(), Bus()
        self.busy = self.moving = False
        self.happened, self.over = [], threading.Event()
        self.bus.subscribe(DrainChanged, self._changed)
        self.interlock.on_engage(lambda _: self.happened.append(("ended", self.clock.now_s)))
        self.drain = Drain(
            self.interlock,
            self.bus,
            halt=self.halt,
            busy=lambda: self.busy,
            stands=self.known,
            reason=DRAINING,
            bound_s=bound_s,
            stand_s=STAND_S,
            clock=self.clock,
            pause=lambda seconds: self.clock.wait(CancelToken(), seconds),
        )

    def drives(self, *, until_s=None, stands_s=0.0):
        """A goal that ends by itself at that time; after a halt it takes so long to stand."""
        self.busy = self.moving = True
        self.stands_after_s = stands_s
        if until_s is not None:
            self.clock.at(until_s, self.arrives)

    def arrives(self):
        self.busy = self.moving = False
        self.happened.append(("arrived", pytest.approx(self.clock.now_s)))

    def halt(self, reason):
        self.busy = False
        self.happened.append(("halt", self.clock.now_s))
        if self.moving and not self.stands_after_s:
            self.moving = False
        elif self.moving:
            self.clock.at(self.clock.now_s + self.stands_after_s, self.brakes)

    def known(self):
        return not self.moving

    def brakes(self):
        self.moving = False

    def drained(self):
        assert self.drain.until_over("SIGTERM") or self.over.wait(WAIT_S)
        assert self.over.wait(WAIT_S)
        return self.told[-1]

    @property
    def told(self):
        return [one.status for one in self.happened if isinstance(one, DrainChanged)]

    def when(self, what):
        return next(
            s
            for name, s in filter(lambda one: isinstance(one, tuple), self.happened)
            if name == what
        )

    def _changed(self, event):
        self.happened.append(event)
        if event.status is not DrainStatus.DRAINING:
            self.over.set()


class Blind(Rig):
    """Its odometry cannot be true, so that nobody knows whether it stands, until `sees_s`."""

    def __init__(self, sees_s=math.inf, *, halts=True):
        self.sees_s, self.halts = sees_s, halts
        super().__init__()

    def known(self):
        if self.clock.now_s < self.sees_s:
            raise SkillFailed(UNTRUE)
        return not self.moving

    def halt(self, reason):
        super().halt(reason)
        if not self.halts:
            raise SkillFailed(UNTRUE)


@pytest.mark.parametrize("halts", [True, False])
@pytest.mark.parametrize(
    ("sees_s", "ended"),
    [(math.inf, DrainStatus.NOT_STANDING), (BOUND_S + 1.0, DrainStatus.DRAINED)],
)
def test_a_robot_that_does_not_know_whether_it_stands_is_halted_and_told_of_in_one_line(
    caplog, halts, sees_s, ended
):
    rig = Blind(sees_s, halts=halts)
    rig.drives(stands_s=0.5)

    assert rig.drained() is ended

    assert rig.when("halt") == pytest.approx(BOUND_S, abs=0.1)
    assert "Traceback" not in caplog.text
    assert caplog.text.count("drain_unsure") == (ended is DrainStatus.NOT_STANDING)
    assert "drain_failed" not in caplog.text


def test_one_that_never_knows_is_not_waited_for_as_long_as_one_that_still_moves():
    rig = Blind()
    rig.drives(stands_s=0.5)
    assert rig.drained() is DrainStatus.NOT_STANDING
    assert rig.clock.now_s == pytest.approx(BOUND_S + BLIND_S, abs=0.1)


def test_a_goal_that_ends_in_time_is_not_cancelled(rig):
    rig.drives(until_s=12.0)
    assert rig.drained() is DrainStatus.DRAINED
    assert rig.when("ended") == pytest.approx(12.0, abs=0.1)


def test_one_that_does_not_is_ended_at_the_bound(rig):
    rig.drives()
    assert rig.drained() is DrainStatus.DRAINED
    assert rig.when("ended") == pytest.approx(BOUND_S, abs=0.1)
    assert rig.when("halt") == pytest.approx(BOUND_S, abs=0.1)


def test_with_a_bound_of_0_it_is_ended_at_once():
    rig = Rig(bound_s=0.0)
    rig.drives()
    assert rig.drained() is DrainStatus.DRAINED
    assert rig.when("halt") == 0.0


def test_a_stop_meanwhile_ends_the_wait(rig):
    rig.drives()
    rig.clock.at(3.0, lambda: rig.halt("heard a stop word"))
    assert rig.drained() is DrainStatus.DRAINED
    assert rig.when("ended") == pytest.approx(3.0, abs=0.1)


def test_it_is_over_only_when_the_robot_stands(rig):
    rig.drives(stands_s=1.5)
    assert rig.drained() is DrainStatus.DRAINED
    assert rig.clock.now_s == pytest.approx(BOUND_S + 1.5, abs=0.1)


def test_one_that_is_not_seen_to_stand_is_told_so(rig):
    rig.drives(stands_s=60.0)
    assert rig.drained() is DrainStatus.NOT_STANDING
    assert rig.drain.status is DrainStatus.NOT_STANDING


def test_who_breaks_while_the_goal_is_looked_at_keeps_nobody_from_halting(rig):
    def broken(_reason):
        raise ZeroDivisionError

    rig.drives()
    rig.interlock.on_engage(broken)
    assert rig.drained() is DrainStatus.NOT_STANDING
    assert not rig.moving


def test_nothing_new_begins_from_its_beginning_on_and_it_stays_so(rig):
    rig.drives(until_s=5.0)
    seen = []
    rig.clock.at(1.0, lambda: seen.append((rig.interlock.reason, rig.drain.status)))
    rig.drained()
    assert seen == [(DRAINING, DrainStatus.DRAINING)]
    assert rig.interlock.reason == DRAINING


def test_it_is_done_once_whoever_asks_again(rig):
    rig.drained()
    rig.drain.begin("edgevox-health")
    assert rig.drain.until_over("SIGTERM")
    assert rig.told == [DrainStatus.DRAINING, DrainStatus.DRAINED]
    assert {one.by for one in rig.happened if isinstance(one, DrainChanged)} == {"SIGTERM"}


def test_a_refusal_ends_nothing_and_who_engages_after_it_does():
    interlock, ended = Interlock(), []
    interlock.on_engage(ended.append)
    interlock.refuse(Holder.DRAIN, DRAINING)
    assert ended == []
    assert interlock.reason == DRAINING
    interlock.engage(Holder.SOFTWARE_STOP, because("software_stop"))
    assert ended == [because("software_stop")]
    interlock.release(Holder.SOFTWARE_STOP)
    assert interlock.reason == DRAINING
    interlock.release(Holder.DRAIN)
    assert interlock.reason is NO_REASON


def test_diagnostics_warn_from_its_beginning_on(rig):
    rig.drained()
    said = InterlockComponent(rig.interlock).status()
    assert said.level is Level.WARN
    assert "taken out of service" in said.message
    assert said.values == {"engaged": True, "holders": "drain", "streams_ended": 0}


@pytest.mark.parametrize("code", LANGUAGES)
def test_the_reason_is_said_in_every_language(code):
    reason = phrasebook(code).reason(DRAINING)
    assert (reason == str(DRAINING)) == (code == "en")
    assert reason.rstrip(".") in phrasebook(code).refusal(DRAINING)


@pytest.fixture
def rig():
    return Rig()
