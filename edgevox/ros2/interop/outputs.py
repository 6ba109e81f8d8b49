"""The body's outputs: motion (`/tf`, `pose`, `odom`), `scan`, `/clock` and the camera's pictures.

`/tf`, `pose` and `odom` of one tick carry the same pose and the same stamp. `/clock` carries the
body's time, for peers with `use_sim_time`.

Pictures go out on `image_raw`, the camera's model on `camera_info`. A picture may take long to
render, so a thread of its own takes it and publishes it. There is no queue: a picture that is late
is skipped, not sent later.
"""

import math
from array import array
from collections.abc import Callable
from functools import lru_cache

import numpy as np
from builtin_interfaces.msg import Time
from geometry_msgs.msg import PoseStamped, PoseWithCovariance, Twist, TwistWithCovariance, Vector3
from nav_msgs.msg import Odometry
from rclpy.node import Node
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import CameraInfo, Image, LaserScan

from edgevox.core.errors import InvalidValue
from edgevox.core.transforms import Pose3D, lift
from edgevox.robots.capabilities import (
    Body,
    CameraImage,
    CameraSpec,
    HasCamera,
    HasEndEffector,
    HasLidar,
    HasPose,
    TakesVelocity,
    Twist2D,
)
from edgevox.ros2.interop.frames import Broadcaster, Frames, Odometer
from edgevox.ros2.messages import header, pose_msg, profile
from edgevox.ros2.stamps import NS_PER_S, StampedPublisher, Stamps, to_msg
from edgevox.ros2.standard_topics import STANDARD
from edgevox.ros2.tf_buffer import FramePose, TfBuffer
from edgevox.ros2.ticker import Ticker


class Scanner:
    """Publishes a sweep per tick, every `period_s`, in the lidar's own frame."""

    def __init__(
        self, node: Node, body: HasLidar, frames: Frames, stamps: Stamps, period_s: float
    ) -> None:
        self._body, self._frames, self._stamps = body, frames, stamps
        self._period_s = period_s
        self._publisher = node.create_publisher(LaserScan, "scan", profile(STANDARD["scan"].qos))

    def links(self) -> list[FramePose]:
        """Return the pose of the lidar on the body."""
        return [FramePose(self._frames.base, self._frames.lidar, lift(self._body.scan().mount))]

    def tick(self) -> None:
        """Sweep, if anybody looks."""
        if not self._publisher.get_subscription_count():
            return
        scan = self._body.scan()
        stamp_ns = self._stamps.nanoseconds(scan.time_s)
        if stamp_ns is None:
            return
        ranges = array("f")
        ranges.frombytes(np.ascontiguousarray(scan.ranges_m, dtype=np.float32).tobytes())
        last = max(len(ranges) - 1, 0)
        self._publisher.publish(
            LaserScan(
                header=header(self._frames.lidar, to_msg(stamp_ns)),
                angle_min=scan.angle_min_rad,
                angle_max=scan.angle_min_rad + last * scan.angle_increment_rad,
                angle_increment=scan.angle_increment_rad,
                time_increment=0.0,  # all beams at one moment
                scan_time=self._period_s,
                range_min=scan.range_min_m,
                range_max=scan.range_max_m,
                ranges=ranges,
            )
        )


class ClockPublisher:
    """Publishes the body's time whenever it has changed."""

    def __init__(self, node: Node, body_time: Callable[[], float]) -> None:
        self._body_time = body_time
        self._last_ns: int | None = None
        self._publisher = node.create_publisher(Clock, "/clock", profile(STANDARD["/clock"].qos))

    def tick(self) -> None:
        """Look, and say it."""
        now_ns = round(self._body_time() * NS_PER_S)
        if now_ns != self._last_ns:
            self._last_ns = now_ns
            self._publisher.publish(Clock(clock=to_msg(now_ns)))


