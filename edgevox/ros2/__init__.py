"""EdgeVox on the wire: the contract as a table, and the bridge that serves it.

The only package that imports rclpy. Imports core, robots, voice, ops and scenario, and of the agent
skills, reasons and policy.
"""

from edgevox.ros2.open import (
    Bridge,
    BridgeContext,
    NullBridge,
    open_bridge,
    open_node_handle,
    split_ros_args,
)

__all__ = [
    "Bridge",
    "BridgeContext",
    "NullBridge",
    "open_bridge",
    "open_node_handle",
    "split_ros_args",
]
