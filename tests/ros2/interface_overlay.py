"""Interface packages of robots, built for tests where no ROS 2 has them.

`interfaces/` has a folder for each package: the definitions that tests use, with the names and the
types of the real ones' fields. What a CMake package needs besides is the same for all.
"""

import fcntl
import hashlib
import importlib.util
import os
import shutil
import sys
import tempfile
from collections.abc import Iterable
from pathlib import Path
from types import ModuleType

from guards import run_program

HERE = Path(__file__).parent
SOURCES = HERE / "interfaces"
DEPENDENCIES = "builtin_interfaces geometry_msgs std_msgs trajectory_msgs"
CMAKE = """cmake_minimum_required(VERSION 3.20)
project({name})
find_package(ament_cmake REQUIRED)
find_package(rosidl_default_generators REQUIRED)
foreach(one {dependencies})
  find_package(${{one}} REQUIRED)
endforeach()
rosidl_generate_interfaces(${{PROJECT_NAME}} {files} DEPENDENCIES {dependencies})
ament_package()
"""
PACKAGE = """<package format="3"><name>{name}</name><version>0.0.0</version>
<description>Stands in for {name} in tests.</description>
<maintainer email="edgevox@users.noreply.github.com">EdgeVox contributors</maintainer>
<license>MIT</license><buildtool_depend>ament_cmake</buildtool_depend>
<buildtool_depend>rosidl_default_generators</buildtool_depend>{depends}
<exec_depend>rosidl_default_runtime</exec_depend>
<member_of_group>rosidl_interface_packages</member_of_group></package>
"""


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
    build_msgs = _build_msgs()
    digest = hashlib.sha256(f"{build_msgs.fingerprint()}{CMAKE}{PACKAGE}".encode())
    files = sorted(one for one in (SOURCES / name).rglob("*") if one.is_file())
    for file in files:
        digest.update(str(file.relative_to(SOURCES)).encode() + file.read_bytes())
    prefix = cache / f"{name}-{digest.hexdigest()[:16]}"
    # Workers of pytest-xdist share the cache; and a build that was cut off is none.
    with (cache / f"{name}.lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        if not (prefix / "done").exists():
            shutil.rmtree(prefix, ignore_errors=True)
            with tempfile.TemporaryDirectory() as place:
                _build(name, files, Path(place), prefix, build_msgs)
            (prefix / "done").touch()
    return prefix


def _build(name: str, files: list[Path], place: Path, prefix: Path, build_msgs: ModuleType) -> None:
    source = shutil.copytree(SOURCES / name, place / name)
    named = " ".join(str(one.relative_to(SOURCES / name)) for one in files)
    filled = {"name": name, "files": named, "dependencies": DEPENDENCIES}
    (source / "CMakeLists.txt").write_text(CMAKE.format(**filled))
    depends = "".join(f"<depend>{one}</depend>" for one in DEPENDENCIES.split())
    (source / "package.xml").write_text(PACKAGE.format(name=name, depends=depends))
    definitions = (
        f"-DCMAKE_INSTALL_PREFIX={prefix}",
        f"-DCMAKE_INSTALL_RPATH={prefix / 'lib'}",
        f"-DPython3_EXECUTABLE={sys.executable}",
        "-DBUILD_TESTING=OFF",
        "-Wno-dev",
        "-Wno-deprecated",
    )
    for command in (
        ["cmake", "-S", source, "-B", place / "build", "-G", "Ninja", *definitions],
        ["cmake", "--build", place / "build", "--target", "install"],
    ):
        done = run_program(command, env=build_msgs.environment())
        assert done.returncode == 0, done.stdout + done.stderr


def _build_msgs() -> ModuleType:
    """How scripts/build_msgs.py builds edgevox_msgs."""
    spec = importlib.util.spec_from_file_location(
        "build_msgs", HERE.parents[1] / "scripts" / "build_msgs.py"
    )
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module
