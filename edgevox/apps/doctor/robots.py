"""The checks of robots: their packages, the policy, and a robot file's interfaces on the graph."""

import json
from collections.abc import Callable, Iterator
from dataclasses import asdict
from importlib.metadata import EntryPoint
from pathlib import Path
from typing import TypeVar

from edgevox.agent.policy.guard import NO_FILE, asked_instead, explain, unknown_names
from edgevox.agent.policy.policy import PolicyFile, local_time, read_policy_file
from edgevox.apps.agent.policy import known_names, policy_context
from edgevox.apps.doctor.check import CheckVerdict, Facts, Situation, error, ok, skipped, warning
from edgevox.apps.doctor.ros import NOT_WITH_SECURITY, is_secured
from edgevox.apps.plugins import Plugins, bring_plugins
from edgevox.apps.robots import ROBOTS, build_body
from edgevox.core.errors import EdgeVoxError, InvalidValue
from edgevox.core.probe import probe_apart
from edgevox.core.settings import Settings, check_settings
from edgevox.robots.plugin import fault_of_robot, foreign_robot_points
from edgevox.robots.skill_packages import chosen_skills, fault_of, installed_skills, left_out
from edgevox.ros2.robot_file.load import load_robot_file

T = TypeVar("T")

PACKAGES_PROBE = "edgevox.apps.doctor.robots:look_for_packages"
_PACKAGES_NEED = {"plugins", "skills"}
_CORRECT = "correct it: no agent starts with it"
_WITHOUT = "correct or remove it: an agent starts without it"


def probe_packages(situation: Situation) -> Facts:
    """List the packages; they are loaded in a separate process."""
    return probe_apart(PACKAGES_PROBE, situation.settings.model_dump_json(include=_PACKAGES_NEED))


def look_for_packages(settings: str) -> Facts:
    """Load what is there for these settings, as JSON. Into this process, which should end then."""
    asked = check_settings(json.loads(settings))
    found, wrong_folder = _tried(lambda: bring_plugins(asked.plugins))
    named, wrong_name = _tried(lambda: chosen_skills(asked.skills, installed_skills()))
    plugins, chosen = found or Plugins(), named or ()
    used = {point.name for point in chosen}
    return {
        "wrong": [*wrong_folder, *wrong_name],
        "plugins": [asdict(one) for one in plugins.loaded],
        "broken": dict(plugins.broken),
        "robots": [_about(one, fault_of_robot(one)) for one in foreign_robot_points()],
        "skills": [
            _about(one, fault_of(one)) | {"used": one.name in used}
            for one in installed_skills().values()
        ],
        "left_out": [list(one) for one in left_out(chosen)],
    }


def _tried(look: Callable[[], T]) -> tuple[T | None, list[str]]:
    """Return the result, or the reason of its failure."""
    try:
        return look(), []
    except InvalidValue as wrong:
        return None, [str(wrong)]


def _about(point: EntryPoint, fault: str) -> dict[str, object]:
    package = point.dist.name if point.dist else point.value
    return {"name": point.name, "package": package, "fault": fault}


def judge_packages(facts: Facts, _: Situation) -> list[CheckVerdict]:
    """Judge the packages: a wanted one that does not load is an error."""
    said = [
        *(error(one, _CORRECT) for one in facts["wrong"]),
        *(ok(f"plug-in {one['file']}: {one['name']} {one['version']}") for one in facts["plugins"]),
        *(error(f"plug-in {file}: {why}", _WITHOUT) for file, why in facts["broken"].items()),
        *(_judge_robot(one) for one in facts["robots"]),
        *(_judge_skills(one) for one in facts["skills"]),
        *_judge_left_out(facts["left_out"]),
    ]
    return said or [skipped("no plug-in, and no package that brings robots or skills")]


def _judge_robot(one: Facts) -> CheckVerdict:
    found = f"robot {one['name']}, of {one['package']}"
    return error(f"{found}: {one['fault']}", _WITHOUT) if one["fault"] else ok(found)


def _judge_skills(one: Facts) -> CheckVerdict:
    found = f"skills of {one['name']}, of {one['package']}"
    if not one["used"]:
        return skipped(found, f"to use them, add {one['name']} to --skills")
    return error(f"{found}: {one['fault']}", _WITHOUT) if one["fault"] else ok(found)


def _judge_left_out(found: list[list[str]]) -> Iterator[CheckVerdict]:
    for name, used, package in found:
        said = f"skills of {name}, of {package}, are left out: {used} also has that name"
        yield warning(said, "uninstall one of the two packages")


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
    """List the policy's unknown names for this robot; without a robot, only unknown skills."""
    if situation.agent not in ROBOTS:
        return unknown_names(policy, known_names(()))
    try:
        body = build_body(situation.agent, situation.settings, _IN_THE_HAND)
    except EdgeVoxError:  # what is wrong with it is said elsewhere
        return unknown_names(policy, known_names(()))
    strange = unknown_names(policy, known_names(body.skills), policy_context(body))
    return strange + asked_instead(policy, body.skills)


