"""The policy for operators: in plain words, and as the component `policy` of the status."""

import difflib
from collections.abc import Callable, Collection, Iterator, Mapping

from edgevox.agent.policy.guard import Guard
from edgevox.agent.policy.limits import Places, PolicyContext, PolicyLimits, Speed
from edgevox.agent.policy.policy import ANY, NOWHERE, VELOCITY, PolicyFile, Rule
from edgevox.agent.text.same_name import name_form, names_meant
from edgevox.core.commands import Way
from edgevox.core.errors import shorten
from edgevox.core.status import ComponentName, Finding, HealthCheck, Level, Status

_DONE = {Rule.ALLOW: "is done", Rule.CONFIRM: "is done after a yes", Rule.DENY: "is refused"}


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
    return {name for one in (way.value, ANY) for name in file.of_way(one)} - {ANY}


def _exceptions(rules: Mapping[str, Rule], way: Way) -> Iterator[str]:
    for rule in Rule:
        skills = [skill for skill, one in rules.items() if one is rule]
        if skills:
            yield f"{', '.join(skills)} {_done(rule, way)}"


def _done(rule: Rule, way: Way) -> str:
    if rule is Rule.CONFIRM and not way.attended:
        return "is refused (confirm, and nobody can be asked)"
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


def _no_such(kind: str, name: str, known: Collection[str]) -> str:
    """The finding about an unknown name, with the most similar known one."""
    forms = {name_form(one): one for one in known}
    near = difflib.get_close_matches(name_form(name), forms, n=1, cutoff=_NEAR)
    ask = f"; did you mean {forms[near[0]]}?" if near else ""
    return f"{shorten(name)[1:-1]}: no such {kind}{ask}"
