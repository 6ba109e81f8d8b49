"""A body that lives on ROS 2: any robot that speaks the contract's `external_robot` topics.

Imports core, agent.skills, agent.reasons, robots and ros2 of edgevox. Only `EXTERNAL` is for
others; rclpy is imported when its body is built.
"""

from edgevox.core.errors import EdgeVoxError
from edgevox.core.extras import install_extra
from edgevox.core.settings import Settings
from edgevox.robots.capabilities import Body
from edgevox.robots.plugin import Robot


def _build(settings: Settings, _speed: float | None) -> Body:
    from edgevox.ros2.external.external_settings import ExternalSettings
    from edgevox.ros2.robot_file.load import NO_FILE, load_robot_file

    described = load_robot_file(settings.robot_file) if settings.robot_file else NO_FILE
    places = described.places(settings)
    try:
        from edgevox.ros2.external.robot import ExternalRobot
        from edgevox.ros2.robot_file.described_skills import described_skills
    except ModuleNotFoundError as error:
        if (error.name or "").partition(".")[0].startswith("edgevox"):
            raise
        raise EdgeVoxError(
            f"robot-external needs ROS 2, and {error.name} cannot be imported: source ROS 2's "
            f"setup.bash, or {install_extra('ros2')}"
        ) from error
    steering = described.steering(settings)
    robot = ExternalRobot(
        described.namespace(settings),
        places,
        ExternalSettings(steering=steering, remappings=tuple(described.remappings)),
        described=described_skills(described.robot, described.file),
    )
    robot.about, robot.own_policy = described.robot.about, described.policy
    return robot


EXTERNAL = Robot(
    "any ROS 2 robot, over its odom, cmd_vel and goal_pose",
    _build,
    reads=frozenset({"robot_namespace", "locations", "max_angular", "max_linear", "robot_file"}),
)

__all__ = ["EXTERNAL"]
