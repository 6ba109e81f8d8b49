"""The robot's inputs: odometry, scans, transforms, camera and map, the newest of each.

An occupancy grid is checked as it comes, and decoded only when it is shown; a point cloud only when
EdgeVox steers.
"""

import math
import threading
from collections import deque
from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import partial

import numpy as np
from nav_msgs.msg import OccupancyGrid, Odometry
from numpy.typing import NDArray
from rclpy.event_handler import SubscriptionEventCallbacks
from rclpy.node import Node
from rclpy.serialization import deserialize_message
from sensor_msgs.msg import LaserScan, PointCloud2

from edgevox.agent.skills import SkillFailed
from edgevox.agent.text.reasons import because
from edgevox.core.clock import Clock
from edgevox.core.errors import InvalidValue, Refusal
from edgevox.core.log import get_logger, worth_a_line
from edgevox.core.transforms import BASE, MAP, ODOM, ORIGIN, Pose2D, compose, lift, project, rigid
from edgevox.robots.capabilities import FREE, OCCUPIED, UNKNOWN, LidarScan, OccupancyMap, Twist2D
from edgevox.ros2.contract_rows import latched, lossy, reliable
from edgevox.ros2.external.motion import PoseEstimate
from edgevox.ros2.external.odometry import SILENT_S, OdometryHistory, OdometrySample
from edgevox.ros2.external.sensors import CameraInput, scan_of
from edgevox.ros2.external.settings import FURTHEST_M, Speeds, on_the_map, sweeps
from edgevox.ros2.external.topic_types import Close, TopicTypes, listening
from edgevox.ros2.messages import pose_of, pose_of_transform, profile
from edgevox.ros2.stamps import NS_PER_S, to_ns
from edgevox.ros2.standard_topics import DRIVEN
from edgevox.ros2.tf_buffer import FramePose, TfBuffer, plain
from tf2_msgs.msg import TFMessage

log = get_logger(__name__)


MAP_TOPIC = "map"
MOST_CELLS = 1 << 24
"""The largest grid that is accepted: 200 m by 200 m at 5 cm."""
MOST_SHOWN = 512
"""Cells along each side that are kept of a grid."""
FREE_PERCENT, OCCUPIED_PERCENT = 25, 65
"""Up to the one a cell is free, from the other on it is occupied, as for Nav2's map server."""
FINEST_M = 0.001
_MOST_BYTES = MOST_CELLS + 4096
_TILTED = 0.1
_KINDS: NDArray[np.uint8] = np.full(256, UNKNOWN, np.uint8)
_KINDS[: FREE_PERCENT + 1] = FREE
_KINDS[OCCUPIED_PERCENT:101] = OCCUPIED


