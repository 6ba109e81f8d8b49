"""Who may move a body: at most one at any time, and whatever happens each motion ends once."""

import math
import threading

import pytest
from hypothesis import settings
from hypothesis import strategies as st
from hypothesis.stateful import RuleBasedStateMachine, initialize, invariant, precondition, rule

from edgevox.agent.skills import SkillFailed
from edgevox.core.cancel import Cancelled, CancelToken
from edgevox.core.errors import InvalidValue
from edgevox.robots.capabilities import Twist2D
from edgevox.robots.command_mux import STILL, WATCHDOG_S, CommandMux
from edgevox.robots.motion import Motion, Progress

STEP_S = 1 / 64  # a float counts in these exactly, so the watchdog can be held to a step
WATCHDOG_STEPS = round(WATCHDOG_S / STEP_S)
MAX_LINEAR_M_S, MAX_ANGULAR_RAD_S = 0.8, 2.0
AHEAD = Twist2D(0.5, 0.0)
speeds = st.just(0.0) | st.floats(-3.0, 3.0)
not_finite = st.sampled_from([math.nan, math.inf, -math.inf])


class Trip(Motion):
    """A motion that counts its ends."""

    def __init__(self) -> None:
        super().__init__()
        self.ends: list[BaseException | None] = []

    def progress(self) -> Progress:
        return Progress(1.0 if self.done else 0.0)

    def end(self, error: BaseException | None = None) -> bool:
        first = super().end(error)
        if first:
            self.ends.append(error)
        return first


def mux_of(halts: list[BaseException] | None = None) -> CommandMux[Trip]:
    return CommandMux(
        threading.RLock(),
        max_linear_m_s=MAX_LINEAR_M_S,
        max_angular_rad_s=MAX_ANGULAR_RAD_S,
        on_halt=lambda _, error: halts.append(error) if halts is not None else None,
    )


class Requests(RuleBasedStateMachine):
    """Random requests, in any order, beside a model of what must come of them.

    The model is what runs by the rules: a motion, or a velocity and the step it was asked for at.
    """

    @initialize()
    def begin(self) -> None:
        self.halted: list[BaseException] = []
        self.mux = mux_of(self.halted)
        self.steps = 0
        self.running: Trip | None = None
        self.asked: Twist2D | None = None
        self.asked_at = 0
        self.bites = 0
        self.ended: dict[Trip, BaseException | str | None] = {}

    @rule()
    def start(self) -> None:
        motion = Trip()
        assert self.mux.start(lambda: motion) is motion
        self.over("a new goal came")
        self.running, self.asked = motion, None

    @rule()
    def start_what_is_refused(self) -> None:
        refusal = SkillFailed("no way leads there")

        def refuse() -> Trip:
            raise refusal

        with pytest.raises(SkillFailed) as refused:
            self.mux.start(refuse)
        assert refused.value is refusal

    @rule(linear=speeds, angular=speeds)
    def stream(self, linear: float, angular: float) -> None:
        self.mux.stream(Twist2D(linear, angular), self.time_s)
        self.over("somebody else steers")
        self.asked, self.asked_at = Twist2D(linear, angular), self.steps

    @rule(wrong=not_finite, right=speeds, turned=st.booleans())
    def stream_what_is_no_number(self, wrong: float, right: float, turned: bool) -> None:
        twist = Twist2D(right, wrong) if turned else Twist2D(wrong, right)
        field = "angular_rad_s" if turned else "linear_m_s"
        with pytest.raises(InvalidValue, match=f"{field}: got .*, expected a finite number"):
            self.mux.stream(twist, self.time_s)

    @rule()
    def halt(self) -> None:
        error = Cancelled("the stop word")
        moved = self.running is not None or self.asked is not None
        assert self.mux.halt(error) is moved
        assert self.halted.pop() is error
        self.over(error)
        self.asked = None
        assert not self.mux.busy

    @precondition(lambda self: self.running is not None)
    @rule()
    def halt_the_one_that_runs(self) -> None:
        error = Cancelled("never mind")
        assert self.mux.halt(error, only=self.running)
        assert self.halted.pop() is error
        self.over(error)
        assert not self.mux.busy

    @rule()
    def halt_one_that_does_not_run(self) -> None:
        others = [motion for motion in self.ended if motion is not self.running]
        for motion in [*others, Trip()]:
            assert not self.mux.halt(Cancelled("too late"), only=motion)

    @precondition(lambda self: self.running is not None)
    @rule(error=st.sampled_from([None, SkillFailed("I am stuck.")]))
    def finish(self, error: BaseException | None) -> None:
        assert self.running is not None
        assert self.running.end(error)
        self.over(error)

    @rule()
    def finish_what_is_over(self) -> None:
        assert not any(motion.end(SkillFailed("again")) for motion in self.ended)

    @rule(steps=st.just(WATCHDOG_STEPS) | st.integers(1, WATCHDOG_STEPS + 5))
    def advance(self, steps: int) -> None:
        for _ in range(steps):
            self.steps += 1
            self.mux.tick(self.time_s)
            if self.asked and self.steps - self.asked_at >= WATCHDOG_STEPS:
                self.bites += self.asked != STILL
                self.asked = None
            self.only_what_should_moves_it()

    @invariant()
    def only_what_should_moves_it(self) -> None:
        assert self.mux.motion is self.running
        asked = self.mux.velocity
        assert (asked is None) == (self.asked is None)
        if asked and self.asked:
            assert abs(asked.linear_m_s) == min(abs(self.asked.linear_m_s), MAX_LINEAR_M_S)
            assert abs(asked.angular_rad_s) == min(abs(self.asked.angular_rad_s), MAX_ANGULAR_RAD_S)
            assert asked.linear_m_s * self.asked.linear_m_s >= 0.0
            assert asked.angular_rad_s * self.asked.angular_rad_s >= 0.0
        assert self.mux.motion is None or self.mux.velocity is None, "two move it"
        assert self.mux.busy == (self.mux.motion is not None or self.mux.velocity is not None)
        assert self.mux.watchdog_halts == self.bites
        assert not self.halted, "nothing but a halt brakes it"

    @invariant()
    def each_motion_ends_once_and_with_its_reason(self) -> None:
        assert self.running is None or self.running.ends == []
        for motion, reason in self.ended.items():
            (error,) = motion.ends
            assert error is motion.error
            if isinstance(reason, str):
                assert isinstance(error, Cancelled)
                assert str(error) == reason
            else:
                assert error is reason

    @property
    def time_s(self) -> float:
        return self.steps * STEP_S

    def over(self, reason: BaseException | str | None) -> None:
        """What ran ends so."""
        if self.running is not None:
            self.ended[self.running] = reason
            self.running = None


