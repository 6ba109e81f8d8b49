"""The guard, which every request passes: the policy in force, and the count of refusals.

`WatchedFile` reads a policy file again when it has changed. The file's name decides: a file that is
written in place, replaced, or reached by a swapped link counts as changed; Kubernetes swaps the
link of a ConfigMap's folder. `explain` puts a policy into words, and
`PolicyComponent` is its status.
"""

import difflib
import json
import threading
from collections import Counter
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from datetime import datetime
from pathlib import Path
from typing import Any

from edgevox.agent.policy.limits import Places, PolicyContext, PolicyLimits, Speed
from edgevox.agent.policy.policy import (
    ANY,
    NOWHERE,
    VELOCITY,
    Denied,
    NeedsConfirmation,
    Policy,
    PolicyFile,
    Rule,
    load_policy,
    local_time,
)
from edgevox.agent.skills import Skill
from edgevox.agent.text.same_name import name_form, names_meant
from edgevox.core.agent_events import GoalRejected
from edgevox.core.bus import Bus
from edgevox.core.clock import Clock, SystemClock
from edgevox.core.commands import Way
from edgevox.core.errors import InvalidValue, shorten
from edgevox.core.log import get_logger
from edgevox.core.status import ComponentName, Finding, HealthCheck, Level, Status

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

        Otherwise raise `NeedsConfirmation`, by the strictest rule, if one needs a yes or a
        countdown and they are not `confirmed`. A caller that cannot ask must pass that exception
        to `refuse`.
        """
        unsure: NeedsConfirmation | None = None
        for one in calls:
            try:
                self.judge(way, one)
            except NeedsConfirmation as found:
                unsure = found if unsure is None or found.rule is Rule.CONFIRM else unsure
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
        if verdict.rule is not Rule.ALLOW:
            raise NeedsConfirmation(verdict.rule, verdict.reason, way, call.skill, call.arguments)

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


_DONE = {
    Rule.ALLOW: "is done",
    Rule.COUNTDOWN: "is said, and done a second later unless told no",
    Rule.CONFIRM: "is done after a yes",
    Rule.DENY: "is refused",
}


def explain(file: PolicyFile) -> list[str]:
    """The lines about a policy. Nothing else is limited, and stopping is always permitted."""
    return [*(_way(file, way) for way in Way), *_limits(file.limits)]


def _way(file: PolicyFile, way: Way) -> str:
    if way is Way.CMD_VEL:
        return f"{way}: {_done(file.rule(way, VELOCITY), way)}"
    rest = file.rule(way, ANY)
    named = {skill: file.rule(way, skill) for skill in sorted(_skills(file, way))}
    others = {skill: rule for skill, rule in named.items() if rule is not rest}
    but = "; ".join(_exceptions(others, way))
    return f"{way}: every skill {_done(rest, way)}{', but ' if but else ''}{but}"


def _skills(file: PolicyFile, way: Way) -> set[str]:
    """Names of the skills in the entries for this way."""
    ways = (way, Way.VOICE, ANY) if way is Way.VOICE_GUEST else (way, ANY)
    return {name for one in ways for name in file.of_way(one)} - {ANY}


def _exceptions(rules: Mapping[str, Rule], way: Way) -> Iterator[str]:
    for rule in Rule:
        skills = [skill for skill, one in rules.items() if one is rule]
        if skills:
            yield f"{', '.join(skills)} {_done(rule, way)}"


def _done(rule: Rule, way: Way) -> str:
    if rule in (Rule.COUNTDOWN, Rule.CONFIRM) and not way.attended:
        return f"is refused ({rule}, and nobody can be asked)"
    return _DONE[rule]


def _limits(limits: PolicyLimits) -> Iterator[str]:
    if limits.places:
        yield f"places: {_places(limits.places)}"
    if limits.distance_m:
        yield f"distance: at most {limits.distance_m:g} m at a time"
    if limits.speed:
        yield f"speed of drives and cmd_vel: {_speed(limits.speed)}; what is faster is slowed"
    if limits.goals:
        yield f"goals of drives, {limits.goals.frame} frame, metres: {limits.goals}"
    if limits.hand:
        yield f"points for the hand, {limits.hand.frame} frame, metres: {limits.hand}"
    if limits.hours:
        yield f"hours, local time: {', '.join(map(str, limits.hours))}"


def _places(places: Places) -> str:
    words = (("only", places.only), ("never", places.never))
    return "; ".join(f"{word} {', '.join(names)}" for word, names in words if names)


def _speed(speed: Speed) -> str:
    both = ((speed.linear_m_s, "m/s"), (speed.angular_rad_s, "rad/s"))
    return ", ".join(f"at most {most:g} {unit}" for most, unit in both if most)


_NEAR = 0.6
"""Least similarity, from 0 to 1, of a known name to be suggested for an unknown one."""
NO_FILE = "no file: only the robot's own limits"


class PolicyComponent:
    """The policy in the status.

    A file that cannot be read is a warning, because the old policy stays in force. Unknown names
    are a warning, because they have no effect. Refusals are normal. `skills` returns all names that
    a rule may have on this robot.
    """

    name = ComponentName.POLICY
    checks: tuple[HealthCheck, ...] = ()

    def __init__(self, guard: Guard, skills: Callable[[], Collection[str]]) -> None:
        self._guard, self._skills = guard, skills

    def status(self) -> Status:
        """The status now; reads the file again if it has changed."""
        guard = self._guard
        file = guard.look().file
        found = []
        if guard.fault:
            text = f"the file cannot be used, the policy before it is in force: {guard.fault}"
            found.append(Finding(Level.WARN, text))
        if unknown := self._unknown():
            text = f"names that this robot does not know: {', '.join(unknown)}"
            found.append(Finding(Level.WARN, text))
        return Status.judged(
            self.name,
            found,
            well=(file.about or "in force") if guard.has_rules else NO_FILE,
            broken=bool(guard.fault),
            refused=sum(guard.refusals.values()),
            slowed=guard.slowed,
            last_refused=guard.last or None,
        )

    def _unknown(self) -> list[str]:
        return unknown_names(self._guard.policy.file, self._skills(), self._guard.around)


def unknown_names(
    file: PolicyFile, skills: Collection[str], around: PolicyContext = NOWHERE
) -> list[str]:
    """Skills and places of the file that this robot does not have, each with a near known name.

    A place is known by any of its names. A taught place is known only to `never`, because its name
    permits nothing.
    """
    forms = {name_form(one) for one in skills}
    found = [
        _no_such("skill", one, skills)
        for one in sorted(file.skills)
        if one not in skills and name_form(one) not in forms
    ]
    places, own = file.limits.places, around.places()
    if places is None or not own:
        return found
    taught = {one: one for one in around.taught()}
    return found + [
        _no_such("place", one, own)
        for one in sorted(places.names)
        if not around.place_meant(one)
        and not names_meant(one, {name: name for name in own})
        and not (one not in (places.only or ()) and names_meant(one, taught))
    ]


def asked_instead(file: PolicyFile, skills: Iterable[Skill]) -> list[str]:
    """A sentence for each skill of the file's countdowns that cannot be undone, so that it asks."""
    counted = {
        name
        for one in file.rules.values()
        for name, rule in one.items()
        if Rule(rule) is Rule.COUNTDOWN
    }
    return [
        f"{one.name}: cannot be undone, so that `countdown` asks for a yes"
        for one in skills
        if (one.drives or one.lasting)
        and not one.undoable
        and any(name_form(one.name) == name_form(n) for n in counted)
    ]


def _no_such(kind: str, name: str, known: Collection[str]) -> str:
    """The finding about an unknown name, with the most similar known one."""
    forms = {name_form(one): one for one in known}
    near = difflib.get_close_matches(name_form(name), forms, n=1, cutoff=_NEAR)
    ask = f"; did you mean {forms[near[0]]}?" if near else ""
    return f"{shorten(name)[1:-1]}: no such {kind}{ask}"
