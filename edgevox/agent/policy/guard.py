"""The guard, which every request passes: the policy in force, and the count of refusals.

`WatchedFile` reads a policy file again when it has changed. The file's name decides: a file that is
written in place, replaced, or reached by a swapped link counts as changed; Kubernetes swaps the
link of a ConfigMap's folder.
"""

import json
import threading
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from datetime import datetime
from pathlib import Path
from typing import Any

from edgevox.agent.policy.limits import PolicyContext
from edgevox.agent.policy.policy import (
    NOWHERE,
    VELOCITY,
    Denied,
    NeedsConfirmation,
    Policy,
    Rule,
    load_policy,
    local_time,
)
from edgevox.core.agent_events import GoalRejected
from edgevox.core.bus import Bus
from edgevox.core.clock import Clock, SystemClock
from edgevox.core.commands import Way
from edgevox.core.errors import InvalidValue, shorten
from edgevox.core.log import get_logger

log = get_logger(__name__)


Stamp = tuple[int, ...] | str
"""Numbers that change with a file, or the reason why the file cannot be looked at."""


class WatchedFile:
    """A policy file that is read again after a change. Any thread may look.

    The policy changes as a whole or not at all.
    """

    def __init__(self, file: Path) -> None:
        """Read the file. Raises `InvalidValue` if it cannot be used."""
        self._lock = threading.Lock()
        self._file = file
        self._seen = _stamp(file)
        self.policy = load_policy(file)
        self.fault = ""
        """The reason why the present file is not in force; empty if it is."""

    def look(self) -> Policy:
        """Read the file if it has changed, and return the policy in force.

        A changed file that cannot be used leaves the old policy in force.
        """
        if _stamp(self._file) == self._seen:
            return self.policy
        with self._lock:
            now = _stamp(self._file)  # before the read: a later change is then seen next time
            if now != self._seen:
                self._read(now)
        return self.policy

    def _read(self, stamp: Stamp) -> None:
        try:
            policy = load_policy(self._file)
        except InvalidValue as error:
            self.fault = str(error)
            # No traceback: the reason says it all.
            log.error("policy_broken", file=str(self._file), reason=self.fault)  # noqa: TRY400
        else:
            self.policy, self.fault = policy, ""
            log.info("policy_changed", file=str(self._file))
        self._seen = stamp


def _stamp(file: Path) -> Stamp:
    try:
        found = file.stat()
    except (OSError, ValueError) as error:
        return str(error)
    return (found.st_dev, found.st_ino, found.st_size, found.st_mtime_ns, found.st_ctime_ns)


TELL_EVERY_S = 1.0
"""Least seconds between two reports of refused velocities, which come in streams; all count."""


@dataclass(frozen=True, slots=True)
class CheckedCall:
    """A call of a skill, as the policy judges it."""

    skill: str
    """The skill's name."""
    arguments: Mapping[str, Any] = field(default_factory=dict)
    """Its checked arguments."""
    moves: bool = True
    """True if the call sets the robot in motion."""
    confirm: bool = False
    """True if the skill itself wants a yes, even if the policy does not."""
    towards_rad: float = 0.0
    """Direction of a distance among the arguments, from the robot's heading."""


