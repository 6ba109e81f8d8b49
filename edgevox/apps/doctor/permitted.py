"""What the policy permits, line by line, and whether its file can be read."""

from pathlib import Path

from edgevox.agent.policy.explain import explain
from edgevox.agent.policy.format import PolicyFile, read_policy_file
from edgevox.agent.policy.policy import local_time
from edgevox.agent.policy.policy_status import NO_FILE, unknown_names
from edgevox.apps.doctor.check import CheckVerdict, Facts, Situation, error, ok, warning
from edgevox.apps.policy_setup import known_names, policy_context
from edgevox.apps.robots import ROBOTS, build_body
from edgevox.core.errors import EdgeVoxError, InvalidValue
from edgevox.core.settings import Settings
from edgevox.ros2.robot_file.load import load_robot_file

_IN_THE_HAND = 0.0
"""A speed of the world: nothing moves in it."""


def probe_policy(situation: Situation) -> Facts:
    """The policy in words, or why it cannot be read."""
    try:
        policy = _policy_of(situation.settings)
    except InvalidValue as wrong:
        return {"lines": None, "wrong": str(wrong)}
    if policy is None:
        return {"lines": None}
    closed = str(policy.limits.closed(local_time()))
    return {
        "lines": explain(policy),
        "unknown": _unknown(policy, situation),
        "now": f"{local_time():%a %H:%M %Z}" if policy.limits.hours else "",
        "closed": closed,
    }


def _unknown(policy: PolicyFile, situation: Situation) -> list[str]:
    """What the robot has not; without one only the skills are looked at, of all robots."""
    if situation.agent not in ROBOTS:
        return unknown_names(policy, known_names(()))
    try:
        body = build_body(situation.agent, situation.settings, _IN_THE_HAND)
    except EdgeVoxError:  # what is wrong with it is said elsewhere
        return unknown_names(policy, known_names(()))
    return unknown_names(policy, known_names(body.skills), policy_context(body))


def _policy_of(settings: Settings) -> PolicyFile | None:
    """What the setting names, else what the robot file says of it."""
    if settings.policy:
        return read_policy_file(settings.policy)
    own = load_robot_file(settings.robot_file).policy if settings.robot_file else None
    return read_policy_file(own) if isinstance(own, Path) else own.file if own else None


def judge_policy(facts: Facts, _: Situation) -> CheckVerdict | list[CheckVerdict]:
    """A broken file is an error: an agent does not start with it."""
    if wrong := facts.get("wrong"):
        return error(wrong, "correct it: with it no agent starts, and one that runs keeps the old")
    if facts["lines"] is None:
        return ok(f"{NO_FILE}, by every way in")
    said = [ok(line) for line in facts["lines"]]
    if facts["now"]:
        said.append(ok(f"it is {facts['now']}: it may {'not ' if facts['closed'] else ''}move"))
    said += [
        warning(one, "correct it, unless a robot of your own has it") for one in facts["unknown"]
    ]
    return said
