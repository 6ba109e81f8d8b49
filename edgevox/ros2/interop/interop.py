"""The interface of one body to ROS 2, put together from its parts.

Its inputs are velocities on `cmd_vel` and goals on `goal_pose`. Any velocity takes over, as with
twist_mux, even one that says zero: it ends a drive, whose goal ends as cancelled. A stop must never
be ignored. A sender of constant zeros, like a joystick without a dead man's switch, therefore holds
the robot: it should send only while a person steers. The body halts 0.5 s after the last message.
Goals become skills at once, also while a model thinks.
"""

import math
from collections import Counter
from collections.abc import Callable, Mapping
from dataclasses import astuple
from typing import Any

from geometry_msgs.msg import PoseStamped, Twist
from rclpy.node import Node

from edgevox.agent.policy import Denied, Guard
from edgevox.agent.skills import SkillFailed
from edgevox.core.errors import EdgeVoxError, InvalidValue, Refusal
from edgevox.core.log import get_logger
from edgevox.core.motion.interlock import Interlock, StreamStopped
from edgevox.core.transforms import OFF_UNIT, Pose3D, compose, unit
from edgevox.robots.capabilities import (
    Body,
    HasCamera,
    HasEndEffector,
    HasLidar,
    HasPose,
    TakesVelocity,
)
from edgevox.robots.limits import Steerable, Steering
from edgevox.ros2.backlog import Backlog
from edgevox.ros2.interop.frames import Frames, broadcast_fixed
from edgevox.ros2.interop.outputs import Camera, ClockPublisher, MotionPublisher, Scanner
from edgevox.ros2.messages import pose_of, profile
from edgevox.ros2.stamps import Stamps, to_ns
from edgevox.ros2.standard_topics import STANDARD
from edgevox.ros2.tf_buffer import FOR_GOOD, FramePose, TfBuffer
from edgevox.ros2.ticker import MakeTicker, Ticker

log = get_logger(__name__)


class VelocityInput:
    """Hands velocities to the body: `linear.x` and `angular.z`, the two it can follow.

    `refusals` counts refused messages by reason: a NaN or an infinity; any motion while the
    `interlock` is engaged, or after a stop has ended the stream and before the stream pauses; and
    motion that the policy forbids. Nothing of a refused message is used, and the body's watchdog
    runs on. Motion faster than the policy permits is slowed, both numbers by the same factor; the
    body clamps motion beyond its limits.
    """

    def __init__(
        self,
        backlog: Backlog,
        body: Steerable,
        interlock: Interlock | None = None,
        guard: Guard | None = None,
    ) -> None:
        self._steering = Steering(body, interlock or Interlock(), (guard or Guard()).velocity)
        self.refusals: Counter[Refusal] = Counter(
            dict.fromkeys((Refusal.INVALID, Refusal.NOT_FINITE, Refusal.FORBIDDEN), 0)
        )
        self._open = True
        backlog.subscribe(Twist, "cmd_vel", self._take, profile(STANDARD["cmd_vel"].qos))

    def close(self) -> None:
        """Take no more."""
        self._open = False

    def _take(self, message: Twist, mark: int) -> None:
        if not self._open:
            return
        one, two = message.linear, message.angular
        if not all(map(math.isfinite, (one.x, one.y, one.z, two.x, two.y, two.z))):
            wrong = InvalidValue("cmd_vel", _brief(message), "finite numbers")
            self._refuse(wrong, Refusal.NOT_FINITE)
            return
        try:
            self._steering.steer(one.x, two.z, mark)
        except StreamStopped:  # which was logged once, when the stop ended the stream
            self.refusals[Refusal.FORBIDDEN] += 1
        except SkillFailed as error:  # of the policy's `Denied`, too
            self._refuse(error, Refusal.FORBIDDEN)
        except InvalidValue as error:
            self._refuse(error, error.reason)

    def _refuse(self, error: EdgeVoxError, reason: Refusal) -> None:
        self.refusals[reason] += 1
        log.warning("velocity_refused", reason=str(error), refused=self.refusals.total())


def _brief(message: Twist) -> tuple[float, ...]:
    one, two = message.linear, message.angular
    return (one.x, one.y, one.z, two.x, two.y, two.z)


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
        if abs(math.hypot(*turn) - 1.0) > OFF_UNIT:
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


TF_HZ = STANDARD["/tf"].rate_hz
SCAN_HZ = STANDARD["scan"].rate_hz
CLOCK_HZ = STANDARD["/clock"].rate_hz
_TICKS_PER_SCAN = round(TF_HZ / SCAN_HZ)