class MapInput:
    """The robot's map, from its topic; thread-safe.

    An invalid map is refused on arrival, and the last one stays. The cells of a valid one are
    decoded only when they are read, since the thread that receives maps also steers the robot.

    It subscribes twice: with transient local, to get the kept map of a publisher that offers it,
    and volatile, for a publisher that does not.
    """

    def __init__(self, node: Node, types: TopicTypes) -> None:
        self.topic = node.resolve_topic_name(MAP_TOPIC)
        self.refused = 0
        """Messages that were no valid map."""
        self._unread: deque[OccupancyGrid] = deque(maxlen=1)
        self._newest: tuple[OccupancyMap, str] | None = None
        self._lock = threading.Lock()
        self._heard_ns: deque[int] = deque(maxlen=8)
        ways = {DRIVEN[MAP_TOPIC].type: partial(self._open, node)}
        types.follow(MAP_TOPIC, ways, least=reliable(1))

    def newest(self) -> tuple[OccupancyMap, str] | None:
        """The map and the frame that it is in; None before the first. May take long."""
        with self._lock:
            if self._unread:
                message = self._unread.pop()
                self._newest = map_of(message), message.header.frame_id or MAP
            return self._newest

    def _open(self, node: Node) -> Close:
        hear: Callable[..., None] = self._hear  # rclpy's own type knows of no second argument
        opened = [
            node.create_subscription(
                OccupancyGrid,
                MAP_TOPIC,
                hear,
                profile(quality),
                event_callbacks=SubscriptionEventCallbacks(use_default_callbacks=False),
                raw=True,
            )
            for quality in (DRIVEN[MAP_TOPIC].qos, reliable(1))
        ]
        return lambda: [node.destroy_subscription(one) for one in opened]

    def _hear(self, data: bytes, info: Mapping[str, int]) -> None:
        sent_ns = info["source_timestamp"]
        if sent_ns in self._heard_ns:  # the other way
            return
        self._heard_ns.append(sent_ns)
        try:
            if len(data) > _MOST_BYTES:
                raise _wrong("data", "more", f"at most {MOST_CELLS} cells")
            message = deserialize_message(data, OccupancyGrid)
            origin_of(message)
        except (InvalidValue, RuntimeError) as error:  # the latter of bytes that are no message
            self.refused += 1
            if worth_a_line(self.refused):
                log.warning("map_impossible", topic=self.topic, reason=str(error))
        else:
            self._unread.append(message)


def map_of(message: OccupancyGrid) -> OccupancyMap:
    """Decode the map, coarse enough to be shown. Raises `InvalidValue` naming the field."""
    origin, info = origin_of(message), message.info
    cells = _KINDS[np.frombuffer(message.data, np.uint8).reshape(info.height, info.width)]
    return OccupancyMap(cells, info.resolution, origin).cropped().reduced(MOST_SHOWN)


def origin_of(message: OccupancyGrid) -> Pose2D:
    """Return the pose of the lower left corner. Raises `InvalidValue` naming the wrong field."""
    info = message.info
    rows, columns, resolution_m = info.height, info.width, info.resolution
    if not 0 < rows * columns <= MOST_CELLS:
        raise _wrong("info", f"{columns} by {rows} cells", f"1 to {MOST_CELLS} cells")
    if len(message.data) != rows * columns:
        raise _wrong("data", f"{len(message.data)} cells", f"{rows * columns}")
    most_m = 2 * FURTHEST_M / max(rows, columns)
    if not FINEST_M <= resolution_m <= most_m:  # which no NaN is
        raise _wrong("info.resolution", resolution_m, f"{FINEST_M:g} to {most_m:g} m")
    pose = rigid(pose_of(info.origin))
    origin = project(pose)
    if not on_the_map(origin) or math.hypot(pose.qx, pose.qy) > _TILTED:
        raise _wrong("info.origin", pose, "one that lies flat, within the map's bounds")
    return origin


def _wrong(field: str, value: object, expected: str) -> InvalidValue:
    return InvalidValue(f"{MAP_TOPIC}: {field}", value, expected)


_ANY_TF = 100


