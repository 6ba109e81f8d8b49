"""Transforms as the bytes of a `tf2_msgs/TFMessage`, made for the frames once.

At 30 Hz rclpy takes most of what a standing robot costs to make such a message of Python objects
and to read it again, field by field; with the bytes at hand only stamps and poses are written into
them. The layout is CDR, little endian (OMG's XCDR1, which every RMW of ROS 2 reads).
"""

import struct
from collections.abc import Sequence

from edgevox.core.transforms import Pose3D
from edgevox.ros2.stamps import NS_PER_S
from edgevox.ros2.tf_buffer import FramePose

_HEAD = b"\x00\x01\x00\x00"
"""CDR, little endian. What follows is aligned from its own beginning."""
_STAMP = struct.Struct("<iI")
_POSE = struct.Struct("<7d")


class TfEncoder:
    """For frames whose names stay: it is made anew where others come."""

    def __init__(self, placed: Sequence[FramePose]) -> None:
        self.frames = tuple((one.parent, one.child) for one in placed)
        self._bytes = bytearray(_HEAD + struct.pack("<I", len(placed)))
        self._stamps: list[int] = []
        self._poses: list[int] = []
        for parent, child in self.frames:
            self._stamps.append(self._room(_STAMP.size, 4))
            self._text(parent)
            self._text(child)
            self._poses.append(self._room(_POSE.size, 8))

    def encode(self, stamp_ns: int, poses: Sequence[Pose3D]) -> bytes:
        """The message of these frames, with all their poses at one stamp."""
        for at in self._stamps:
            _STAMP.pack_into(self._bytes, at, stamp_ns // NS_PER_S, stamp_ns % NS_PER_S)
        for at, p in zip(self._poses, poses, strict=True):
            _POSE.pack_into(self._bytes, at, p.x_m, p.y_m, p.z_m, p.qx, p.qy, p.qz, p.qw)
        return bytes(self._bytes)

    def _room(self, size: int, alignment: int) -> int:
        """Where so many bytes begin, with zeros for now."""
        gap = -(len(self._bytes) - len(_HEAD)) % alignment
        at = len(self._bytes) + gap
        self._bytes += bytes(gap + size)
        return at

    def _text(self, text: str) -> None:
        data = text.encode() + b"\x00"
        at = self._room(4 + len(data), 4)
        self._bytes[at:] = struct.pack("<I", len(data)) + data
