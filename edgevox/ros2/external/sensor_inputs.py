"""What is heard from the robot: odometry, scans, transforms and its map, the newest of each."""

import math
from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from nav_msgs.msg import Odometry
from rclpy.node import Node
from sensor_msgs.msg import LaserScan

from edgevox.agent.reasons import because
from edgevox.agent.skills import SkillFailed
from edgevox.core.clock import Clock
from edgevox.core.frame_names import BASE, ODOM
from edgevox.core.log import get_logger
from edgevox.core.refusals import Refusal
from edgevox.core.transforms import ORIGIN, Pose2D, compose, lift, project, rigid
from edgevox.robots.capabilities import LidarScan, Twist2D
from edgevox.robots.occupancy_map import OccupancyMap
from edgevox.ros2.contract_rows import latched, lossy
from edgevox.ros2.external.camera_input import CameraInput
from edgevox.ros2.external.map_input import MapInput
from edgevox.ros2.external.motion_bounds import Speeds, on_the_map, sweeps
from edgevox.ros2.external.odometry_history import SILENT_S, OdometryHistory, OdometrySample
from edgevox.ros2.external.target import PoseEstimate
from edgevox.ros2.messages import pose_of, pose_of_transform
from edgevox.ros2.qos import profile
from edgevox.ros2.stamps import NS_PER_S, to_ns
from edgevox.ros2.standard_topics import DRIVEN
from edgevox.ros2.tf_buffer import FramePose, TfBuffer, plain
from tf2_msgs.msg import TFMessage

log = get_logger(__name__)

_ANY_TF = 100


