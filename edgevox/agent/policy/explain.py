"""The explanation of a policy in plain words: a line for each way in, and for each limit."""

from collections.abc import Iterator, Mapping

from edgevox.agent.policy.file import ANY, PolicyFile, Rule
from edgevox.agent.policy.limits import Places, PolicyLimits, Speed
from edgevox.agent.policy.policy import VELOCITY
from edgevox.core.commands import Way

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
