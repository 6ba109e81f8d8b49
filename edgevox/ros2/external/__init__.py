"""A body that lives on ROS 2: any robot that speaks the contract's `external_robot` topics.

Imports core, agent.skills and robots of edgevox. Only `build_external` is for others; rclpy is
imported when it is called.
"""

from pathlib import Path

from edgevox.core.errors import EdgeVoxError
from edgevox.core.extras import install_extra
from edgevox.robots.capabilities import Body


def build_external(
    namespace: str,
    locations: Path | None = None,
    *,
    max_linear_m_s: float,
    max_angular_rad_s: float,
) -> Body:
    """The body of a robot whose topics are in this namespace, not yet started.

    Raises `InvalidValue` naming what is wrong in the locations file, and `EdgeVoxError` where rclpy
    cannot be imported.
    """
    from edgevox.ros2.external.locations import load_locations
    from edgevox.ros2.external.settings import ExternalSettings, SteeringLimits

    places = load_locations(locations) if locations else {}
    try:
        from edgevox.ros2.external.robot import ExternalRobot
    except ModuleNotFoundError as error:
        if (error.name or "").partition(".")[0].startswith("edgevox"):
            raise
        raise EdgeVoxError(
            f"robot-external needs ROS 2, and {error.name} cannot be imported: source ROS 2's "
            f"setup.bash, or {install_extra('ros2')}"
        ) from error
    limits = SteeringLimits(max_linear_m_s=max_linear_m_s, max_angular_rad_s=max_angular_rad_s)
    return ExternalRobot(namespace, places, ExternalSettings(steering=limits))


__all__ = ["build_external"]
