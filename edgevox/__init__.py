"""EdgeVox: an offline voice agent for robots, visible and steerable over ROS 2."""

__version__ = "0.1.0"
