"""The policy, which judges requests by one file. It never changes: a new file is a new policy."""

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
from edgevox.core.commands import Way
from edgevox.core.reason import NO_REASON, Reason

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
        case Rule.CONFIRM:
            return because("needs_a_person", way=way, skill=VELOCITY)
    return NO_REASON


def load_policy(file: Path) -> Policy:
    """The policy of a file. Raises `InvalidValue` naming file, line, field and expectation."""
    return Policy(read_policy_file(file))
