"""A body's interface to standard ROS 2 tools.

Frames, pose, odometry, scans and pictures go out; velocities and goals come in; each only if the
body has the capability. There is one module per concern, put together by `Interop`. Imports core,
agent.policy, ros2 and robots.capabilities of edgevox.
"""

from edgevox.ros2.interop.interop import Interop

__all__ = ["Interop"]
