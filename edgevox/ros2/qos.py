"""The contract's qualities of service, as rclpy wants them."""

from rclpy.qos import DurabilityPolicy, HistoryPolicy, QoSProfile, ReliabilityPolicy

from edgevox.ros2.contract_rows import Qos, QosSpec

INTERFACE_DEPTH = 10
"""So many messages of an interface of the robot's own may wait."""


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


def interface_profile(*, latched: bool, heard: bool) -> QoSProfile:
    """For a topic that is no part of the contract, of a robot whose qualities nobody knows.

    Best effort hears everybody; what is latched is kept, and so reliable.
    """
    if latched:
        return profile(QosSpec(depth=1, reliable=True, transient_local=True))
    return profile(QosSpec(depth=INTERFACE_DEPTH, reliable=not heard, transient_local=False))
