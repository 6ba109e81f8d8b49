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
- With `own_clock` (this node publishes `/clock`, see `interop.outputs`), stamps are the
  body's time as it is.

`StampedPublisher` is for messages that rarely change: filling in and serialising a message costs
more than sending it, so a repeated message is sent as it was serialised the first time, with
another stamp in its bytes.
"""

import struct
import threading
from collections.abc import Callable
from typing import Any

from builtin_interfaces.msg import Time
from rclpy.clock import Clock
from rclpy.node import Node
from rclpy.serialization import serialize_message

from edgevox.ros2.messages import profile
from edgevox.ros2.standard_topics import STANDARD

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


Make = Callable[[Time], Any]
"""Makes a message that has this stamp wherever it has one."""
_STAMP = struct.Struct("=iI")
_HEADER_BYTES, _ALIGNED_BYTES = 4, 4
"""The bytes before a serialised message, and the alignment at which its stamp begins."""
_MARKS = (Time(sec=0x01020304, nanosec=0x05060708), Time(sec=0x11121314, nanosec=0x15161718))


class SerializedMessage:
    """A message in bytes, whose stamps can be set."""

    def __init__(self, make: Make) -> None:
        one, other = (bytes(serialize_message(make(mark))) for mark in _MARKS)
        mark, other_mark = (_STAMP.pack(mark.sec, mark.nanosec) for mark in _MARKS)
        self._places = [
            at
            for at in range(_HEADER_BYTES, len(one) - _STAMP.size + 1, _ALIGNED_BYTES)
            if one.startswith(mark, at) and other.startswith(other_mark, at)
        ]
        self._bytes = bytearray(one)

    def at(self, stamp_ns: int) -> bytes:
        """The message as of this stamp."""
        second, nanosecond = divmod(stamp_ns, NS_PER_S)
        for place in self._places:
            _STAMP.pack_into(self._bytes, place, second, nanosecond)
        return bytes(self._bytes)


class StampedPublisher:
    """Publishes on a standard topic, if anybody listens."""

    def __init__(self, node: Node, kind: Any, topic: str) -> None:
        self._publisher = node.create_publisher(kind, topic, profile(STANDARD[topic].qos))
        self._said: object = None
        self._serialized: SerializedMessage | None = None

    def say(self, what: object, make: Make, stamp_ns: int) -> None:
        """Say `what` by the message that `make` makes of it, which differs only if `what` does."""
        if not self._publisher.get_subscription_count():
            return
        if what != self._said:
            self._said, self._serialized = what, None
            self._publisher.publish(make(to_msg(stamp_ns)))
            return
        if self._serialized is None:
            self._serialized = SerializedMessage(make)
        self._publisher.publish(self._serialized.at(stamp_ns))