class Guard:
    """Holds the policy in force and judges by it. Any thread may ask.

    A changed file that cannot be read leaves the old policy in force; that is logged, and `fault`
    tells it until the file is mended. A refusal is published as `GoalRejected`.
    """

    def __init__(
        self,
        file: Path | None = None,
        bus: Bus | None = None,
        around: PolicyContext = NOWHERE,
        *,
        fixed: Policy | None = None,
        now: Callable[[], datetime] = local_time,
        clock: Clock | None = None,
    ) -> None:
        """Read the file, if there is one. Raises `InvalidValue` if it cannot be used.

        Args:
            file: The policy file, read again whenever a request finds it changed.
            bus: Carries the refusals.
            around: The places and the pose of the robot.
            fixed: The policy in force without a file; by default one that permits all.
            now: Returns the local time.
            clock: Spaces the reports of refused velocities.
        """
        self.around = around
        self._file = WatchedFile(file) if file else None
        self._fixed = fixed or Policy()
        self._bus = bus or Bus()
        self._now = now
        self._clock = clock or SystemClock()
        self._lock = threading.Lock()
        self._refusals: Counter[tuple[str, ...]] = Counter()
        self._told_s = float("-inf")
        self.slowed = 0
        """Number of velocities that were slowed to the permitted speed."""
        self.last = ""
        """The last refusal in a few words; empty if there was none."""

    @property
    def policy(self) -> Policy:
        """The policy in force."""
        return self._file.policy if self._file else self._fixed

    @property
    def has_rules(self) -> bool:
        """True if a policy was given: a file, or one that the robot brings."""
        return self._file is not None or self._fixed != Policy()

    @property
    def fault(self) -> str:
        """The reason why the present file cannot be used; empty if it is in force."""
        return self._file.fault if self._file else ""

    @property
    def refusals(self) -> Mapping[tuple[str, ...], int]:
        """Number of refusals, by way and code."""
        with self._lock:
            return dict(self._refusals)

    def look(self) -> Policy:
        """Read the file again if it has changed, and return the policy in force."""
        return self._file.look() if self._file else self._fixed

    def check(
        self, way: Way, calls: Sequence[CheckedCall], turn: int = 0, *, confirmed: bool = False
    ) -> None:
        """Raise `Denied` if one of these calls is refused; count and report the refusal.

        Otherwise raise `NeedsConfirmation` if one needs a yes and they are not `confirmed`. A
        caller that cannot ask must pass that exception to `refuse`.
        """
        unsure: NeedsConfirmation | None = None
        for one in calls:
            try:
                self.judge(way, one)
            except NeedsConfirmation as found:
                unsure = unsure or found
            except Denied as denied:
                self.refuse(denied, turn)
                raise
        if unsure and not confirmed:
            raise unsure

    def leave(self, way: Way, call: CheckedCall, *, confirmed: bool = False) -> "PolicyLeave":
        """The permission that a goal of this call asks when it begins and while it goes on."""
        return PolicyLeave(self, way, call, confirmed=confirmed)

    def judge(self, way: Way, call: CheckedCall) -> None:
        """Raise `Denied` or `NeedsConfirmation` for one call, without counting or reporting it."""
        verdict = self.look().judge(
            way,
            call.skill,
            call.arguments,
            moves=call.moves,
            confirm=call.confirm,
            towards_rad=call.towards_rad,
            around=self.around,
            now=self._now(),
        )
        if verdict.rule is Rule.DENY:
            raise Denied(verdict.reason, way, call.skill, call.arguments)
        if verdict.rule is Rule.CONFIRM:
            raise NeedsConfirmation(verdict.reason, way, call.skill, call.arguments)

    def permit(
        self, way: Way, calls: Sequence[CheckedCall], turn: int = 0, *, confirmed: bool = False
    ) -> None:
        """As `check`, for a caller that cannot ask: a call that needs a yes is refused as well."""
        try:
            self.check(way, calls, turn, confirmed=confirmed)
        except NeedsConfirmation as unsure:
            self.refuse(unsure, turn)
            raise

    def velocity(
        self, linear_m_s: float, angular_rad_s: float, way: Way = Way.CMD_VEL
    ) -> tuple[float, float]:
        """The permitted part of a velocity. Raises `Denied`; standing still is never refused.

        Takes microseconds, because it does not look at the file.
        """
        if not (linear_m_s or angular_rad_s):
            return linear_m_s, angular_rad_s
        policy = self.policy
        if reason := policy.steered(self._now() if policy.file.limits.hours else None, way):
            denied = Denied(reason, way, VELOCITY)
            self.refuse(denied)
            raise denied
        permitted = policy.slowed(linear_m_s, angular_rad_s)
        self.slowed += permitted != (linear_m_s, angular_rad_s)
        return permitted

    def refuse(self, denied: Denied, turn: int = 0, *, told: bool = False) -> None:
        """Count and log a refusal, and publish it unless it is `told` on the bus already."""
        self._count(denied)
        if denied.skill == VELOCITY and not self._due():
            return
        code = denied.reason.code
        log.info("policy_refused", way=str(denied.way), skill=denied.skill, code=code)
        if not told and denied.way is not Way.ACTION:  # an action reports its rejected goals
            self._bus.publish(_rejected(denied, turn))

    def _count(self, denied: Denied) -> None:
        code = denied.reason.code
        with self._lock:
            self._refusals[str(denied.way), code] += 1
            self.last = f"{denied.way} {denied.skill}: {code}"

    def _due(self) -> bool:
        now_s = self._clock.now()
        with self._lock:
            due = now_s - self._told_s >= TELL_EVERY_S
            if due:
                self._told_s = now_s
        return due


class PolicyLeave:
    """The permission of one goal, asked again when it begins and while it goes on.

    By the beginning, the policy, the places and the robot may have changed. Later, only a new
    policy is asked. A refusal is counted and logged; the goal's end reports it.
    """

    def __init__(self, guard: Guard, way: Way, call: CheckedCall, *, confirmed: bool) -> None:
        self._guard, self._way, self._call = guard, way, call
        self._confirmed = confirmed
        self._policy: Policy | None = None

    def begin(self) -> None:
        """Raise `Denied` if the goal may not begin."""
        self._policy = self._guard.look()
        self._ask()

    def go_on(self) -> None:
        """Raise `Denied` if a new policy is in force and forbids the goal."""
        policy = self._guard.look()
        if policy is not self._policy:
            self._policy = policy
            self._ask()

    def _ask(self) -> None:
        try:
            self._guard.judge(self._way, self._call)
        except NeedsConfirmation as unsure:
            if not self._confirmed:
                self._guard.refuse(unsure, told=True)
                raise
        except Denied as denied:
            self._guard.refuse(denied, told=True)
            raise


def _rejected(denied: Denied, turn: int) -> GoalRejected:
    arguments = shorten(json.dumps(denied.arguments, default=str))
    return GoalRejected(denied.skill, arguments, denied.reason, way=str(denied.way), turn=turn)