class SensorInputs:
    """The robot's sensors, subscribed in its namespace. Callbacks only store; thread-safe.

    All subscriptions are best effort and volatile, which match a publisher of any quality; only
    /tf_static and the map ask for earlier messages.
    """

    def __init__(
        self, node: Node, clock: Clock, speeds: Speeds, types: TopicTypes, *, half_width_m: float
    ) -> None:
        self._clock = clock
        self._half_width_m = half_width_m
        self.odometry_history = OdometryHistory(clock, speeds)
        self._tf = TfBuffer(kept=1)  # what is asked is where things are now
        self._prefix = node.get_namespace().strip("/")
        self._scan: tuple[float, LaserScan] | None = None
        self._cloud: tuple[float, bytes] | None = None
        self._swept: tuple[bytes, LidarScan | None] = (b"", None)
        self._scan_refused_s = -math.inf
        self._refused_scans = self._refused_transforms = 0
        self._said: set[tuple[str, ...]] = set()
        types.follow("odom", listening(node, "odom", {Odometry: self._hear_odometry}))
        scans = listening(node, "scan", {LaserScan: self._hear_scan})
        clouds = listening(node, "scan", {PointCloud2: self._hear_cloud}, raw=True)
        types.follow("scan", {**scans, **clouds})
        self.camera = CameraInput(node, clock, types)
        self._map = MapInput(node, types)
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
        """The number of implausible messages, by topic and reason."""
        return {
            (self.odom_topic, Refusal.IMPLAUSIBLE): self.odometry_history.refused,
            (self.scan_topic, Refusal.IMPLAUSIBLE): self._refused_scans,
            (self.tf_topic, Refusal.IMPLAUSIBLE): self._refused_transforms,
            (self._map.topic, Refusal.IMPLAUSIBLE): self._map.refused,
        }

    def estimate(self) -> PoseEstimate | None:
        """Return the robot's current pose and motion; None while its odometry is silent.

        In the map frame, if transforms join the odometry's frame to one; otherwise the odometry's
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
        """The topic whose data on the robot's pose is implausible; empty if there is none."""
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

    @property
    def scans(self) -> bool:
        """Whether a scan or a point cloud came within the last second."""
        now_s = self._clock.now()
        heard = (one[0] for one in (self._scan, self._cloud) if one)
        return any(now_s - heard_s <= SILENT_S for heard_s in heard)

    def scan(self) -> LidarScan | None:
        """The newest scan, None if there is none of the last second."""
        if not self.scans:
            return None
        if self._cloud:
            return self._sweep(self._cloud[1])
        heard = self._scan
        if heard is None:
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

    def _sweep(self, data: bytes) -> LidarScan | None:
        """The point cloud as a scan; None, and refused, where it cannot be one."""
        if self._swept[0] is not data:
            self._swept = data, self._scan_of(data)
        return self._swept[1]

    def _scan_of(self, data: bytes) -> LidarScan | None:
        message = deserialize_message(data, PointCloud2)
        seen, frame = self.odometry_history.newest(), message.header.frame_id
        base = self._named(seen.child_frame) if seen else BASE
        mount = self._tf.lookup(base, self._named(frame))
        if mount is None:
            self._refuse_scan(f"no transform from {base} to {frame}")
            return None
        try:
            scan = scan_of(message, mount, self._half_width_m)
        except InvalidValue as error:
            self._refuse_scan(str(error))
            return None
        self._scan_refused_s = -math.inf
        return scan

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
        """Return `scan`. Raises `SkillFailed` while the lidar's data is implausible."""
        scan = self.scan()
        if self._clock.now() - self._scan_refused_s <= SILENT_S:
            raise incredible(self.scan_topic)
        return scan

    def _mount(self, frame: str) -> Pose2D:
        """Return the lidar's mount on the body; without a transform, the middle, looking ahead."""
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
            height_m=at.position.z,
        )
        if not self.odometry_history.add(sample) and self._is_news("odometry"):
            log.warning("odometry_impossible", topic=self.odom_topic)

    def _hear_scan(self, message: LaserScan) -> None:
        now_s, self._cloud = self._clock.now(), None
        angles = message.angle_min, message.angle_increment
        if sweeps(len(message.ranges), *angles, message.range_min, message.range_max):
            self._scan, self._scan_refused_s = (now_s, message), -math.inf
            return
        self._scan = None
        self._refuse_scan("angles or ranges that no lidar has")

    def _hear_cloud(self, data: bytes) -> None:
        self._cloud, self._scan = (self._clock.now(), data), None

    def _refuse_scan(self, reason: str) -> None:
        self._scan_refused_s = self._clock.now()
        self._refused_scans += 1
        if self._is_news("scan"):
            log.warning("scan_impossible", topic=self.scan_topic, reason=reason)

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
    """Return the error for acting on an implausible topic."""
    return SkillFailed(because("incredible", topic=topic))
