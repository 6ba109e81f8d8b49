"""Judges what is asked, by one policy file. It never changes; a new file is a new policy."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from datetime import datetime
from functools import cached_property
from pathlib import Path
from typing import Any

from edgevox.agent.policy.file import PolicyFile, Rule, Verdict, read_policy_file
from edgevox.agent.policy.limits import PolicyContext
from edgevox.agent.skills import STOP
from edgevox.agent.text.reasons import because
from edgevox.core.reason import NO_REASON, Reason
from edgevox.core.ways import Way

ALLOWED = Verdict(Rule.ALLOW)
VELOCITY = "cmd_vel"
"""What rules and refusals call the skill of being steered by velocities."""
NOWHERE = PolicyContext()


def local_time() -> datetime:
    """By the clock of the machine, and its time zone."""
    return datetime.now().astimezone()


@dataclass(frozen=True)
class Policy:
    """What is permitted. The empty one permits all that a robot's own limits let through.

    To stop is permitted always, whatever the file says.
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
        """What becomes of a skill, with checked arguments, asked for by this way.

        `moves` says whether it sets the robot in motion; limits are for what does. `confirm` says
        that the skill wants a yes where the file allows it, `towards_rad` which way a distance
        leads. Where nobody can be asked, what needs a yes is refused.
        """
        if skill == STOP:
            return ALLOWED
        rule = self.file.rule(way, skill)
        if rule is Rule.DENY:
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
        return Verdict(Rule.CONFIRM, because("needs_confirmation", way=way, skill=skill))

    def steered(self, now: datetime | None = None, way: Way = Way.CMD_VEL) -> Reason:
        """Why it may not be steered by velocities now; none if it may. Takes microseconds.

        Nobody can be asked while somebody steers, so what needs a yes is refused by every way.
        """
        return self._steering[way] or (
            self.file.limits.closed(now or local_time()) if self.file.limits.hours else NO_REASON
        )

    def slowed(self, linear_m_s: float, angular_rad_s: float) -> tuple[float, float]:
        """The velocity, or the same arc at the speed that is permitted."""
        speed = self.file.limits.speed
        return speed.within(linear_m_s, angular_rad_s) if speed else (linear_m_s, angular_rad_s)

    @cached_property
    def _steering(self) -> Mapping[Way, Reason]:
        """Why the rules let nobody steer by velocities, by way; none where they do."""
        return {way: _steering_by(way, self.file.rule(way, VELOCITY)) for way in Way}


def _steering_by(way: Way, rule: Rule) -> Reason:
    match rule:
        case Rule.DENY:
            return because("policy_denied", way=way, skill=VELOCITY)
        case Rule.CONFIRM:
            return because("needs_a_person", way=way, skill=VELOCITY)
    return NO_REASON


def load_policy(file: Path) -> Policy:
    """The policy of a file. Raises `InvalidValue` naming file, line, field and expectation."""
    return Policy(read_policy_file(file))
