"""Logs and ROS 2: its lines in our stream, ours on ``/rosout``, levels set by its services."""

from edgevox.ros2.logs.logger_levels import LoggerLevels, apply_log_levels
from edgevox.ros2.logs.rosout import RcutilsStream, Rosout

__all__ = ["LoggerLevels", "RcutilsStream", "Rosout", "apply_log_levels"]
