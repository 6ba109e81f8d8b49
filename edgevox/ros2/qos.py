"""The contract's qualities of service, as rclpy wants them."""

from rclpy.qos import DurabilityPolicy, HistoryPolicy, QoSProfile, ReliabilityPolicy

from edgevox.ros2.contract_rows import Qos, QosSpec


def profile(qos: Qos | QosSpec, *, at_least: int = 0) -> QoSProfile:
    """One of them, with room for `at_least` so many messages."""
    spec = qos.value if isinstance(qos, Qos) else qos
    return QoSProfile(
        history=HistoryPolicy.KEEP_LAST,
        depth=max(spec.depth, at_least),
        reliability=ReliabilityPolicy.RELIABLE if spec.reliable else ReliabilityPolicy.BEST_EFFORT,
        durability=(
            DurabilityPolicy.TRANSIENT_LOCAL if spec.transient_local else DurabilityPolicy.VOLATILE
        ),
    )
