"""The qualities of service of the interop topics, each as their usual peers expect it."""

from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy

TF = QoSProfile(depth=100, reliability=ReliabilityPolicy.RELIABLE)
"""As tf2_ros broadcasts."""
TF_STATIC = QoSProfile(
    depth=1, reliability=ReliabilityPolicy.RELIABLE, durability=DurabilityPolicy.TRANSIENT_LOCAL
)
"""As tf2_ros broadcasts what never moves."""
POSE = QoSProfile(depth=10, reliability=ReliabilityPolicy.RELIABLE)
"""`pose` and `odom`: small, and a reliable publisher suits best-effort subscribers, Nav2's, too."""
SENSOR = QoSProfile(depth=5, reliability=ReliabilityPolicy.BEST_EFFORT)
"""`scan`, `image_raw`, `camera_info`: an old one is worth nothing."""
VELOCITY = QoSProfile(depth=10, reliability=ReliabilityPolicy.BEST_EFFORT)
"""`cmd_vel`: hears every publisher, and a velocity sent again late would be a wrong one."""
GOAL = QoSProfile(depth=10, reliability=ReliabilityPolicy.RELIABLE)
"""`goal_pose`: never lost."""
CLOCK = QoSProfile(depth=1, reliability=ReliabilityPolicy.RELIABLE)
"""`/clock`: the newest; suits the best-effort subscription that every node with sim time has."""
