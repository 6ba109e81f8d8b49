"""The contract's qualities of service, as rclpy wants them."""

from rclpy.qos import DurabilityPolicy, HistoryPolicy, QoSProfile, ReliabilityPolicy

from edgevox.ros2.contract_rows import Qos, QosSpec

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
