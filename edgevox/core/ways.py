"""The ways by which requests reach the robot."""

from enum import StrEnum


class Way(StrEnum):
    """A way in. A page in the browser has one for each role."""

    VOICE = "voice"
    TYPED = "typed"
    TEXT_INPUT = "text_input"
    COMMAND = "command"
    ACTION = "action"
    GOAL_POSE = "goal_pose"
    CMD_VEL = "cmd_vel"
    CONSOLE_VIEWER = "console_viewer"
    CONSOLE_OPERATOR = "console_operator"

    @property
    def attended(self) -> bool:
        """True if the way has a person whom the robot can ask back, in words."""
        return self not in _UNATTENDED


_UNATTENDED = frozenset({Way.COMMAND, Way.ACTION, Way.GOAL_POSE, Way.CMD_VEL})
