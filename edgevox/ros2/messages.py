"""ROS 2 messages of poses, and the contract's qualities of service as rclpy wants them."""

from builtin_interfaces.msg import Time
from geometry_msgs.msg import Point, Pose, Quaternion, Transform, TransformStamped, Vector3
from rclpy.duration import Infinite
from rclpy.qos import (
    DurabilityPolicy,
    HistoryPolicy,
    QoSCompatibility,
    QoSProfile,
    ReliabilityPolicy,
    qos_check_compatible,
)
from std_msgs.msg import Header

from edgevox.core.transforms import Pose3D
from edgevox.ros2.contract_rows import Qos, QosSpec


def header(frame: str, stamp: Time) -> Header:
    """A header."""
    return Header(frame_id=frame, stamp=stamp)


def pose_msg(pose: Pose3D) -> Pose:
    """A pose."""
    return Pose(position=Point(x=pose.x_m, y=pose.y_m, z=pose.z_m), orientation=_turn(pose))


def transform_msg(parent: str, child: str, pose: Pose3D, stamp: Time) -> TransformStamped:
    """Build the transform from the parent to the child."""
    return TransformStamped(
        header=header(parent, stamp),
        child_frame_id=child,
        transform=Transform(
            translation=Vector3(x=pose.x_m, y=pose.y_m, z=pose.z_m), rotation=_turn(pose)
        ),
    )


def pose_of(message: Pose) -> Pose3D:
    """A message as a pose; its quaternion as it is."""
    p, q = message.position, message.orientation
    return Pose3D(p.x, p.y, p.z, q.x, q.y, q.z, q.w)


def pose_of_transform(message: Transform) -> Pose3D:
    """Return the child's pose in the parent; the quaternion is copied unchecked."""
    p, q = message.translation, message.rotation
    return Pose3D(p.x, p.y, p.z, q.x, q.y, q.z, q.w)


def _turn(pose: Pose3D) -> Quaternion:
    return Quaternion(x=pose.qx, y=pose.qy, z=pose.qz, w=pose.qw)


INTERFACE_DEPTH = 10
"""Messages of a robot's own interface that may wait."""


def profile(qos: Qos | QosSpec, *, at_least: int = 0) -> QoSProfile:
    """Convert a quality of service, with room for at least `at_least` messages."""
    spec = qos.value if isinstance(qos, Qos) else qos
    return QoSProfile(
        history=HistoryPolicy.KEEP_LAST,
        depth=max(spec.depth, at_least),
        reliability=ReliabilityPolicy.RELIABLE if spec.reliable else ReliabilityPolicy.BEST_EFFORT,
        durability=(
            DurabilityPolicy.TRANSIENT_LOCAL if spec.transient_local else DurabilityPolicy.VOLATILE
        ),
    )


def interface_profile(*, latched: bool, heard: bool) -> QoSProfile:
    """Return the profile for a robot's own topic, whose quality of service is unknown.

    Best effort matches every publisher; a latched topic is kept, and therefore reliable.
    """
    if latched:
        return profile(QosSpec(depth=1, reliable=True, transient_local=True))
    return profile(QosSpec(depth=INTERFACE_DEPTH, reliable=not heard, transient_local=False))


def unheard(publisher: QoSProfile, subscriber: QoSProfile) -> str:
    """Return the reason why a subscriber would not hear a publisher; empty if it would."""
    verdict, reason = qos_check_compatible(publisher, subscriber)
    if verdict != QoSCompatibility.ERROR:
        return ""
    said = str(reason).replace("ERROR: ", "").strip("; ")
    return said[:1].lower() + said[1:]


def as_on_the_graph(profile: QoSProfile) -> QoSProfile:
    """Set the durations that the middleware decides to infinite, as it reports them of others."""
    profile.deadline = profile.lifespan = profile.liveliness_lease_duration = Infinite
    return profile
