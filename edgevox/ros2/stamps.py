"""Stamps: the body's time, as other nodes can use it.

A body counts its own time from 0. Other nodes compare stamps with their clock, so the body's time
is laid on the node's:

- Normally by one offset, taken at the first stamp: stamps are the body's time, shifted. So they are
  consistent between `/tf`, `pose`, `odom`, `scan` and `image_raw`, never in the future, and evenly
  spaced even where the executor was late. The offset only follows where the body's time really
  left the clock: it dropped what it could not catch up, it was reset, the clock was set.
- With `use_sim_time`, by whoever publishes `/clock`: a stamp is that clock's now, less the age of
  what is stamped. Until the first `/clock` there is no time and nothing can be stamped: stamps of
  another epoch would spoil the peers' tf buffers for good.
- With `own_clock` (this node publishes `/clock`, see `interop.clock_publisher`), stamps are the
  body's time as it is.
"""

import threading
from collections.abc import Callable

from builtin_interfaces.msg import Time
from rclpy.clock import Clock

NS_PER_S = 1_000_000_000
WINDOW_NS = NS_PER_S
"""The body's lag behind the offset must last this long before the offset moves."""
LAG_NS = 50_000_000
"""A lag up to this, a step or two of the body, is none."""


class TimeOffset:
    """The nanoseconds from the body's time to a clock's. Call `align` before `lay`.

    As long as neither time jumps, `lay` never decreases for a growing time, and never gives a time
    in the clock's future.
    """

    def __init__(self) -> None:
        self._offset_ns: int | None = None
        self._body_ns = 0
        self._window_from_ns = 0
        self._least_lag_ns = 0

    def align(self, body_ns: int, now_ns: int) -> None:
        """Take both times at one moment."""
        lag_ns = 0 if self._offset_ns is None else now_ns - body_ns - self._offset_ns
        if self._offset_ns is None or body_ns < self._body_ns or lag_ns > WINDOW_NS:
            self._move_to(now_ns - body_ns, now_ns)
        elif lag_ns < 0:
            self._move_to(self._offset_ns + lag_ns, now_ns)
        else:
            self._least_lag_ns = min(self._least_lag_ns, lag_ns)
            if now_ns - self._window_from_ns >= WINDOW_NS:
                lost_ns = self._least_lag_ns if self._least_lag_ns > LAG_NS else 0
                self._move_to(self._offset_ns + lost_ns, now_ns)
        self._body_ns = body_ns

    def lay(self, body_ns: int) -> int:
        """The body's time on the clock."""
        return body_ns + (self._offset_ns or 0)

    def _move_to(self, offset_ns: int, now_ns: int) -> None:
        self._offset_ns = offset_ns
        self._window_from_ns = now_ns
        self._least_lag_ns = WINDOW_NS


class Stamps:
    """Turns the body's time into stamps. May be used from any thread."""

    def __init__(
        self, clock: Clock, body_time: Callable[[], float], *, own_clock: bool = False
    ) -> None:
        self._clock = clock
        self._body_time = body_time
        self._own_clock = own_clock
        self._offset = TimeOffset()
        self._lock = threading.Lock()

    def nanoseconds(self, time_s: float) -> int | None:
        """The stamp of something at the body's time `time_s`; None while there is no time."""
        time_ns = round(time_s * NS_PER_S)
        if self._own_clock:
            return time_ns
        with self._lock:
            body_ns = round(self._body_time() * NS_PER_S)
            now_ns = int(self._clock.now().nanoseconds)
            if getattr(self._clock, "ros_time_is_active", False):
                return max(now_ns - max(body_ns - time_ns, 0), 0) or None
            self._offset.align(body_ns, now_ns)
            return self._offset.lay(time_ns)


def to_msg(nanoseconds: int) -> Time:
    """A stamp as ROS writes it."""
    return Time(sec=nanoseconds // NS_PER_S, nanosec=nanoseconds % NS_PER_S)


def to_ns(stamp: Time) -> int:
    """A stamp in nanoseconds."""
    return int(stamp.sec) * NS_PER_S + int(stamp.nanosec)
