"""The ways by which somebody asks the robot for something."""

from enum import StrEnum


class Way(StrEnum):
    """One way in. A page in the browser has one for each role."""

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
        """Whether somebody is there who can be asked back, in words."""
        return self not in _UNATTENDED


_UNATTENDED = frozenset({Way.COMMAND, Way.ACTION, Way.GOAL_POSE, Way.CMD_VEL})
