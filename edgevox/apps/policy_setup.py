"""Puts the policy in force: its file, and what it must know of the robot."""

from collections.abc import Iterable
from pathlib import Path
from typing import Protocol, runtime_checkable

from edgevox.agent.phrase_file import phrasebook
from edgevox.agent.policy import Guard, Policy, PolicyContext
from edgevox.agent.policy.policy import VELOCITY
from edgevox.agent.skills import Skill, SkillFailed
from edgevox.core.bus import Bus
from edgevox.core.settings import Settings
from edgevox.robots.capabilities import Body, HasPlaces, HasPose, LimitsSpeed, Twist2D
from edgevox.ros2.contract import COMMANDS

ANY_LANGUAGE = "de"
"""Each phrasebook but the English one has the skills of all robots that come with EdgeVox."""


@runtime_checkable
class BringsPolicy(Protocol):
    """A body with a policy of its own: a file, or what stands in another one."""

    @property
    def own_policy(self) -> Path | Policy | None:
        """None for no policy."""


def build_guard(settings: Settings, bus: Bus, body: Body | None) -> Guard:
    """The guard of this agent: by the setting's file, else by what the body itself brings.

    Raises `InvalidValue` for a file that cannot be used.
    """
    own = body.own_policy if isinstance(body, BringsPolicy) else None
    file = settings.policy or (own if isinstance(own, Path) else None)
    fixed = own if file is None and isinstance(own, Policy) else None
    guard = Guard(file, bus, policy_context(body), fixed=fixed)
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
