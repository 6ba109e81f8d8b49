"""Puts the policy in force: its file, and what it must know of the robot."""

from collections.abc import Iterable

from edgevox.agent.phrase_file import phrasebook
from edgevox.agent.policy import Guard, PolicyContext
from edgevox.agent.policy.policy import VELOCITY
from edgevox.agent.skills import Skill, SkillFailed
from edgevox.core.bus import Bus
from edgevox.core.settings import Settings
from edgevox.robots.capabilities import Body, HasPlaces, HasPose, LimitsSpeed, Twist2D
from edgevox.ros2.contract import COMMANDS

ANY_LANGUAGE = "de"
"""Each phrasebook but the English one has the skills of all robots that come with EdgeVox."""


def build_guard(settings: Settings, bus: Bus, body: Body | None) -> Guard:
    """The guard of this agent. Raises `InvalidValue` for a file that cannot be used."""
    guard = Guard(settings.policy, bus, policy_context(body))
    if isinstance(body, LimitsSpeed):
        body.limit_speed(
            lambda twist: Twist2D(*guard.policy.slowed(twist.linear_m_s, twist.angular_rad_s))
        )
    return guard


def policy_context(body: Body | None) -> PolicyContext:
    """What is known of this body."""

    def here() -> tuple[float, float] | None:
        if not isinstance(body, HasPose):
            return None
        try:
            pose = body.pose()
        except SkillFailed:  # nothing is heard of it
            return None
        return pose.x_m, pose.y_m

    if isinstance(body, HasPlaces):
        return PolicyContext(lambda: body.places, body.place_at, here)
    return PolicyContext(here=here)


def known_names(skills: Iterable[Skill]) -> frozenset[str]:
    """What rules may name: an agent's skills, those of all robots here, and what is no skill."""
    return frozenset(
        {*(one.name for one in skills), *phrasebook(ANY_LANGUAGE).skills, *COMMANDS, VELOCITY}
    )
