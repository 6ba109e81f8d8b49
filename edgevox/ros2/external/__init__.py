"""A body that lives on ROS 2: any robot that speaks the contract's `external_robot` topics.

Imports core, agent.skills, agent.text, robots and ros2 of edgevox. Only `EXTERNAL` is for
others; rclpy is imported when its body is built.
"""

import os

from edgevox.core.errors import EdgeVoxError, install_extra
from edgevox.core.log import get_logger
from edgevox.core.settings import Settings
from edgevox.robots.capabilities import Body
from edgevox.robots.plugin import Robot
from edgevox.ros2.open import check_environment

log = get_logger(__name__)

_OF_DRIVES = frozenset({"locations", "max_angular", "max_linear"})
"""Settings that do nothing for a robot that does not drive."""


def _build(settings: Settings, _speed: float | None) -> Body:
    from edgevox.ros2.external.settings import ExternalSettings
    from edgevox.ros2.robot_file.load import NO_FILE

    check_environment(os.environ)
    try:
        from edgevox.ros2.external.robot import ExternalRobot
        from edgevox.ros2.external.stationary import StationaryRobot
        from edgevox.ros2.robot_file.skills import LoadedFile, load_described
    except ModuleNotFoundError as error:
        if (error.name or "").partition(".")[0].startswith("edgevox"):
            raise
        raise EdgeVoxError(
            f"robot-external needs ROS 2, and {error.name} cannot be imported: source ROS 2's "
            f"setup.bash, or {install_extra('ros2')}"
        ) from error
    loaded = load_described(settings.robot_file) if settings.robot_file else LoadedFile(NO_FILE)
    described = loaded.described
    drives = described.robot.drives
    places = described.places(settings) if drives else {}
    namespace = described.namespace(settings)
    for name, reason in loaded.off.items():
        log.warning("skill_off", skill=name, reason=reason)
    robot: ExternalRobot | StationaryRobot
    if drives:
        how = ExternalSettings(
            steering=described.steering(settings), remappings=tuple(described.remappings)
        )
        robot = ExternalRobot(namespace, places, how, described=loaded.skills, states=loaded.states)
    else:
        _tell_unread(settings)
        robot = StationaryRobot(namespace, loaded.skills, states=loaded.states)
    robot.about, robot.own_policy = described.robot.about, described.policy
    robot.skills_off, robot.file_sentences = loaded.off, described.sentences
    robot.file_notes = described.notes
    return robot


def _tell_unread(settings: Settings) -> None:
    for name in sorted(_OF_DRIVES & settings.model_fields_set):
        log.warning("setting_unread", setting=name, robot="robot-external")


EXTERNAL = Robot(
    "any ROS 2 robot, over its odom, cmd_vel and goal_pose",
    _build,
    reads=_OF_DRIVES | {"robot_namespace", "robot_file"},
)

__all__ = ["EXTERNAL"]
