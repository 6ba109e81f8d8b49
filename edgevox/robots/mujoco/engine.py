"""The engine that lets a MuJoCo world's time pass, period by period, on its own thread."""

import math
import threading
from typing import Protocol

import mujoco

from edgevox.core.clock import Clock
from edgevox.core.log import get_logger
from edgevox.robots.mujoco.renderer import Snapshot
from edgevox.robots.sim_loop import SimLoop, SteppedBySimLoop

log = get_logger(__name__)

_BROKEN = slice(mujoco.mjtWarning.mjWARN_BADQPOS, mujoco.mjtWarning.mjWARN_BADQACC + 1)


class Steered(Protocol):
    """The inhabitant of a world. Both methods are called on the world's thread, under the lock."""

    def control(self) -> bool:
        """Set `data.ctrl` for the next period. True while there is more to do."""

    def put_back(self) -> None:
        """The numbers broke (not finite, or absurd): set `data` to a state that can go on."""


class MujocoEngine(SteppedBySimLoop):
    """A model, its data, and the thread that steps it `period_s` at a time.

    `lock` guards `data`. `waits` is whether time can be held, because it follows no clock. Time is
    counted in periods and never goes back, even after a reset. With a `speed`, time passes always;
    with None only while `control` has more to do or as far as `advance` asks, as fast as possible;
    with 0 only as far as `advance` asks.
    """

    def __init__(
        self,
        model: mujoco.MjModel,
        *,
        period_s: float,
        speed: float | None = 1.0,
        clock: Clock | None = None,
        name: str = "robot",
    ) -> None:
        self.model = model
        self.data = mujoco.MjData(model)
        self.lock = threading.Condition(threading.RLock())
        self.period_s = period_s
        self.divergences = 0
        self._noticed, self._positions = self.data.warning.number[_BROKEN], self.data.qpos
        self._substeps = max(1, round(period_s / model.opt.timestep))
        self.waits = not speed
        self._always = speed is not None
        self._steered: Steered | None = None
        self._periods = 0
        self._wanted = 0
        self._sim_loop = SimLoop(
            self._step, period_s=period_s, speed=speed, clock=clock, name=f"{name} world"
        )

    @property
    def time_s(self) -> float:
        return self._periods * self.period_s

    @property
    def running(self) -> bool:
        return self._sim_loop.running

    @property
    def breaks(self) -> int:
        """The number of steps that failed, or whose numbers broke and were put back."""
        return self.divergences + self._sim_loop.failures

    def start(self, steered: Steered) -> None:
        self._steered = steered
        self._sim_loop.start()

    def close(self) -> None:
        """Let no more time pass and join the thread."""
        self._sim_loop.close()

    def wake(self) -> None:
        """Tell the loop that there is work."""
        self._sim_loop.wake()

    def snapshot(self) -> Snapshot:
        """A copy of this moment, for drawing it or planning from it."""
        with self.lock:
            return Snapshot.of(self.data, self.time_s)

    def advance(self, seconds: float) -> None:
        """Block until this much of the world's time has passed, or the engine is closed."""
        with self.lock:
            until = self._periods + max(1, round(seconds / self.period_s))
            self._wanted = max(self._wanted, until)
        while self.running and self._periods < until:
            self._sim_loop.advance((until - self._periods) * self.period_s)

    def _step(self) -> bool:
        """Do a period, on the sim loop's thread. Return whether more is to come."""
        assert self._steered is not None  # noqa: S101 - start came first
        with self.lock:
            busy = self._steered.control()
            if busy or self._always or self._periods < self._wanted:
                self._periods += 1
                mujoco.mj_step(self.model, self.data, self._substeps)
                if self._is_broken():
                    self._recover()
            return busy

    def _is_broken(self) -> bool:
        """MuJoCo resets by itself what it notices, and counts it; what it misses is not finite.

        After every period, so in the way that is fastest: a sum of squares is as finite as they.
        """
        return any(self._noticed.tolist()) or not math.isfinite(
            self._positions.dot(self._positions)
        )

    def _recover(self) -> None:
        self.divergences += 1
        log.error("physics_broke", divergences=self.divergences)
        mujoco.mj_resetData(self.model, self.data)
        if self._steered is not None:
            self._steered.put_back()