_FASTEST_M_S, _FASTEST_RAD_S = 2.0, 4.0
"""Limits of a body that does not say its own."""
_EXACT = np.diag(np.full(6, 1e-6)).ravel()
"""The covariance of a simulation's values; all zeros would mean that it is unknown."""


class MotionPublisher:
    """Publishes `/tf`, `pose`, and, for a body with a pose of its own, `odom`."""

    def __init__(
        self,
        node: Node,
        body: Body,
        frames: Frames,
        stamps: Stamps,
        tf_buffer: TfBuffer,
    ) -> None:
        self._body, self._frames, self._stamps = body, frames, stamps
        self._broadcaster, self._tf = Broadcaster(node), tf_buffer
        self._base = body if isinstance(body, HasPose) else None
        self._hand = body if isinstance(body, HasEndEffector) else None
        self._pose = StampedPublisher(node, PoseStamped, "pose")
        self._odom = StampedPublisher(node, Odometry, "odom") if self._base else None
        self._lift = lru_cache(maxsize=1)(lift)  # a robot at rest is asked all the time
        steered = body if isinstance(body, TakesVelocity) else None
        self._odometer = Odometer(
            steered.max_linear_m_s if steered else _FASTEST_M_S,
            steered.max_angular_rad_s if steered else _FASTEST_RAD_S,
        )
        self._last_ns: int | None = None

    def tick(self) -> None:
        """Look at the body once and publish its motion; do nothing if no time has passed since."""
        time_s, base, twist, hand = self._sample()
        stamp_ns = self._stamps.nanoseconds(time_s)
        if stamp_ns is None or stamp_ns == self._last_ns:
            return
        self._last_ns = stamp_ns
        placed: list[FramePose] = []
        if base is not None:
            in_odom = self._odometer.move(time_s, base)
            placed += self._chain(base, in_odom)
            self._say_odom(in_odom if self._frames.odom else base, twist, stamp_ns)
        if hand is not None:
            placed.append(FramePose(self._frames.map, self._frames.hand, hand))
        self._tf.put(stamp_ns, *placed)
        self._broadcaster.send(placed, stamp_ns)
        self._say_pose(base or hand, stamp_ns)

    def _sample(self) -> tuple[float, Pose3D | None, Twist2D | None, Pose3D | None]:
        """Sample everything at one moment of the body's time, as far as possible."""
        for _ in range(3):
            time_s = self._body.time_s
            base = self._lift(self._base.pose()) if self._base else None
            twist = self._base.velocity() if self._base else None
            hand = self._hand.end_effector() if self._hand else None
            if self._body.time_s == time_s:
                break
        return time_s, base, twist, hand

    def _chain(self, base: Pose3D, in_odom: Pose3D) -> list[FramePose]:
        names = self._frames
        if not names.odom:
            return [FramePose(names.map, names.base, base)]
        return [
            FramePose(names.map, names.odom, self._odometer.map_to_odom),
            FramePose(names.odom, names.base, in_odom),
        ]

    def _say_pose(self, pose: Pose3D | None, stamp_ns: int) -> None:
        if pose is not None:
            self._pose.say(pose, lambda stamp: self._pose_stamped(pose, stamp), stamp_ns)

    def _say_odom(self, pose: Pose3D, twist: Twist2D | None, stamp_ns: int) -> None:
        if self._odom and twist is not None:
            said = (pose, twist)
            self._odom.say(said, lambda stamp: self._odometry(pose, twist, stamp), stamp_ns)

    def _pose_stamped(self, pose: Pose3D, stamp: Time) -> PoseStamped:
        return PoseStamped(header=header(self._frames.map, stamp), pose=pose_msg(pose))

    def _odometry(self, pose: Pose3D, twist: Twist2D, stamp: Time) -> Odometry:
        moving = Twist(linear=Vector3(x=twist.linear_m_s), angular=Vector3(z=twist.angular_rad_s))
        return Odometry(
            header=header(self._frames.odom or self._frames.map, stamp),
            child_frame_id=self._frames.base,
            pose=PoseWithCovariance(pose=pose_msg(pose), covariance=_EXACT),
            twist=TwistWithCovariance(twist=moving, covariance=_EXACT),
        )


