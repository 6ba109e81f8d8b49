"""A publisher for messages that rarely change: a repeated message gets only a new stamp.

Filling in and serialising a message costs more than sending it. A repeated message is sent as it
was serialised the first time, with another stamp in its bytes.
"""

import struct
from collections.abc import Callable
from typing import Any

from builtin_interfaces.msg import Time
from rclpy.node import Node
from rclpy.serialization import serialize_message

from edgevox.ros2.qos import profile
from edgevox.ros2.stamps import NS_PER_S, to_msg
from edgevox.ros2.standard_topics import STANDARD

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
