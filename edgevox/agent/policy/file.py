"""The format of a policy file, its validation, and the verdicts of a policy.

Validation guesses nothing and ignores nothing: an unknown key is an error.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from enum import StrEnum
from functools import lru_cache
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Field, StringConstraints

from edgevox.agent.policy.limits import PolicyLimits, PolicyPart
from edgevox.agent.skills import SkillFailed
from edgevox.agent.text.same_name import name_form
from edgevox.core.commands import Way
from edgevox.core.errors import InvalidValue
from edgevox.core.files.user_file import read_text
from edgevox.core.files.yaml_file import YamlFile
from edgevox.core.reason import NO_REASON, Reason


class Rule(StrEnum):
    """Rules for a request, from mild to strict: do it, do it after a yes, refuse it."""

    ALLOW = "allow"
    CONFIRM = "confirm"
    DENY = "deny"


@dataclass(frozen=True, slots=True)
class Verdict:
    """A rule, with the reason if it is not `ALLOW`."""

    rule: Rule
    reason: Reason = NO_REASON


class Denied(SkillFailed):
    """The policy refuses `skill`, which was asked for by this `way`."""

    def __init__(
        self, reason: Reason, way: Way, skill: str, arguments: Mapping[str, Any] | None = None
    ) -> None:
        super().__init__(reason)
        self.way = way
        self.skill = skill
        self.arguments = arguments or {}


class NeedsConfirmation(Denied):
    """The policy wants a yes first, and a person can be asked.

    A caller that cannot ask must refuse the request, as for any other `Denied`.
    """


ANY = "*"
"""Key that stands for every skill, or for every way in."""
MOST_SKILLS = 200

WayName = Literal[
    "*",
    "voice",
    "typed",
    "text_input",
    "command",
    "action",
    "goal_pose",
    "cmd_vel",
    "console_viewer",
    "console_operator",
]
"""The names of all `Way`s, and `*` for all of them."""
SkillName = Annotated[str, StringConstraints(pattern=r"^(\*|[A-Za-z_][A-Za-z0-9_]*)$")]
RuleWord = Literal["allow", "confirm", "deny"]


def _of_all_skills(value: Any) -> Any:
    """Turn a single word into rules: it stands for every skill."""
    return {ANY: value} if isinstance(value, str) else value


SkillRules = Annotated[
    dict[SkillName, RuleWord],
    BeforeValidator(_of_all_skills, json_schema_input_type=RuleWord | dict[SkillName, RuleWord]),
    Field(max_length=MOST_SKILLS),
]


class PolicyFile(PolicyPart):
    """A policy file."""

    about: str = Field("", max_length=500, description="its purpose, in a sentence")
    rules: dict[WayName, SkillRules] = Field(
        default_factory=dict,
        description="by way in and skill: allow, confirm or deny; a single word applies to every "
        "skill. The skill under its way comes first; then the stricter of the way's `*` and the "
        "skill under `*`; then `*` under `*`; all other skills are allowed",
    )
    limits: PolicyLimits = Field(
        default_factory=PolicyLimits, description="limits for all motion, from every way in"
    )

    @property
    def skills(self) -> frozenset[str]:
        """Names of all skills in the rules."""
        return frozenset(name for one in self.rules.values() for name in one) - {ANY}

    def of_way(self, way: str) -> Mapping[str, str]:
        """The rules under the name of a way, or under `*`."""
        return next((entry for name, entry in self.rules.items() if name == way), {})

    def rule(self, way: str, skill: str) -> Rule:
        """The rule for a skill that is asked for by this way."""
        own, every = self.of_way(way), self.of_way(ANY)
        if found := _entry(own, skill):
            return Rule(found)
        fitting = [Rule(word) for word in (own.get(ANY), _entry(every, skill)) if word]
        if fitting:
            return max(fitting, key=list(Rule).index)
        return Rule(every.get(ANY, Rule.ALLOW))


def _entry(entry: Mapping[str, str], skill: str) -> str | None:
    """The rule for a skill in an entry, in any spelling of its name; the strictest of several."""
    if skill in entry:
        return entry[skill]
    said = [Rule(word) for name, word in entry.items() if name != ANY and _is(name, skill)]
    return max(said, key=list(Rule).index, default=None)


@lru_cache(maxsize=4096)
def _is(name: str, skill: str) -> bool:
    return name_form(name) == name_form(skill)


def read_policy_file(file: Path) -> PolicyFile:
    """The policy in a file. Raises `InvalidValue` with file, line, field and expectation."""
    return parse_policy(read_text(file, "policy"), file.name)


def parse_policy(text: str, name: str) -> PolicyFile:
    """The policy in a text, as `read_policy_file`; `name` is the file's name in messages."""
    file = YamlFile(text, name)
    if not isinstance(file.data, dict):
        raise InvalidValue(name, file.data, "a mapping with rules and limits")
    return file.read(PolicyFile, file.data)
