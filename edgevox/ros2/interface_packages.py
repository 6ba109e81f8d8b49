"""Builds packages of ROS 2 interfaces (.msg, .srv, .action, .idl) for the Python that runs this.

No colcon and no CMakeLists.txt are needed: a package is its definitions and its name. ROS 2 comes
from the Python index, or is sourced. scripts/build_msgs.py and docker/build_interfaces use this as
well, so it imports nothing of EdgeVox.
"""

import hashlib
import os
import re
import shutil
import subprocess
import sys
import sysconfig
import tempfile
from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import cached_property
from graphlib import CycleError, TopologicalSorter
from importlib import metadata
from pathlib import Path

_PYTHON = f"{sys.version_info.major}.{sys.version_info.minor}"
KINDS = ("msg", "srv", "action")
STAMP = "built-from"
"""The file of a built package, in its folder below share/, that says what it was built from."""
SETUP = "setup.bash"
GENERATORS = "rosidl_default_generators"
_NAME = re.compile(r"[a-z][a-z0-9_]*")
_TYPE = re.compile(r'^\s*(?:#include\s+")?([a-z][a-z0-9_]*)/(?:msg/)?[A-Z]', re.MULTILINE)
_CMAKE = """cmake_minimum_required(VERSION 3.20)
project({name})
find_package(ament_cmake REQUIRED)
find_package(rosidl_default_generators REQUIRED)
foreach(one {needs})
  find_package(${{one}} REQUIRED)
endforeach()
rosidl_generate_interfaces(${{PROJECT_NAME}} {files} DEPENDENCIES {needs})
ament_package()
"""
_XML = """<package format="3"><name>{name}</name><version>{version}</version>
<description>Interfaces of {name}, built by EdgeVox.</description>
<maintainer email="edgevox@users.noreply.github.com">EdgeVox</maintainer><license>unknown</license>
<buildtool_depend>ament_cmake</buildtool_depend>
<buildtool_depend>rosidl_default_generators</buildtool_depend>{needs}
<exec_depend>rosidl_default_runtime</exec_depend>
<member_of_group>rosidl_interface_packages</member_of_group></package>
"""
_SETUP = """# What is built here, for a shell: source it after ROS 2's setup.bash.
_here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
export AMENT_PREFIX_PATH="$_here${AMENT_PREFIX_PATH:+:$AMENT_PREFIX_PATH}"
export LD_LIBRARY_PATH="$_here/lib${LD_LIBRARY_PATH:+:$LD_LIBRARY_PATH}"
export PYTHONPATH="$_here/PACKAGES${PYTHONPATH:+:$PYTHONPATH}"
unset _here
"""
# Where the wheels of ROS 2 were built; their CMake files still look for headers there.
_BUILDERS_PYTHON = re.compile(r"/opt/python/cp\d+-cp\d+/include/python3\.\d+")
_BUILDERS_NUMPY = re.compile(
    r"/opt/python/cp\d+-cp\d+/lib/python3\.\d+/site-packages/numpy/_?core/include"
)
# Another environment's, or a sourced ROS 2's: none of it may leak into a build with wheels.
_FOREIGN = ("PYTHONPATH", "LD_LIBRARY_PATH", "_ROS_WHEELS_BOOTSTRAP_COMPLETE", "PYTHONHOME")


class BuildFailed(Exception):
    """Packages cannot be built; the text says why, and what would help."""


@dataclass(frozen=True)
class Package:
    """A package by its name, its version and its folder."""

    name: str
    version: str
    folder: Path

    @cached_property
    def files(self) -> Mapping[str, bytes]:
        """The definitions, by their paths below the folder."""
        found = {
            str(one.relative_to(self.folder)): one.read_bytes()
            for kind in KINDS
            for suffix in (kind, "idl")
            for one in sorted((self.folder / kind).glob(f"*.{suffix}"))
        }
        return dict(sorted(found.items()))

    @cached_property
    def needs(self) -> frozenset[str]:
        """The other packages whose types it has."""
        text = "\n".join(one.decode("utf-8", "replace") for one in self.files.values())
        return frozenset({*_TYPE.findall(text)} - {self.name})