class Interop:
    """Offers on a node exactly what a body's capabilities allow, until `close`.

    Args:
        node: The node to serve on.
        body: The robot.
        run_skill: Runs a skill; must not block.
        ticker: Sets the rates; not started yet.
        backlog: Holds incoming orders.
        odom_frame: See `Frames`.
        frame_prefix: See `Frames`.
        publish_clock: See `Stamps`.
        interlock: While engaged, no velocity but zero is taken.
        guard: The policy for each velocity.
        tickers: Makes the camera's own ticker.

    Raises `InvalidValue` for an invalid frame.
    """

    def __init__(
        self,
        node: Node,
        body: Body,
        run_skill: RunSkill,
        ticker: Ticker,
        backlog: Backlog,
        *,
        odom_frame: str = "",
        frame_prefix: str = "",
        publish_clock: bool = False,
        interlock: Interlock | None = None,
        guard: Guard | None = None,
        tickers: MakeTicker = Ticker,
    ) -> None:
        self._node, self._body = node, body
        self._frames = Frames(odom_frame, frame_prefix)
        self._stamps = Stamps(node.get_clock(), lambda: body.time_s, own_clock=publish_clock)
        self._tf = TfBuffer()
        self._ticks = 0
        self._clock = ClockPublisher(node, lambda: body.time_s) if publish_clock else None
        self._motion = self._offer_motion()
        self._scanner = self._offer_scans()
        self._camera = self._offer_pictures(tickers)
        self._velocity = (
            VelocityInput(backlog, body, interlock, guard)
            if isinstance(body, TakesVelocity)
            else None
        )
        self._goal = self._take_goals(run_skill, backlog)
        self._place_sensors()
        self._forget = self._tick_on(ticker)
        if self._camera:
            self._camera.start()

    def close(self) -> None:
        """End all input and output, before the node and the body are closed."""
        for forget in self._forget:
            forget()
        for part in (self._velocity, self._goal, self._camera):
            if part:
                part.close()

    @property
    def refusals(self) -> Mapping[tuple[str, ...], int]:
        """The number of refused messages, by topic and reason; only topics that this body has."""
        parts = {"cmd_vel": self._velocity, "goal_pose": self._goal}
        return {
            (topic, reason): count
            for topic, part in parts.items()
            if part
            for reason, count in part.refusals.items()
        }

    @property
    def failed_images(self) -> int:
        """The number of pictures that could not be taken."""
        return self._camera.failures if self._camera else 0

    def _tick(self) -> None:
        """Serve both rates in one job, so that a scan and its transform nearly share a stamp."""
        self._ticks += 1
        try:
            if self._motion:
                self._motion.tick()
            if self._scanner and self._ticks % _TICKS_PER_SCAN == 0:
                self._scanner.tick()
        except EdgeVoxError as error:  # such as a sensor that is silent
            log.warning("body_unobserved", body=self._body.name, reason=str(error))

    def _tick_on(self, ticker: Ticker) -> list[Callable[[], None]]:
        """Ways to end it again."""
        forget = []
        if self._motion or self._scanner:
            forget.append(ticker.every(1.0 / TF_HZ, self._tick))
        if self._clock:
            forget.append(ticker.every(1.0 / CLOCK_HZ, self._clock.tick))
        return forget

    def _offer_motion(self) -> MotionPublisher | None:
        if not isinstance(self._body, HasPose | HasEndEffector):
            return None
        return MotionPublisher(self._node, self._body, self._frames, self._stamps, self._tf)

    def _offer_scans(self) -> Scanner | None:
        if not isinstance(self._body, HasLidar):
            return None
        return Scanner(self._node, self._body, self._frames, self._stamps, 1.0 / SCAN_HZ)

    def _offer_pictures(self, tickers: MakeTicker) -> Camera | None:
        if not isinstance(self._body, HasCamera):
            return None
        ticker = tickers("edgevox-camera")
        return Camera(self._node, self._body, self._frames, self._stamps, ticker)

    def _take_goals(self, run_skill: RunSkill, backlog: Backlog) -> GoalInput | None:
        skill = goal_skill(self._body)
        return GoalInput(backlog, skill, self._frames, self._tf, run_skill) if skill else None

    def _place_sensors(self) -> None:
        placed: list[FramePose] = []
        for sensor in (self._scanner, self._camera):
            if sensor:
                placed += sensor.links()
        self._tf.put(FOR_GOOD, *placed)
        if placed:
            broadcast_fixed(self._node, placed)
