"""The policy in force: its file, and the facts about the robot that it needs."""

from collections.abc import Iterable
from functools import lru_cache, partial
from pathlib import Path
from typing import Protocol, runtime_checkable

from edgevox.agent.phrases.load import phrasebook
from edgevox.agent.phrases.name_rules import word_meant
from edgevox.agent.policy import Guard, Policy, PolicyContext
from edgevox.agent.policy.guard import asked_instead, unknown_names
from edgevox.agent.policy.policy import VELOCITY
from edgevox.agent.skills import Skill, SkillFailed
from edgevox.agent.skills.skill import OneOf
from edgevox.core.bus import Bus
from edgevox.core.log import get_logger
from edgevox.core.settings import Settings
from edgevox.core.transforms import Pose2D
from edgevox.robots.capabilities import (
    AvoidsPlaces,
    Body,
    HasPlaces,
    HasPose,
    LimitsSpeed,
    RemembersPlaces,
    Twist2D,
)
from edgevox.ros2.contract import COMMANDS

log = get_logger(__name__)

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
    if isinstance(body, AvoidsPlaces):
        body.avoid_places(partial(_forbidden_places, guard))
    return guard


def strange_names(guard: Guard, skills: Iterable[Skill]) -> list[str]:
    """Return a sentence for each name in the policy that has not the effect it seems to have."""
    skills = list(skills)
    file = guard.policy.file
    return unknown_names(file, known_names(skills), guard.around) + asked_instead(file, skills)


def log_strange_names(guard: Guard, skills: Iterable[Skill]) -> None:
    """Say so in the log; to be called at the start."""
    for one in strange_names(guard, skills):
        log.warning("policy_names_unknown", reason=one)


def _forbidden_places(guard: Guard) -> frozenset[str]:
    """The places of the robot's map that no way may lead through, by the policy as it is now."""
    places = guard.look().file.limits.places
    if places is None or places.never is None:
        return frozenset()
    return frozenset(one for one in guard.around.places() if places.forbids(one, guard.around))


def policy_context(body: Body | None) -> PolicyContext:
    """Return the policy's facts about this body."""

    def here() -> Pose2D | None:
        try:
            return body.pose() if isinstance(body, HasPose) else None
        except SkillFailed:  # nothing is heard of it
            return None

    if not isinstance(body, HasPlaces):
        return PolicyContext(here=here)
    memory = body.place_memory if isinstance(body, RemembersPlaces) else None
    own = memory.own if memory else OneOf(tuple(body.places))
    return PolicyContext(
        lambda: body.places,
        body.place_at,
        here,
        taught=memory.points if memory else dict,
        place_meant=lru_cache(maxsize=1024)(partial(word_meant, choices=own)),
    )


def known_names(skills: Iterable[Skill]) -> frozenset[str]:
    """Return the names for rules.

    The agent's skills, those of all robots here, and other requests.
    """
    return frozenset(
        {*(one.name for one in skills), *phrasebook(ANY_LANGUAGE).skills, *COMMANDS, VELOCITY}
    )