class SensorInputs:
    """Subscribes on a node in the robot's namespace. Callbacks only store; all is thread-safe.

    Everything is heard best effort and volatile, which publishers of any quality can serve; only
    /tf_static and the map are asked for what was said before.
    """

    def __init__(self, node: Node, clock: Clock, speeds: Speeds) -> None:
        self._clock = clock
        self.odometry_history = OdometryHistory(clock, speeds)
        self._tf = TfBuffer(kept=1)  # what is asked is where things are now
        self._prefix = node.get_namespace().strip("/")
        self._scan: tuple[float, LaserScan] | None = None
        self._scan_refused_s = -math.inf
        self._refused_scans = self._refused_transforms = 0
        self._said: set[tuple[str, ...]] = set()
        quality = {topic: profile(row.qos) for topic, row in DRIVEN.items()}
        node.create_subscription(Odometry, "odom", self._hear_odometry, quality["odom"])
        node.create_subscription(LaserScan, "scan", self._hear_scan, quality["scan"])
        self.camera = CameraInput(node, clock)
        self._map = MapInput(node)
        for name in {node.resolve_topic_name(one) for one in ("/tf", "tf")}:
            node.create_subscription(
                TFMessage, name, self._hear_transforms, profile(lossy(_ANY_TF))
            )
            node.create_subscription(
                TFMessage, f"{name}_static", self._hear_transforms, profile(latched(_ANY_TF))
            )
        self.odom_topic = node.resolve_topic_name("odom")
        self.scan_topic = node.resolve_topic_name("scan")
        self.tf_topic = node.resolve_topic_name("/tf")

    @property
    def refusals(self) -> Mapping[tuple[str, ...], int]:
        """How many messages could not be true, by topic and reason."""
        return {
            (self.odom_topic, Refusal.IMPLAUSIBLE): self.odometry_history.refused,
            (self.scan_topic, Refusal.IMPLAUSIBLE): self._refused_scans,
            (self.tf_topic, Refusal.IMPLAUSIBLE): self._refused_transforms,
            (self._map.topic, Refusal.IMPLAUSIBLE): self._map.refused,
        }

    def estimate(self) -> PoseEstimate | None:
        """Where the robot is now; None while its odometry is silent.

        In the map, where transforms join the odometry's frame to one; otherwise the odometry's
        frame is taken for the map.
        """
        seen = self.odometry_history.fresh()
        if seen is None:
            return None
        odom = self._named(seen.frame)
        frame = self._tf.map_above(odom)
        to_map = self._tf.lookup(frame, odom) if frame else None
        if frame is None or to_map is None:
            return PoseEstimate(seen.pose, seen.twist, seen.frame, seen.stamp_ns)
        pose = project(compose(to_map, lift(seen.pose)))
        return PoseEstimate(pose, seen.twist, frame, seen.stamp_ns)

    @property
    def distrusted(self) -> str:
        """The topic whose news of where the robot is cannot be true; empty if there is none."""
        if self.odometry_history.absurd:
            return self.odom_topic
        estimate = self.estimate()
        return self.tf_topic if estimate and not on_the_map(estimate.pose) else ""

    def say_frame_once(self, estimate: PoseEstimate) -> None:
        """Log, the first time only, that there is no map."""
        seen = self.odometry_history.newest()
        mapless = seen and self._tf.map_above(self._named(seen.frame)) is None
        if mapless and self._is_news("frame", estimate.frame):
            log.warning("frame_taken_for_map", frame=estimate.frame)

    def scan(self) -> LidarScan | None:
        """The newest scan, None if there is none of the last second."""
        heard = self._scan
        if heard is None or self._clock.now() - heard[0] > SILENT_S:
            return None
        message = heard[1]
        return LidarScan(
            time_s=to_ns(message.header.stamp) / NS_PER_S,
            angle_min_rad=message.angle_min,
            angle_increment_rad=message.angle_increment,
            range_min_m=message.range_min,
            range_max_m=message.range_max,
            ranges_m=np.asarray(message.ranges, dtype=np.float32),
            mount=self._mount(message.header.frame_id),
        )

    def newest_map(self) -> OccupancyMap | None:
        """The robot's map, in the frame of `estimate`; None before there is one. May take long.

        None, too, where no transform joins the two: a tap on it would send the robot elsewhere.
        """
        newest = self._map.newest()
        estimate = self.estimate()
        if newest is None or estimate is None:
            return newest[0] if newest else None
        shown, named = newest
        frame = plain(estimate.frame)
        there = frame if frame == f"{self._prefix}/{plain(named)}" else self._named(named)
        joined = self._tf.lookup(frame, there)
        if joined is None:
            if self._is_news("map", named, frame):
                log.warning("map_elsewhere", frame=named, robot_frame=frame)
            return None
        return replace(shown, origin=project(compose(joined, lift(shown.origin))))

    def trusted_scan(self) -> LidarScan | None:
        """As `scan`. Raises `SkillFailed` while what the lidar says cannot be true."""
        if self._clock.now() - self._scan_refused_s <= SILENT_S:
            raise incredible(self.scan_topic)
        return self.scan()

    def _mount(self, frame: str) -> Pose2D:
        """Where the lidar sits on the body; at its middle, looking ahead, if no transform says."""
        seen = self.odometry_history.newest()
        if seen is None:
            return ORIGIN
        transform = self._tf.lookup(self._named(seen.child_frame), self._named(frame))
        if transform is None:
            return ORIGIN
        return project(transform)

    def _named(self, frame: str) -> str:
        """The frame's name on /tf, where several robots put their namespaces before theirs."""
        prefixed = f"{self._prefix}/{plain(frame)}"
        return prefixed if self._tf.knows(prefixed) else plain(frame)

    def _hear_odometry(self, message: Odometry) -> None:
        at, speed = message.pose.pose, message.twist.twist
        sample = OdometrySample(
            pose=project(rigid(pose_of(at))),
            twist=Twist2D(
                math.copysign(math.hypot(speed.linear.x, speed.linear.y), speed.linear.x),
                speed.angular.z,
            ),
            frame=message.header.frame_id or ODOM,
            child_frame=message.child_frame_id or BASE,
            stamp_ns=to_ns(message.header.stamp),
            heard_s=self._clock.now(),
        )
        if not self.odometry_history.add(sample) and self._is_news("odometry"):
            log.warning("odometry_impossible", topic=self.odom_topic)

    def _hear_scan(self, message: LaserScan) -> None:
        now_s = self._clock.now()
        angles = message.angle_min, message.angle_increment
        if sweeps(len(message.ranges), *angles, message.range_min, message.range_max):
            self._scan, self._scan_refused_s = (now_s, message), -math.inf
            return
        self._scan, self._scan_refused_s = None, now_s
        self._refused_scans += 1
        if self._is_news("scan"):
            log.warning("scan_impossible", topic=self.scan_topic)

    def _hear_transforms(self, message: TFMessage) -> None:
        for one in message.transforms:
            transform = rigid(pose_of_transform(one.transform))
            placed = FramePose(one.header.frame_id, one.child_frame_id, transform)
            fits = self._tf.put(to_ns(one.header.stamp), placed)
            self._refused_transforms += not fits
            if not fits and self._is_news("transform", one.child_frame_id):
                log.warning("transform_impossible", frame=one.child_frame_id)

    def _is_news(self, *told: str) -> bool:
        news = told not in self._said and len(self._said) < _ANY_TF
        self._said |= {told} if news else set()
        return news


def incredible(topic: str) -> SkillFailed:
    """Why nothing is done by what is heard on a topic."""
    return SkillFailed(because("incredible", topic=topic))
