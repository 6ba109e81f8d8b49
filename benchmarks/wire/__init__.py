"""ROS 2, discovery, DDS security, ways to stop, and the image."""
