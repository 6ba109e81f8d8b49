"""Whom everybody asks before something is done: the policy in force, and what it refused.

A policy file that may change under way: looked at when somebody asks, and read if it did.

What counts is the file that its name leads to now: one written in place, one put in its place, and
a folder's link that is swapped, as Kubernetes does with a ConfigMap.
"""

import json
import threading
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from datetime import datetime
from pathlib import Path
from typing import Any

from edgevox.agent.policy.file import Denied, NeedsConfirmation, Rule
from edgevox.agent.policy.limits import PolicyContext
from edgevox.agent.policy.policy import NOWHERE, VELOCITY, Policy, load_policy, local_time
from edgevox.core.agent_events import GoalRejected
from edgevox.core.bus import Bus
from edgevox.core.clock import Clock, SystemClock
from edgevox.core.errors import InvalidValue, shorten
from edgevox.core.log import get_logger
from edgevox.core.ways import Way

log = get_logger(__name__)


Stamp = tuple[int, ...] | str
"""What a file changes with it, or why nothing can be known of it."""


class WatchedFile:
    """Any thread may look; the policy changes as a whole or not at all."""

    def __init__(self, file: Path) -> None:
        """Raises `InvalidValue` for a file that cannot be used."""
        self._lock = threading.Lock()
        self._file = file
        self._seen = _stamp(file)
        self.policy = load_policy(file)
        self.fault = ""
        """Why the file as it is now is not in force; empty if it is."""

    def look(self) -> Policy:
        """The policy in force: the file's, unless that cannot be read since it changed."""
        if _stamp(self._file) == self._seen:
            return self.policy
        with self._lock:
            now = _stamp(self._file)  # before it is read: what changes meanwhile is read again
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
"""Of velocities, which come at a rate, one refusal in so long is told; all are counted."""


@dataclass(frozen=True, slots=True)
class CheckedCall:
    """One call of a skill, its arguments checked; `moves`: it sets the robot in motion.

    `confirm`: the skill itself wants a yes, also where the policy does not. `towards_rad`: which
    way a distance leads from where the robot looks.
    """

    skill: str
    arguments: Mapping[str, Any] = field(default_factory=dict)
    moves: bool = True
    confirm: bool = False
    towards_rad: float = 0.0


class Guard:
    """Holds a policy, and asks it. Any thread may ask.

    With a `file` it is that file's policy: read at once, which raises `InvalidValue`, and again
    when something is asked and the file has changed. One that cannot be read leaves the old policy
    in force, which is logged, and said by `fault` until it is mended. Without one the `fixed`
    policy is in force. `around` is what is known of the robot, `now` the time of day. A refusal is
    published as `GoalRejected`.
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
        """How many velocities were slowed to what is permitted."""
        self.last = ""
        """What was refused last, in a few words; empty if nothing was."""

    @property
    def policy(self) -> Policy:
        """The policy in force."""
        return self._file.policy if self._file else self._fixed

    @property
    def has_rules(self) -> bool:
        """Whether anybody gave a policy: a file's, or one that the robot brings."""
        return self._file is not None or self._fixed != Policy()

    @property
    def fault(self) -> str:
        """Why the file as it is now cannot be used; empty if it is in force."""
        return self._file.fault if self._file else ""

    @property
    def refusals(self) -> Mapping[tuple[str, ...], int]:
        """How much was refused, by way and code."""
        with self._lock:
            return dict(self._refusals)

    def look(self) -> Policy:
        """The policy in force, after a look at whether the file has changed."""
        return self._file.look() if self._file else self._fixed

    def check(
        self, way: Way, calls: Sequence[CheckedCall], turn: int = 0, *, confirmed: bool = False
    ) -> None:
        """Raise `Denied` if one of these calls is refused, which is counted and told.

        Else `NeedsConfirmation`, if one needs a yes: whoever cannot ask gives it to `refuse`. Where
        somebody has `confirmed` them, that is enough.
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
        """What a goal of this call is asked by when it begins, and while it goes on."""
        return PolicyLeave(self, way, call, confirmed=confirmed)

    def judge(self, way: Way, call: CheckedCall) -> None:
        """Raise `Denied` or `NeedsConfirmation` for one call; nothing is counted or told."""
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
        """As `check`, for who cannot ask back: what needs a yes is refused, too."""
        try:
            self.check(way, calls, turn, confirmed=confirmed)
        except NeedsConfirmation as unsure:
            self.refuse(unsure, turn)
            raise

    def velocity(
        self, linear_m_s: float, angular_rad_s: float, way: Way = Way.CMD_VEL
    ) -> tuple[float, float]:
        """What of a velocity may be followed. Raises `Denied`; a stand is never refused.

        Takes microseconds: it does not look at the file.
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
        """Count a refusal, and tell of it in the log, and on the bus unless it is `told` there."""
        self._count(denied)
        if denied.skill == VELOCITY and not self._due():
            return
        code = denied.reason.code
        log.info("policy_refused", way=str(denied.way), skill=denied.skill, code=code)
        if not told and denied.way is not Way.ACTION:  # which tells of every goal that it rejects
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
    """The leave of one goal: given when it was asked for, and asked again as it begins.

    Meanwhile the policy, the places and the robot itself may have moved. While it goes on, only
    another policy is asked again. A refusal is counted and logged; the goal tells of it as it ends.
    """

    def __init__(self, guard: Guard, way: Way, call: CheckedCall, *, confirmed: bool) -> None:
        self._guard, self._way, self._call = guard, way, call
        self._confirmed = confirmed
        self._policy: Policy | None = None

    def begin(self) -> None:
        """Raise `Denied` if it may not begin."""
        self._policy = self._guard.look()
        self._ask()

    def go_on(self) -> None:
        """Raise `Denied` if another policy is in force now, and forbids it."""
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
