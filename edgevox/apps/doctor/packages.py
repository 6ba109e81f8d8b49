"""The check of packages that bring robots and skills, plug-ins among them: do they load?"""

import json
from collections.abc import Callable, Iterator
from dataclasses import asdict
from importlib.metadata import EntryPoint
from typing import TypeVar

from edgevox.apps.doctor.check import (
    CheckVerdict,
    Facts,
    Situation,
    error,
    ok,
    probe_apart,
    skipped,
    warning,
)
from edgevox.apps.plugins import Plugins, bring_plugins
from edgevox.core.errors import InvalidValue
from edgevox.core.settings import check_settings
from edgevox.robots.plugin import fault_of_robot, foreign_robot_points
from edgevox.robots.skill_packages import chosen_skills, fault_of, installed_skills, left_out

T = TypeVar("T")

PROBE = "edgevox.apps.doctor.packages:look_for_packages"
_NEEDED = {"plugins", "skills"}
_CORRECT = "correct it: no agent starts with it"
_WITHOUT = "correct or remove it: an agent starts without it"


def probe_packages(situation: Situation) -> Facts:
    """List the packages; they are loaded in a separate process."""
    return probe_apart(PROBE, situation.settings.model_dump_json(include=_NEEDED))


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
