"""Skills: typed functions that a robot can do. Packages of skills import this."""

from edgevox.agent.skills.skill import (
    NO_SKILLS,
    STOP,
    Call,
    Example,
    GoalHandle,
    OneOf,
    OwnName,
    Result,
    Skill,
    SkillFailed,
    SkillPhrases,
    SkillSet,
    UnknownSkill,
    reason_of,
    skill,
)

__all__ = [
    "NO_SKILLS",
    "STOP",
    "Call",
    "Example",
    "GoalHandle",
    "OneOf",
    "OwnName",
    "Result",
    "Skill",
    "SkillFailed",
    "SkillPhrases",
    "SkillSet",
    "UnknownSkill",
    "reason_of",
    "skill",
]
