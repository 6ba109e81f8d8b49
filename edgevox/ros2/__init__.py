"""EdgeVox on the wire: the contract as a table, the bridge that serves it, the null twin.

The only package that imports rclpy. Imports core, agent.skills and robots of edgevox.
"""

from edgevox.ros2.open import Bridge, NullBridge, open_bridge, split_ros_args
from edgevox.ros2.wiring import Wiring

__all__ = ["Bridge", "NullBridge", "Wiring", "open_bridge", "split_ros_args"]
