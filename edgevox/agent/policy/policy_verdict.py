"""What a policy says of one thing that is asked."""

from collections.abc import Mapping
from dataclasses import dataclass
from enum import StrEnum
from typing import Any

from edgevox.agent.skills import SkillFailed
from edgevox.core.reason import NO_REASON, Reason
from edgevox.core.ways import Way


class Rule(StrEnum):
    """What becomes of it: it is done, done once somebody has said yes, or refused."""

    ALLOW = "allow"
    CONFIRM = "confirm"
    DENY = "deny"


@dataclass(frozen=True, slots=True)
class Verdict:
    """A rule, and why it is not simply done."""

    rule: Rule
    reason: Reason = NO_REASON


class Denied(SkillFailed):
    """The policy refuses it. `skill` is what was asked for, by this `way`."""

    def __init__(
        self, reason: Reason, way: Way, skill: str, arguments: Mapping[str, Any] | None = None
    ) -> None:
        super().__init__(reason)
        self.way = way
        self.skill = skill
        self.arguments = arguments or {}


class NeedsConfirmation(Denied):
    """The policy wants a yes first, and there is somebody to ask.

    Whoever cannot ask refuses it, as everything else that is denied.
    """
