"""The standard topics of the contract: of a body, of a robot that is driven, and of sound.

Each row gives a topic's rate and quality of service, once for its publisher, its subscribers and
its recorder.
"""

from collections.abc import Mapping

from edgevox.ros2.contract_rows import StandardTopic, latched, lossy, reliable

INTEROP: tuple[StandardTopic, ...] = (
    StandardTopic(
        "/tf",
        "tf2_msgs/msg/TFMessage",
        "out",
        reliable(100),  # as tf2_ros broadcasts
        "map -> base_link or ee_link",
        "a pose",
        30.0,
    ),
    StandardTopic(
        "/tf_static",
        "tf2_msgs/msg/TFMessage",
        "out",
        latched(1),
        "positions of its sensors",
        "a lidar or a camera",
    ),
    StandardTopic(
        "pose",
        "geometry_msgs/msg/PoseStamped",
        "out",
        reliable(10),
        "the same pose as TF",
        "a pose",
        30.0,
    ),
    StandardTopic(
        "odom",
        "nav_msgs/msg/Odometry",
        "out",
        reliable(10),
        "pose and velocity",
        "a pose and a velocity",
        30.0,
    ),
    StandardTopic(
        "scan",
        "sensor_msgs/msg/LaserScan",
        "out",
        lossy(5),
        "one sweep of the lidar",
        "a lidar",
        10.0,
    ),
    StandardTopic("image_raw", "sensor_msgs/msg/Image", "out", lossy(5), "rgb8", "a camera", 5.0),
    StandardTopic(
        "camera_info",
        "sensor_msgs/msg/CameraInfo",
        "out",
        lossy(5),
        "the camera's model",
        "a camera",
        5.0,
    ),
    StandardTopic(
        "picture",
        "sensor_msgs/msg/CompressedImage",
        "out",
        latched(1),
        "the last picture that was asked for, PNG",
        "a camera",
    ),
    StandardTopic(
        "cmd_vel",
        "geometry_msgs/msg/Twist",
        "in",
        lossy(10),  # a velocity sent again late would be a wrong one
        "velocities; the robot halts 0.5 s after the last one",
        "wheels",
    ),
    StandardTopic(
        "goal_pose",
        "geometry_msgs/msg/PoseStamped",
        "in",
        reliable(10),
        "the goal to drive to",
        "a drive",
    ),
    StandardTopic(
        "/clock",
        "rosgraph_msgs/msg/Clock",
        "out",
        reliable(1),  # suits the best-effort subscription that every node with sim time has
        "the robot's time, also used for all stamps",
        "`publish_clock`",
        100.0,
    ),
)
STANDARD: Mapping[str, StandardTopic] = {row.topic: row for row in INTEROP}
"""The same by topic, for whoever serves them: what goes out, how often and how surely."""

EXTERNAL: tuple[StandardTopic, ...] = (
    StandardTopic(
        "odom",
        "nav_msgs/msg/Odometry",
        "in",
        lossy(5),
        "position and velocity; EdgeVox reports when they stop",
        "always",
    ),
    StandardTopic(
        "scan",
        "sensor_msgs/msg/LaserScan",
        "in",
        lossy(1),
        "obstacles ahead make it wait",
        "optional",
        also=("sensor_msgs/msg/PointCloud2",),
    ),
    StandardTopic(
        "camera/image_raw",
        "sensor_msgs/msg/Image",
        "in",
        lossy(1),
        "pictures for the console; `robot_state` says if they arrive",
        "optional",
        also=("sensor_msgs/msg/CompressedImage",),
    ),
    StandardTopic(
        "map",
        "nav_msgs/msg/OccupancyGrid",
        "in",
        latched(1),
        "the map that the console draws",
        "optional",
    ),
    StandardTopic(
        "battery_state",
        "sensor_msgs/msg/BatteryState",
        "in",
        lossy(5),
        "the charge: `percentage` from 0 to 1, or to 100",
        "optional",
    ),
    StandardTopic(
        "cmd_vel",
        "geometry_msgs/msg/Twist",
        "out",
        reliable(1),
        "velocities, if EdgeVox steers",
        "no goal_pose, or a distance or an angle is asked",
        also=("geometry_msgs/msg/TwistStamped",),
    ),
    StandardTopic(
        "goal_pose",
        "geometry_msgs/msg/PoseStamped",
        "out",
        reliable(1),
        "the goal to drive to",
        "a subscriber",
    ),
)
"""The topics of a robot that `robot-external` drives, in that robot's namespace."""
DRIVEN: Mapping[str, StandardTopic] = {row.topic: row for row in EXTERNAL}
NAV2_ACTION = "navigate_to_pose"
"""The action that drives the robot if Nav2 runs, in the same namespace."""

AUDIO: tuple[StandardTopic, ...] = (
    StandardTopic(
        "audio_in",
        "edgevox_msgs/msg/AudioData",
        "in",
        lossy(5),
        "a microphone: 16 kHz mono, 16 bit little-endian, up to 1 s a message",
        "--audio-in ros2",
    ),
    StandardTopic(
        "audio_out",
        "edgevox_msgs/msg/AudioData",
        "out",
        reliable(10),
        "a loudspeaker: the same format, up to 40 ms a message, sent 60 ms early",
        "--audio-out ros2",
    ),
)
"""Topics of sound, if the settings ask for them."""
AUDIO_IN, AUDIO_OUT = AUDIO