def packages_in(folder: Path) -> list[Package]:
    """The packages in a folder, at any depth: what has a folder msg, srv or action with files.

    Raises `BuildFailed` for a package that has no usable name.
    """
    holders = {one.parent for kind in KINDS for one in folder.rglob(kind) if one.is_dir()}
    return [found for one in sorted(holders) if (found := _package(one)).files]


def _package(folder: Path) -> Package:
    about = folder / "package.xml"
    text = about.read_text(encoding="utf-8", errors="replace") if about.is_file() else ""
    name, version = (re.search(rf"<{one}>\s*(.*?)\s*</{one}>", text) for one in ("name", "version"))
    called = name[1] if name else folder.resolve().name
    if not _NAME.fullmatch(called):
        expected = "a package's name such as my_msgs: of the folder, or in its package.xml"
        raise BuildFailed(f"{folder}: expected {expected}, not {called!r}")
    return Package(called, version[1] if version else "0.0.0", folder)


class Builder:
    """Builds packages into `prefix`; `tell` is told what is done."""

    def __init__(self, prefix: Path, tell: Callable[[str], None]) -> None:
        self._prefix, self._tell = prefix.absolute(), tell
        own = Path(sys.prefix)
        self._wheels = (own / "share" / GENERATORS).is_dir()
        sourced = [Path(one) for one in os.environ.get("AMENT_PREFIX_PATH", "").split(os.pathsep)]
        self._bases = [own] if self._wheels else [one for one in sourced if one.is_absolute()]

    def build(self, packages: Sequence[Package]) -> None:
        """Build these, each after those that it needs. Raises `BuildFailed`."""
        self._check_tools()
        given: dict[str, Package] = {}
        for one in packages:
            if one.name in given and one.folder.resolve() != given[one.name].folder.resolve():
                raise BuildFailed(f"{one.name} is in {given[one.name].folder} and {one.folder}")
            given[one.name] = one
        for name in [one for one in given if self._is_of_others(one)]:
            self._tell(f"{name} is already there")
            del given[name]
        self._check_needs(given.values())
        order = {name: one.needs & given.keys() for name, one in given.items()}
        try:
            names = list(TopologicalSorter(order).static_order())
        except CycleError as error:
            raise BuildFailed(f"packages need each other: {', '.join(error.args[1])}") from error
        if self._wheels and names:
            patch_cmake_files(Path(sys.prefix))
        prints: dict[str, str] = {}
        for name in names:
            prints[name] = _fingerprint(given[name], (prints[one] for one in sorted(order[name])))
            self._build_one(given[name], prints[name])
        if names and self._prefix != Path(sys.prefix):
            self._write_setup()

    def _check_tools(self) -> None:
        if not self._wheels and not any(
            (one / "share" / GENERATORS).is_dir() for one in self._bases
        ):
            raise BuildFailed(
                f"ROS 2's {GENERATORS} are not here: install requirements/build.lock, or source "
                "ROS 2's setup.bash"
            )
        missing = [one for one in ("cmake", "ninja", "c++") if not self._program(one)]
        if missing:
            raise BuildFailed(f"expected {', '.join(missing)}: apt install cmake ninja-build g++")

    def _is_of_others(self, name: str) -> bool:
        """Whether a package is there that was not built by this."""
        there = [one / "share" / name for one in (self._prefix, *self._bases)]
        return any((one / "cmake").is_dir() and not (one / STAMP).exists() for one in there)

    def _check_needs(self, given: Iterable[Package]) -> None:
        packages = list(given)
        there = {one.name for one in packages}
        places = [one / "share" for one in (self._prefix, *self._bases)]
        lacking = {
            one.name: sorted(
                need
                for need in one.needs - there
                if not any((place / need / "cmake").is_dir() for place in places)
            )
            for one in packages
        }
        told = [f"{name} needs {', '.join(needs)}" for name, needs in lacking.items() if needs]
        if told:
            raise BuildFailed(f"{'; '.join(told)}: give the folders of these packages as well")

    def _build_one(self, package: Package, fingerprint: str) -> None:
        stamp = self._prefix / "share" / package.name / STAMP
        if stamp.is_file() and stamp.read_text(encoding="utf-8") == fingerprint:
            self._tell(f"{package.name} is up to date")
            return
        self._tell(f"building {package.name}")
        with tempfile.TemporaryDirectory(prefix="edgevox-interfaces-") as place:
            source, build = Path(place) / package.name, Path(place) / "build"
            _write_source(package, source)
            definitions = (
                f"-DCMAKE_INSTALL_PREFIX={self._prefix}",
                f"-DCMAKE_INSTALL_RPATH={self._prefix / 'lib'}",
                f"-DPython3_EXECUTABLE={sys.executable}",
                # Debian's Python would have them below local/, where no PYTHONPATH of ROS 2 looks.
                f"-DPYTHON_INSTALL_DIR=lib/python{_PYTHON}/site-packages",
                "-DBUILD_TESTING=OFF",
                "-Wno-dev",
                "-Wno-deprecated",
            )
            self._run(["cmake", "-S", source, "-B", build, "-G", "Ninja", *definitions])
            self._run(["cmake", "--build", build, "--target", "install"])
        stamp.write_text(fingerprint, encoding="utf-8")
        self._tell(f"built {package.name}: {', '.join(map(_type_of, package.files))}")

    def _program(self, name: str) -> str | None:
        return shutil.which(name, path=self._environment["PATH"])

    @cached_property
    def _environment(self) -> dict[str, str]:
        """The variables of a build that sees ROS 2 of one place only."""
        foreign = _FOREIGN if self._wheels else ()
        kept = {key: value for key, value in os.environ.items() if key not in foreign}
        prefixes = os.pathsep.join(map(str, dict.fromkeys((self._prefix, *self._bases))))
        scripts = sysconfig.get_path("scripts")
        return {
            **kept,
            "AMENT_PREFIX_PATH": prefixes,
            "CMAKE_PREFIX_PATH": prefixes,
            "PATH": f"{scripts}{os.pathsep}{kept.get('PATH', os.defpath)}",
        }

    def _run(self, command: Sequence[str | Path]) -> None:
        program = self._program(str(command[0])) or command[0]
        done = subprocess.run(
            [program, *command[1:]],
            env=self._environment,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            encoding="utf-8",
            errors="replace",
            check=False,
        )
        if done.returncode != 0:
            raise BuildFailed(f"{done.stdout}\n{' '.join(map(str, command))} failed, see above")

    def _write_setup(self) -> None:
        packages = sorted(self._prefix.glob("lib/python3*/site-packages"))
        where = packages[0].relative_to(self._prefix) if packages else Path("lib")
        (self._prefix / SETUP).write_text(_SETUP.replace("PACKAGES", str(where)), encoding="utf-8")


