"""The policy: the format of its file, and the verdicts on requests.

Validation guesses nothing and ignores nothing: an unknown key is an error. A policy never changes:
a new file is a new policy.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from datetime import datetime
from enum import StrEnum
from functools import cached_property, lru_cache
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Field, StringConstraints

from edgevox.agent.policy.limits import PolicyContext, PolicyLimits, PolicyPart
from edgevox.agent.skills import STOP, SkillFailed
from edgevox.agent.text.reasons import because
from edgevox.agent.text.same_name import name_form
from edgevox.core.commands import Way
from edgevox.core.errors import InvalidValue
from edgevox.core.files.user_file import read_text
from edgevox.core.files.yaml_file import YamlFile
from edgevox.core.reason import NO_REASON, Reason


class Rule(StrEnum):
    """Rules for a request, from mild to strict.

    Do it, say it and do it unless a person says no, do it after a yes, refuse it.
    """

    ALLOW = "allow"
    COUNTDOWN = "countdown"
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
    """The policy wants a yes or a countdown first (`rule`), and a person can be asked.

    A caller that cannot ask must refuse the request, as for any other `Denied`.
    """

    def __init__(self, rule: Rule, *refused: Any) -> None:
        super().__init__(*refused)
        self.rule = rule


ANY = "*"
"""Key that stands for every skill, or for every way in."""
MOST_SKILLS = 200

WayName = Literal[
    "*",
    "voice",
    "voice_guest",
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
RuleWord = Literal["allow", "countdown", "confirm", "deny"]


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
        description="by way in and skill: allow, countdown, confirm or deny; a single word applies "
        "to every skill. The skill under its way comes first; then the stricter of the way's `*` "
        "and the skill under `*`; then `*` under `*`; all other skills are allowed. For "
        "voice_guest the stricter of its own rule and of voice's",
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
        """The rule for a skill that is asked for by this way; a guest's is never milder."""
        if way == Way.VOICE_GUEST:
            guests, spoken = self.of_way(way), self.rule(Way.VOICE, skill)
            word = _entry(guests, skill) or guests.get(ANY)
            return max(Rule(word), spoken, key=list(Rule).index) if word else spoken
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
    if file.data is not None and not isinstance(file.data, dict):
        raise InvalidValue(name, file.data, "a mapping with rules and limits")
    return file.read(PolicyFile, file.data)


ALLOWED = Verdict(Rule.ALLOW)
VELOCITY = "cmd_vel"
"""The name that rules and refusals give to steering by velocities, as if it were a skill."""
NOWHERE = PolicyContext()


def local_time() -> datetime:
    """The time by the machine's clock and time zone."""
    return datetime.now().astimezone()


@dataclass(frozen=True)
class Policy:
    """Judges requests. An empty policy permits all that the robot's own limits permit.

    Stopping is always permitted, whatever the file says.
    """

    file: PolicyFile = field(default_factory=PolicyFile)

    def judge(
        self,
        way: Way,
        skill: str,
        arguments: Mapping[str, Any],
        *,
        moves: bool = True,
        confirm: bool = False,
        towards_rad: float = 0.0,
        around: PolicyContext = NOWHERE,
        now: datetime | None = None,
    ) -> Verdict:
        """The verdict on a skill that was asked for.

        A request that needs a yes is denied if its way has no person to ask.

        Args:
            way: The way of the request.
            skill: The skill's name.
            arguments: Its checked arguments.
            moves: True if it sets the robot in motion; only then the limits apply.
            confirm: True if the skill itself wants a yes, even if the file allows it.
            towards_rad: Direction of a distance among the arguments, from the robot's heading.
            around: The places and the pose of the robot.
            now: The local time; the present by default.
        """
        if skill == STOP:
            return ALLOWED
        rule = self.file.rule(way, skill)
        if rule is Rule.DENY:
            if way is Way.VOICE_GUEST and self.file.rule(Way.VOICE, skill) is not rule:
                return Verdict(rule, because("policy_guest", way=way, skill=skill))
            return Verdict(rule, because("policy_denied", way=way, skill=skill))
        if moves:
            limits = self.file.limits
            reason = limits.closed(now or local_time()) or limits.against(
                arguments, around, towards_rad
            )
            if reason:
                return Verdict(Rule.DENY, reason)
        if rule is Rule.ALLOW and not confirm:
            return ALLOWED
        if not way.attended:
            return Verdict(Rule.DENY, because("needs_a_person", way=way, skill=skill))
        asks = Rule.CONFIRM if confirm else rule
        return Verdict(asks, because("needs_confirmation", way=way, skill=skill))

    def steered(self, now: datetime | None = None, way: Way = Way.CMD_VEL) -> Reason:
        """The reason against steering by velocities now; empty if it is allowed.

        A rule that needs a yes refuses, since the robot cannot ask while a person steers. Takes
        microseconds.
        """
        return self._steering[way] or (
            self.file.limits.closed(now or local_time()) if self.file.limits.hours else NO_REASON
        )

    def slowed(self, linear_m_s: float, angular_rad_s: float) -> tuple[float, float]:
        """The velocity, slowed to the permitted speed on the same arc if it is too fast."""
        speed = self.file.limits.speed
        return speed.within(linear_m_s, angular_rad_s) if speed else (linear_m_s, angular_rad_s)

    @cached_property
    def _steering(self) -> Mapping[Way, Reason]:
        """The reasons of the rules against steering by velocities, by way; empty if allowed."""
        return {way: _steering_by(way, self.file.rule(way, VELOCITY)) for way in Way}


def _steering_by(way: Way, rule: Rule) -> Reason:
    match rule:
        case Rule.DENY:
            return because("policy_denied", way=way, skill=VELOCITY)
        case Rule.COUNTDOWN | Rule.CONFIRM:
            return because("needs_a_person", way=way, skill=VELOCITY)
    return NO_REASON


def load_policy(file: Path) -> Policy:
    """The policy of a file. Raises `InvalidValue` naming file, line, field and expectation."""
    return Policy(read_policy_file(file))
