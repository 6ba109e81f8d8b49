"""One folder with all that a robot is made of: each file in it is the value of a variable."""

import difflib
from collections.abc import Callable, Mapping
from pathlib import Path

from edgevox.core.errors import InvalidValue

FOLDER = "EDGEVOX_ROBOT_FOLDER"
NAMES: Mapping[str, str] = {
    "robot.yaml": "EDGEVOX_ROBOT_FILE",
    "world.yaml": "EDGEVOX_WORLD",
    "places.yaml": "EDGEVOX_LOCATIONS",
    "policy.yaml": "EDGEVOX_POLICY",
    "plugins": "EDGEVOX_PLUGINS",
}
"""What may lie in it, and the variable that names it elsewhere."""
AGENTS_OF: Mapping[str, str] = {"robot.yaml": "robot-external", "world.yaml": "robot-apartment"}
"""Which robot it is if nobody says so: the first file that is there says it."""
MOUNTED = Path("/plugins")
"""Plug-ins that are mounted, or part of a derived image: ours has no such folder."""
ALSO = ("scenarios", "README.md")


def from_folder(environment: Mapping[str, str], warn: Callable[[str], None]) -> dict[str, str]:
    """The variables that the folder gives, and `/plugins` where it is there.

    A variable that is set counts more. Raises `InvalidValue` if what `EDGEVOX_ROBOT_FOLDER` names
    is none. A name in it that nobody reads and that is like one that is read goes to `warn`.
    """
    given = environment.get(FOLDER)
    mounted = {NAMES["plugins"]: str(MOUNTED)} if MOUNTED.is_dir() else {}
    return _not_set(mounted | (_values(given, warn) if given else {}), environment)


def _not_set(values: Mapping[str, str], environment: Mapping[str, str]) -> dict[str, str]:
    return {name: value for name, value in values.items() if not environment.get(name)}


def _values(given: str, warn: Callable[[str], None]) -> dict[str, str]:
    folder = Path(given)
    if not folder.is_dir():
        raise InvalidValue(FOLDER, given, "a folder in the container")
    there = sorted(one.name for one in folder.iterdir())
    for name in there:
        if name not in NAMES and name not in ALSO:
            _warn_of(name, warn)
    values = {NAMES[name]: str(folder / name) for name in NAMES if name in there}
    agent = next((AGENTS_OF[name] for name in AGENTS_OF if name in there), None)
    if agent:
        values["EDGEVOX_AGENT"] = agent
    return values


def _warn_of(name: str, warn: Callable[[str], None]) -> None:
    (close, *_) = difflib.get_close_matches(name, [*NAMES, *ALSO], 1) or [""]
    if close:
        warn(f"{FOLDER}: nothing reads {name}; did you mean {close}?")
