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
    from edgevox.ros2.external.external_settings import ExternalSettings, SteeringLimits
    from edgevox.ros2.external.locations import load_locations

    places = load_locations(settings.locations) if settings.locations else {}
    try:
        from edgevox.ros2.external.robot import ExternalRobot
    except ModuleNotFoundError as error:
        if (error.name or "").partition(".")[0].startswith("edgevox"):
            raise
        raise EdgeVoxError(
            f"robot-external needs ROS 2, and {error.name} cannot be imported: source ROS 2's "
            f"setup.bash, or {install_extra('ros2')}"
        ) from error
    limits = SteeringLimits(
        max_linear_m_s=settings.max_linear, max_angular_rad_s=settings.max_angular
    )
    return ExternalRobot(settings.external_namespace, places, ExternalSettings(steering=limits))


EXTERNAL = Robot(
    "any ROS 2 robot, over its odom, cmd_vel and goal_pose",
    _build,
    reads=frozenset({"external_namespace", "locations", "max_angular", "max_linear"}),
)

__all__ = ["EXTERNAL"]