TestRequests = Requests.TestCase
TestRequests.settings = settings(max_examples=100, stateful_step_count=30)


def test_a_motion_that_many_threads_end_at_once_ends_once() -> None:
    for _ in range(50):
        motion, ready = Trip(), threading.Barrier(4)
        first: list[str] = []

        def end(name: str, motion: Trip = motion, ready: threading.Barrier = ready) -> None:
            ready.wait()
            if motion.end(Cancelled(name)):
                first.append(name)  # noqa: B023 - the threads are joined in this turn

        threads = [threading.Thread(target=end, args=(name,)) for name in "abcd"]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()

        assert [str(motion.error)] == first


def carried_out(
    mux: CommandMux[Trip], motion: Trip, token: CancelToken
) -> tuple[threading.Thread, list[float], list[BaseException]]:
    """A thread that carries it out, what it reports, and what it raises."""
    reports: list[float] = []
    raised: list[BaseException] = []

    def run() -> None:
        try:
            mux.carry_out(motion, token, lambda: reports.append(motion.progress().part))
        except (Cancelled, SkillFailed) as error:
            raised.append(error)

    thread = threading.Thread(target=run)
    thread.start()
    return thread, reports, raised


@pytest.mark.parametrize("error", [None, SkillFailed("I am stuck.")])
def test_who_waits_for_a_motion_is_told_its_end_and_a_last_report(error) -> None:
    mux = mux_of()
    motion = mux.start(Trip)
    thread, reports, raised = carried_out(mux, motion, CancelToken())

    motion.end(error)
    thread.join()

    assert raised == ([error] if error else [])
    assert reports[-1] == 1.0


def test_a_token_brakes_the_body_whether_it_is_cancelled_before_or_after() -> None:
    for cancelled_before in (True, False):
        halts: list[BaseException] = []
        mux, token = mux_of(halts), CancelToken()
        motion = mux.start(Trip)
        if cancelled_before:
            token.cancel("never mind")
        thread, _, raised = carried_out(mux, motion, token)
        token.cancel("never mind")
        thread.join()

        assert [str(error) for error in raised] == ["never mind"]
        assert halts == raised
        assert not mux.busy


def test_the_token_of_a_motion_that_was_replaced_disturbs_nothing() -> None:
    mux, token = mux_of(), CancelToken()
    first = mux.start(Trip)
    thread, _, raised = carried_out(mux, first, token)
    second = mux.start(Trip)

    token.cancel("too late")
    thread.join()

    assert [str(error) for error in raised] == ["a new goal came"]
    assert mux.motion is second


def test_a_body_that_cannot_brake_still_ends_what_moved_it() -> None:
    def fail(*_: object) -> None:
        raise OSError("the wheels do not answer")

    mux: CommandMux[Trip] = CommandMux(threading.RLock(), on_halt=fail)
    motion = mux.start(Trip)

    with pytest.raises(OSError, match="do not answer"):
        mux.halt(Cancelled("the stop word"))

    assert str(motion.error) == "the stop word"
    assert not mux.busy


def test_a_watchdog_that_bites_is_logged_and_counted_but_not_after_a_stand(caplog) -> None:
    mux = mux_of()
    mux.stream(STILL, 0.0)
    mux.tick(WATCHDOG_S)
    assert "watchdog_halted" not in caplog.text

    mux.stream(AHEAD, WATCHDOG_S)
    mux.tick(2 * WATCHDOG_S)
    assert "watchdog_halted" in caplog.text
    assert mux.watchdog_halts == 1
