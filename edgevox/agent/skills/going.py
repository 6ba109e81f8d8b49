"""Reasons to refuse motions that a body's skills do not allow."""

from collections.abc import Iterable

from edgevox.agent.skills import Skill
from edgevox.agent.text.reasons import because
from edgevox.core.reason import Reason

TO_POINT = "navigate_xy"
"""The skill that drives to where a body was."""
_TO_PLACE = "navigate_to"


def no_way_back(skills: Iterable[Skill]) -> Reason:
    """The reason why a robot cannot go back; another one if it cannot drive at all."""
    return because("cannot_go_back") if _goes(skills) else because("cannot_drive")


def no_further(skills: Iterable[Skill]) -> Reason:
    """The reason why a motion cannot go on further; another one if the robot cannot drive."""
    return because("not_relative") if _goes(skills) else because("has_no_further")


def _goes(skills: Iterable[Skill]) -> bool:
    return any(one.relative or one.name in (TO_POINT, _TO_PLACE) for one in skills)