_OPTICAL = Pose3D(0.0, 0.0, 0.0, -0.5, 0.5, -0.5, 0.5)
"""The rotation from x forward, z up, to z forward, x right."""


class Camera:
    """Takes and publishes pictures while anybody looks, on a ticker of its own that it starts."""

    def __init__(
        self,
        node: Node,
        body: HasCamera,
        frames: Frames,
        stamps: Stamps,
        ticker: Ticker,
    ) -> None:
        self._body, self._frames, self._stamps = body, frames, stamps
        self._spec = body.camera_spec
        self._images = node.create_publisher(Image, "image_raw", profile(STANDARD["image_raw"].qos))
        self._infos = node.create_publisher(
            CameraInfo, "camera_info", profile(STANDARD["camera_info"].qos)
        )
        self._ticker = ticker
        ticker.every(1.0 / STANDARD["image_raw"].rate_hz, self._tick)

    @property
    def failures(self) -> int:
        """The number of pictures that could not be taken."""
        return self._ticker.failures

    def links(self) -> list[FramePose]:
        """Return the poses of the camera and of its optical frame."""
        names = self._frames
        parent = {"map": names.map, "body": names.base, "end_effector": names.hand}
        return [
            FramePose(parent[self._spec.parent], names.camera, self._spec.mount),
            FramePose(names.camera, names.camera_optical, _OPTICAL),
        ]

    def start(self) -> None:
        self._ticker.start()

    def close(self) -> None:
        """Take no more pictures and wait for the one that is being taken."""
        self._ticker.close()

    def _tick(self) -> None:
        if self._images.get_subscription_count() or self._infos.get_subscription_count():
            self._publish(self._body.camera())

    def _publish(self, picture: CameraImage) -> None:
        stamp_ns = self._stamps.nanoseconds(picture.time_s)
        if stamp_ns is None:
            return
        info = camera_info(self._spec)
        info.header = header(self._frames.camera_optical, to_msg(stamp_ns))
        image = image_msg(picture, self._spec)
        image.header = info.header
        self._infos.publish(info)
        self._images.publish(image)


def image_msg(picture: CameraImage, spec: CameraSpec) -> Image:
    """A picture as rgb8. Raises `InvalidValue` if it is not what the camera promised."""
    wanted = (spec.height_px, spec.width_px, 3)
    if picture.pixels.shape != wanted or picture.pixels.dtype != np.uint8:
        got = f"{picture.pixels.dtype} {picture.pixels.shape}"
        raise InvalidValue("pixels", got, f"uint8 {wanted}")
    data = array("B")  # the one type that rclpy takes without looking at every byte
    data.frombytes(np.ascontiguousarray(picture.pixels).data.cast("B"))
    return Image(
        height=spec.height_px,
        width=spec.width_px,
        encoding="rgb8",
        is_bigendian=0,
        step=3 * spec.width_px,
        data=data,
    )


def camera_info(spec: CameraSpec) -> CameraInfo:
    """The camera's model, pixels counted from the middle of the first one."""
    focal = spec.height_px / 2 / math.tan(spec.vertical_fov_rad / 2)
    cx, cy = (spec.width_px - 1) / 2, (spec.height_px - 1) / 2
    return CameraInfo(
        height=spec.height_px,
        width=spec.width_px,
        distortion_model="plumb_bob",
        d=[0.0] * 5,
        k=[focal, 0.0, cx, 0.0, focal, cy, 0.0, 0.0, 1.0],
        r=[1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0],
        p=[focal, 0.0, cx, 0.0, 0.0, focal, cy, 0.0, 0.0, 0.0, 1.0, 0.0],
    )
