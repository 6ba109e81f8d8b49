"""A world whose time passes as it is told."""

import threading
from collections.abc import Iterator

import mujoco
import pytest
from guards import HUNG_S

from edgevox.robots.mujoco.engine import MujocoEngine

BALL = """
<mujoco><option timestep="0.005"/><worldbody>
  <geom type="plane" size="1 1 1"/>
  <body pos="0 0 1"><freejoint/><geom size="0.1"/></body>
</worldbody></mujoco>
"""
PERIOD_S = 0.02


class Ball:
    """Falls; is busy for so many periods."""

    def __init__(self, engine: MujocoEngine, periods: int = 0) -> None:
        self.left = periods
        self.put_back_times = 0
        self.idle = threading.Event()
        self._engine = engine

    def control(self) -> bool:
        self.left -= 1
        if self.left < 0:
            self.idle.set()
        return self.left >= 0

    def put_back(self) -> None:
        self.put_back_times += 1
        self._engine.data.qpos[2] = 1.0


@pytest.fixture
def engines() -> Iterator[list[MujocoEngine]]:
    made: list[MujocoEngine] = []
    yield made
    for engine in made:
        engine.close()


def falling(
    engines: list[MujocoEngine], speed: float | None, busy: int = 0
) -> tuple[MujocoEngine, Ball]:
    engine = MujocoEngine(mujoco.MjModel.from_xml_string(BALL), period_s=PERIOD_S, speed=speed)
    engines.append(engine)
    ball = Ball(engine, busy)
    engine.start(ball)
    return engine, ball


@pytest.mark.parametrize("speed", [0.0, None, 100.0])
def test_it_advances_as_far_as_it_is_asked(engines, speed) -> None:
    engine, _ = falling(engines, speed)
    began = engine.time_s
    engine.advance(0.2)

    assert engine.time_s >= began + 0.2 - 1e-9
    assert engine.snapshot().qpos[2] < 0.9
    if not speed:
        assert engine.time_s == pytest.approx(0.2)


def test_as_fast_as_it_can_it_runs_while_busy_and_no_further(engines) -> None:
    engine, ball = falling(engines, None, busy=10)
    with engine.lock:
        engine.lock.notify_all()
    assert ball.idle.wait(HUNG_S)

    assert engine.time_s == pytest.approx(10 * PERIOD_S)
    engine.wake()
    engine.advance(PERIOD_S)
    assert engine.time_s == pytest.approx(11 * PERIOD_S)


@pytest.mark.parametrize("value", [float("nan"), 1e12])
def test_numbers_that_break_are_put_back_and_counted(engines, value) -> None:
    engine, ball = falling(engines, 0.0)
    engine.advance(0.1)
    with engine.lock:
        engine.data.qvel[2] = value

    engine.advance(0.1)

    assert engine.divergences == ball.put_back_times == 1
    assert engine.time_s == pytest.approx(0.2)
    assert 0.5 < engine.snapshot().qpos[2] <= 1.0


def test_closing_ends_an_advance_that_waits(engines) -> None:
    engine, _ = falling(engines, 0.01)
    waiting = threading.Thread(target=engine.advance, args=(100.0,))
    waiting.start()

    engine.close()
    waiting.join(HUNG_S)

    assert not waiting.is_alive()