def _policy_of(settings: Settings) -> PolicyFile | None:
    """Return the setting's policy, else the robot file's."""
    if settings.policy:
        return read_policy_file(settings.policy)
    own = load_robot_file(settings.robot_file).policy if settings.robot_file else None
    return read_policy_file(own) if isinstance(own, Path) else own.file if own else None


def judge_policy(facts: Facts, _: Situation) -> CheckVerdict | list[CheckVerdict]:
    """A broken file is an error: an agent does not start with it."""
    if wrong := facts.get("wrong"):
        return error(wrong, "correct it: no agent starts with it; a running one keeps the old")
    if facts["lines"] is None:
        return ok(f"{NO_FILE}, by every way in")
    said = [ok(line) for line in facts["lines"]]
    if facts["now"]:
        said.append(ok(f"it is {facts['now']}: it may {'not ' if facts['closed'] else ''}move"))
    said += [
        warning(one, "correct it, unless a robot of your own has it") for one in facts["unknown"]
    ]
    return said


PROBE = "edgevox.ros2.robot_file.graph:look_for_robot"
_NEEDED = {"robot_file", "robot_namespace"}


def probe_robot_file(situation: Situation) -> Facts:
    """Look on the graph for the robot that a file or its namespace names."""
    settings = situation.settings
    if not _NEEDED & settings.model_fields_set:
        return {"given": False}
    if is_secured(situation.environment):
        return {"given": True, "secured": True}
    return {"given": True, **probe_apart(PROBE, _as_json(settings))}


def _as_json(settings: Settings) -> str:
    """Return the settings that the probe needs and that were given: they overrule the file."""
    return settings.model_dump_json(include=_NEEDED & settings.model_fields_set)


def judge_robot_file(facts: Facts, situation: Situation) -> list[CheckVerdict]:
    """Judge the graph: another type is an error; a missing interface may only be switched off."""
    if not facts["given"]:
        advice = "--robot-file FILE or --robot-namespace NAMESPACE looks for your robot"
        return [skipped("no robot file", advice)]
    if facts.get("secured"):
        return [skipped(NOT_WITH_SECURITY)]
    if facts["wrong"]:
        return [error(one, "correct it: no agent starts with it") for one in facts["wrong"]]
    off = {name: warning(f"{name} is off: {why}") for name, why in facts["off"]}
    found = [one for one in facts["found"] if one["whose"] not in off]
    if found and not any(one["types"] for one in found):
        return [*off.values(), _nothing_there(facts, len(found), situation)]
    by_owner: dict[str, list[Facts]] = {}
    for one in found:
        by_owner.setdefault(one["whose"], []).append(one)
    judged = [verdict for owner in by_owner.items() for verdict in _judge_owner(*owner)]
    return [*off.values(), *judged] or [ok("it names no interface")]


def _nothing_there(facts: Facts, wanted: int, situation: Situation) -> CheckVerdict:
    domain = situation.environment.get("ROS_DOMAIN_ID", "0")
    said = f"nothing of the robot is there; other nodes on domain {domain}: {facts['others']}"
    for namespace, count in facts["elsewhere"]:
        return warning(said, f"namespace: {namespace}, where {count} of {wanted} are")
    advice = "switch the robot on; give both the same ROS_DOMAIN_ID and let discovery reach it"
    return warning(said, advice)


def _judge_owner(owner: str, found: list[Facts]) -> Iterator[CheckVerdict]:
    """Yield one verdict if all is well; else one for each fault."""
    faults = [verdict for one in found if (verdict := _fault(owner, one))]
    yield from faults
    if not faults:
        yield ok(f"{owner}: " + ", ".join(f"{one['role']} {one['name']}" for one in found))


def _fault(owner: str, one: Facts) -> CheckVerdict | None:
    what = f"{owner}: {one['role']} {one['name']}"
    if not one["types"]:
        return warning(f"{what} is not there", _advice(one))
    if not one["fits"]:
        there = ", ".join(one["types"])
        advice = "its node has to change" if one["contract"] else f"type: {there}"
        return error(f"{what} has the type {there}, and not {one['type']}", advice)
    if one["unfit"]:
        latched = one["latched"]
        advice = "its node has to change" if latched is None else f"latched: {str(latched).lower()}"
        return error(f"{what} does not fit in quality of service: {one['unfit']}", advice)
    return None


def _advice(one: Facts) -> str:
    if one["instead"]:
        return f"{one['name']} is there as {' and '.join(one['instead'])}"
    if one["near"]:
        return f"there is {_list(one['near'])}"
    return "start the node that offers it"


def _list(near: list[list[str]]) -> str:
    return ", ".join(f"{name} ({types})" for name, types in near)
