"""Goals come in on `goal_pose` and become skills at once, also while a model thinks."""

import math
from collections import Counter
from collections.abc import Callable, Mapping
from dataclasses import astuple
from typing import Any

from geometry_msgs.msg import PoseStamped

from edgevox.agent.policy import Denied
from edgevox.core.errors import EdgeVoxError, InvalidValue, Refusal
from edgevox.core.log import get_logger
from edgevox.core.transforms import OFF_UNIT, Pose3D, compose, unit
from edgevox.robots.capabilities import Body, HasEndEffector, HasPose
from edgevox.ros2.backlog import Backlog
from edgevox.ros2.interop.frames import Frames
from edgevox.ros2.messages import pose_of
from edgevox.ros2.qos import profile
from edgevox.ros2.stamps import to_ns
from edgevox.ros2.standard_topics import STANDARD
from edgevox.ros2.tf_buffer import TfBuffer

log = get_logger(__name__)

RunSkill = Callable[[str, Mapping[str, Any], int], None]
"""Starts a skill, by name, with arguments and the interlock's mark when it was asked for.

Does not wait. May raise `EdgeVoxError`.
"""

DRIVE, REACH = "navigate_xy", "move_to"
"""The skills that a goal becomes: on the floor for what drives, in space for what has a hand."""


def goal_skill(body: Body) -> str | None:
    """The skill that takes this body to a point, if it has one."""
    names = {skill.name for skill in body.skills}
    if isinstance(body, HasPose) and DRIVE in names:
        return DRIVE
    return REACH if isinstance(body, HasEndEffector) and REACH in names else None


class GoalInput:
    """Turns goals into points on the map and runs the skill.

    A goal may be given in `map` or in a frame of this robot, with or without its prefix; it then
    means the frame's place at the goal's stamp (0 is now). Its orientation is not used, and on the
    floor its height is not, either.

    `refusals` counts refused goals by reason: no frame, or another robot's; a time that is not
    remembered; numbers that are not finite; an invalid orientation; a goal that the skill refuses,
    such as one outside the world, or that the policy forbids. Each refusal is logged with its
    reason.
    """

    def __init__(
        self, backlog: Backlog, skill: str, frames: Frames, tf_buffer: TfBuffer, run_skill: RunSkill
    ) -> None:
        self._skill, self._frames, self._tf = skill, frames, tf_buffer
        self._run_skill = run_skill
        self.refusals: Counter[Refusal] = Counter(
            dict.fromkeys((Refusal.INVALID, Refusal.NOT_FINITE, Refusal.FORBIDDEN), 0)
        )
        self._open = True
        backlog.subscribe(PoseStamped, "goal_pose", self._take, profile(STANDARD["goal_pose"].qos))

    def close(self) -> None:
        """Take no more."""
        self._open = False

    def _take(self, message: PoseStamped, mark: int) -> None:
        if not self._open:
            return
        try:
            self._run_skill(self._skill, self._arguments(message), mark)
        except EdgeVoxError as error:
            why = _refusal(error)
            self.refusals[why] += 1
            log.warning("goal_pose_refused", reason=str(error), refused=self.refusals.total())

    def _arguments(self, message: PoseStamped) -> dict[str, float]:
        goal = self._on_map(message)
        point = {"x": goal.x_m, "y": goal.y_m}
        return {**point, "z": goal.z_m} if self._skill == REACH else point

    def _on_map(self, message: PoseStamped) -> Pose3D:
        pose = pose_of(message.pose)
        if not all(map(math.isfinite, astuple(pose))):
            raise InvalidValue("pose", astuple(pose), "finite numbers", Refusal.NOT_FINITE)
        turn = (pose.qx, pose.qy, pose.qz, pose.qw)
        if any(turn) and abs(math.hypot(*turn) - 1.0) > OFF_UNIT:  # all zero: none was given
            raise InvalidValue("orientation", turn, "a quaternion of length 1")
        frame = message.header.frame_id
        if not frame:
            raise InvalidValue("frame_id", frame, "the name of a frame, such as map")
        above = on_map(self._tf, self._frames, frame, to_ns(message.header.stamp))
        return compose(above, unit(pose))


def on_map(tf_buffer: TfBuffer, frames: Frames, frame: str, stamp_ns: int) -> Pose3D:
    """Return the pose of a frame, with or without prefix, at a stamp; 0 is now.

    Raises `InvalidValue` if that is not known.
    """
    for name in frames.names_of(frame):
        pose = tf_buffer.lookup(frames.map, name, stamp_ns)
        if pose is not None:
            return pose
    known = dict.fromkeys((frames.map, *tf_buffer.frames))
    raise InvalidValue("frame_id", frame, "one of " + ", ".join(known))


def _refusal(error: EdgeVoxError) -> Refusal:
    if isinstance(error, Denied):
        return Refusal.FORBIDDEN
    return error.reason if isinstance(error, InvalidValue) else Refusal.INVALID
