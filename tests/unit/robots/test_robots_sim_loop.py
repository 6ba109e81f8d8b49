"""The world's time keeps pace with the clock, survives failures, and ends when told."""

import logging
import threading

import pytest
from guards import HUNG_S
from hypothesis import given
from hypothesis import strategies as st
from support.clock import HeldClock

from edgevox.core.errors import InvalidValue
from edgevox.robots.sim_loop import MOST_LAG_S, Pacer, SimLoop


def run(step, *, speed: float | None, until_s: float) -> tuple[SimLoop, list[float]]:
    """Let it step until the clock, which only its sleeping moves, is there; how long it slept."""
    clock, over, sleeps = HeldClock(), threading.Event(), []

    def sleep(seconds: float) -> None:
        if clock.now_s >= until_s:
            over.set()
            threading.Event().wait(0.001)
            return
        sleeps.append(seconds)
        clock.now_s += seconds

    sim_loop = SimLoop(step, period_s=0.02, speed=speed, clock=clock, sleep=sleep)
    sim_loop.start()
    assert over.wait(HUNG_S)
    sim_loop.close()
    return sim_loop, sleeps


@pytest.mark.parametrize(("speed", "steps"), [(1.0, 100), (5.0, 500), (0.5, 50)])
def test_as_many_steps_are_taken_as_the_speed_asks_for(speed: float, steps: int) -> None:
    taken = []

    sim_loop, sleeps = run(lambda: bool(taken.append(1)), speed=speed, until_s=2.0)

    assert len(taken) == pytest.approx(steps, abs=2)
    assert sim_loop.real_time_factor == pytest.approx(speed, rel=0.05)
    assert min(sleeps) > 0, "it never spins"


def test_after_a_stall_it_catches_up_a_little_and_drops_the_rest() -> None:
    pacer = Pacer(0.02, now_s=0.0)

    steps = 0
    while pacer.wait_s(10.0) <= 0:
        pacer.stepped()
        steps += 1

    assert steps == pytest.approx(MOST_LAG_S / 0.02, abs=1)


def test_a_step_that_fails_is_logged_once_in_a_while_and_the_next_one_comes(
    caplog: pytest.LogCaptureFixture,
) -> None:
    taken = []

    def step() -> bool:
        taken.append(1)
        if 3 <= len(taken) < 10:
            raise ValueError("no such luck")
        return True

    with caplog.at_level(logging.ERROR):
        sim_loop, _ = run(step, speed=1.0, until_s=1.0)

    assert sim_loop.failures == 7
    assert len(taken) > 10
    assert caplog.text.count("world_step_failed") == 3


def test_as_fast_as_it_can_it_stands_still_until_there_is_something_to_do() -> None:
    taken = threading.Semaphore(0)

    def step() -> bool:
        taken.release()
        return False

    sim_loop = SimLoop(step, period_s=0.02, speed=None)
    sim_loop.start()
    try:
        assert taken.acquire(timeout=60)
        assert not taken.acquire(timeout=0.05)
        sim_loop.wake()
        assert taken.acquire(timeout=60)
    finally:
        sim_loop.close()
    assert not sim_loop.running


@pytest.mark.parametrize("speed", [-1.0, float("nan"), 1e9])
def test_a_speed_that_makes_no_sense_is_refused(speed: float) -> None:
    with pytest.raises(InvalidValue, match="speed"):
        SimLoop(lambda: False, period_s=0.02, speed=speed)


@pytest.mark.parametrize("speed", [None, 0.0])
def test_as_much_time_passes_as_somebody_asks_for(speed: float | None) -> None:
    taken = []
    sim_loop = SimLoop(lambda: bool(taken.append(1)), period_s=0.02, speed=speed)
    sim_loop.start()
    try:
        before = len(taken)
        sim_loop.advance(2.0)
        assert abs(len(taken) - before - 100) <= 1  # its first step may be on its way
    finally:
        sim_loop.close()


def test_a_world_held_in_the_hand_stands_still_while_it_is_busy() -> None:
    taken = []

    def step() -> bool:
        taken.append(1)
        return True  # always busy

    sim_loop = SimLoop(step, period_s=0.02, speed=0.0)
    sim_loop.start()
    try:
        for _ in range(50):
            sim_loop.wake()
        sim_loop.advance(0.1)
        assert len(taken) == 5
    finally:
        sim_loop.close()


def test_whoever_waits_for_time_to_pass_is_let_go_at_the_end() -> None:
    stepping = threading.Event()
    sim_loop = SimLoop(lambda: stepping.set() or True, period_s=0.02, speed=0.001)
    sim_loop.start()
    waiter = threading.Thread(target=sim_loop.advance, args=(1000.0,))
    waiter.start()
    assert stepping.wait(60)
    sim_loop.close()
    waiter.join(60)
    assert not waiter.is_alive()


def test_a_loop_that_never_started_can_be_closed() -> None:
    SimLoop(lambda: False, period_s=0.02).close()


@given(st.lists(st.floats(0.0, MOST_LAG_S - 0.02), max_size=30))
def test_a_world_at_rest_is_stepped_by_who_looks_as_often_as_the_clock_says(looks) -> None:
    clock, taken = HeldClock(100.0), []
    sim_loop = SimLoop(
        lambda: bool(taken.append(1)), period_s=0.02, clock=clock, rests=lambda: True
    )
    sim_loop.start()
    try:
        for seconds in looks:
            clock.now_s += seconds
            sim_loop.catch_up()
            assert len(taken) == pytest.approx((clock.now_s - 100.0) / 0.02, abs=1.01)
    finally:
        sim_loop.close()
    sim_loop.catch_up()
    assert len(taken) == pytest.approx((clock.now_s - 100.0) / 0.02, abs=1.01), "it is closed"


def test_a_world_that_moves_is_stepped_by_its_own_thread_only() -> None:
    clock, threads, moving = HeldClock(), set(), threading.Event()

    def step() -> bool:
        threads.add(threading.current_thread().name)
        moving.set()
        return True

    sim_loop = SimLoop(step, period_s=0.02, clock=clock, name="world", rests=lambda: False)
    sim_loop.start()
    try:
        assert moving.wait(HUNG_S)
        clock.now_s += 0.1
        sim_loop.catch_up()
    finally:
        sim_loop.close()
    assert threads == {"world"}


def test_a_world_at_rest_that_is_woken_moves_at_once() -> None:
    rests, moved = threading.Event(), threading.Event()
    rests.set()
    sim_loop = SimLoop(
        lambda: rests.is_set() or bool(moved.set()), period_s=0.02, rests=rests.is_set
    )
    sim_loop.start()
    try:
        rests.clear()
        sim_loop.wake()
        assert moved.wait(HUNG_S)
    finally:
        sim_loop.close()
