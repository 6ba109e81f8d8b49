"""Interface packages of robots, built for tests where no ROS 2 has them.

`interfaces/`, and each example of a robot file that has a stand-in, has a folder for each package:
the definitions that are used, with the names and the types of the real ones' fields.
"""

import fcntl
import os
from collections.abc import Iterable
from pathlib import Path

from edgevox.ros2.interface_packages import Builder, packages_in

HERE = Path(__file__).parent
SOURCES = [HERE / "interfaces", *HERE.parents[1].glob("examples/robot_file/*/")]


def build_overlay(packages: Iterable[str], cache: Path) -> list[Path]:
    """Where these packages are, each a prefix of its own; built, unless that was done before."""
    return [_built(name, cache) for name in packages]


def overlaid(prefixes: Iterable[Path]) -> dict[str, str]:
    """The variables of a process that has sourced these."""
    places = list(prefixes)
    return {
        "AMENT_PREFIX_PATH": _path("AMENT_PREFIX_PATH", places),
        "LD_LIBRARY_PATH": _path("LD_LIBRARY_PATH", [one / "lib" for one in places]),
        "PYTHONPATH": _path("PYTHONPATH", map(python_packages, places)),
    }


def python_packages(prefix: Path) -> Path:
    (found,) = prefix.glob("lib/python3*/site-packages")
    return found


def _path(variable: str, first: Iterable[Path]) -> str:
    return os.pathsep.join([*map(str, first), *filter(None, [os.environ.get(variable)])])


def _built(name: str, cache: Path) -> Path:
    prefix = cache / name
    # Workers of pytest-xdist share the cache.
    with (cache / f"{name}.lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        (source,) = filter(Path.is_dir, (one / name for one in SOURCES))
        Builder(prefix, print).build(packages_in(source))
    return prefix