def _type_of(file: str) -> str:
    return Path(file).stem


def _write_source(package: Package, source: Path) -> None:
    """The package as CMake builds it: of its own files only the definitions are used."""
    for name, content in package.files.items():
        (source / name).parent.mkdir(parents=True, exist_ok=True)
        (source / name).write_bytes(content)
    needs = sorted(package.needs)
    cmake = _CMAKE.format(
        name=package.name, files=" ".join(map('"{}"'.format, package.files)), needs=" ".join(needs)
    )
    (source / "CMakeLists.txt").write_text(cmake, encoding="utf-8")
    depends = "".join(f"<depend>{one}</depend>" for one in needs)
    xml = _XML.format(name=package.name, version=package.version, needs=depends)
    (source / "package.xml").write_text(xml, encoding="utf-8")


def _fingerprint(package: Package, needed: Iterable[str]) -> str:
    """All that a built package depends on, as one hash."""
    digest = hashlib.sha256(f"{sys.version}{_CMAKE}{_XML}{package.version}".encode())
    for name in ("ros-rosidl-generator-py", "ros-rclpy", "numpy"):
        with suppress(metadata.PackageNotFoundError):
            digest.update(f"{name} {metadata.version(name)}".encode())
    for name, content in package.files.items():
        digest.update(name.encode() + content)
    for one in needed:
        digest.update(one.encode())
    return digest.hexdigest()


def patch_cmake_files(prefix: Path) -> None:
    """Point the CMake files of ROS 2's wheels to this machine's headers of Python and numpy."""
    import numpy as np

    python = sysconfig.get_path("include")
    for path in (prefix / "share").glob("*/cmake/*.cmake"):
        old = path.read_text(encoding="utf-8")
        new = _BUILDERS_NUMPY.sub(np.get_include(), _BUILDERS_PYTHON.sub(python, old))
        if new != old:
            path.write_text(new, encoding="utf-8")
