"""The command mux: lets one source at a time move a body, a goal's motion or a velocity stream.

The newest request wins and ends the one before, so at most one source moves the body at any time.
"""

from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager
from typing import Generic, TypeVar

from edgevox.agent.text.reasons import called_off
from edgevox.core.cancel import Cancelled, CancelToken
from edgevox.core.errors import finite
from edgevox.core.log import get_logger
from edgevox.robots.capabilities import SpeedLimit, Twist2D
from edgevox.robots.motion import Motion

log = get_logger(__name__)

WATCHDOG_S = 0.5
"""A stream of velocities that is silent for this long has stopped."""
STILL = Twist2D(0.0, 0.0)
M = TypeVar("M", bound=Motion)


class CommandMux(Generic[M]):
    """Decides who moves the body; may be used from any thread.

    Args:
        lock: The body's own, reentrant; it also guards the motions.
        max_linear_m_s: The limit of streamed velocities, in m/s.
        max_angular_rad_s: The limit of streamed velocities, in rad/s.
        on_halt: Brakes the body. Each halt calls it, under the lock, with the motion that the halt
            ends (or None) and the reason.
    """

    def __init__(
        self,
        lock: AbstractContextManager[object],
        *,
        max_linear_m_s: float = 0.0,
        max_angular_rad_s: float = 0.0,
        on_halt: Callable[[M | None, BaseException], object] = lambda *_: None,
    ) -> None:
        self._lock = lock
        self._max_linear_m_s, self._max_angular_rad_s = max_linear_m_s, max_angular_rad_s
        self._on_halt = on_halt
        self._motion: M | None = None
        self._velocity: Twist2D | None = None
        self._velocity_until_s = 0.0
        self.limit: SpeedLimit = _as_asked
        """The speed limit for a motion's velocity; the sender of a stream limits its own."""
        self.watchdog_halts = 0
        """Streams that stopped though they had not asked for a stand."""

    @property
    def motion(self) -> M | None:
        """The motion that moves the body; None once it is over."""
        motion = self._motion
        return None if motion is None or motion.done else motion

    @property
    def velocity(self) -> Twist2D | None:
        """The streamed velocity, if any."""
        return self._velocity

    @property
    def busy(self) -> bool:
        """Whether a motion or a stream moves the body."""
        return self._velocity is not None or self.motion is not None

    def start(self, make: Callable[[], M]) -> M:
        """Let this motion move the body; what moved it so far ends as cancelled.

        Where `make` refuses, by raising, nothing has changed.
        """
        with self._lock:
            motion = make()
            self._end(Cancelled(called_off("new_goal")))
            self._motion, self._velocity = motion, None
            return motion

    def stream(self, twist: Twist2D, time_s: float) -> None:
        """Ask for this velocity, within the limits, for `WATCHDOG_S` of the body's time.

        Raises `InvalidValue` for one that is not finite; then nothing has changed.
        """
        linear_m_s = finite("linear_m_s", twist.linear_m_s)
        angular_rad_s = finite("angular_rad_s", twist.angular_rad_s)
        with self._lock:
            self._end(Cancelled(called_off("steered")))
            self._velocity = Twist2D(
                clamped(linear_m_s, self._max_linear_m_s),
                clamped(angular_rad_s, self._max_angular_rad_s),
            )
            self._velocity_until_s = time_s + WATCHDOG_S

    def halt(self, error: BaseException, only: M | None = None) -> bool:
        """Stop the body: a motion ends with `error`. Return whether anything moved it.

        With `only`, do nothing unless that motion moves the body.
        """
        with self._lock:
            motion = self.motion
            if only is not None and motion is not only:
                return False
            moved, self._velocity = self.busy, None
            try:
                self._on_halt(motion, error)
            finally:
                self._end(error)
            return moved

    def tick(self, time_s: float) -> None:
        """Take the body's time: a stream that fell silent ends.

        The body calls it in each of its steps, and holds the lock.
        """
        if self._velocity is None or time_s < self._velocity_until_s:
            return
        if self._velocity != STILL:
            self.watchdog_halts += 1
            log.warning("watchdog_halted", silent_s=WATCHDOG_S)
        self._velocity = None

    @contextmanager
    def cancelled_by(self, token: CancelToken, motion: M) -> Iterator[None]:
        """Let the token halt the body within the block, if this motion moves it."""

        def cancel() -> None:
            self.halt(Cancelled(token.why), only=motion)

        forget = token.on_cancel(cancel)
        try:
            yield
        finally:
            forget()

    def carry_out(self, motion: M, token: CancelToken, report: Callable[[], object]) -> None:
        """Block until a motion that was started is over; raises what it ended with.

        It is `cancelled_by` the token. `report` is called five times a second and in the end.
        """
        try:
            with self.cancelled_by(token, motion):
                motion.wait(report)
        finally:
            report()

    def _end(self, error: BaseException) -> None:
        motion, self._motion = self._motion, None
        if motion is not None:
            motion.end(error)


def _as_asked(twist: Twist2D) -> Twist2D:
    return twist


def clamped(value: float, most: float) -> float:
    """The value, or the nearest one from `-most` to `most`."""
    return min(max(value, -most), most)
