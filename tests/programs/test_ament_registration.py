"""`ros2 launch` and `ros2 run` find EdgeVox where pip or colcon put it."""

import ast
import os
import re
import shutil
import subprocess
import sys
import sysconfig
import tomllib
import venv
import zipfile
from pathlib import Path

import pytest
from ament_index_python.packages import get_package_prefix, get_package_share_directory
from catkin_pkg.package import Package, parse_package
from guards import HUNG_S, run_program
from packaging.version import Version

import edgevox
from edgevox.core.version import DECLARED

ROOT = Path(__file__).resolve().parent.parent.parent
SCRIPT = ROOT / "ament" / "lib" / "edgevox-agent"
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
LAUNCH_FILES = {file.name for file in (ROOT / "launch").glob("*.launch.py")}
FOREIGN = {
    "LD_LIBRARY_PATH": "/opt/other/lib",
    "PYTHONPATH": "/opt/other/python",
    "_ROS_WHEELS_BOOTSTRAP_COMPLETE": "1",
}


def build(kind: str, place: Path) -> Path:
    """A wheel of this repository, standard or editable."""
    command = [sys.executable, "-m", "hatchling", "build", "-t", f"wheel:{kind}", "-d", place]
    subprocess.run(command, cwd=ROOT, check=True, capture_output=True, timeout=HUNG_S)
    (wheel,) = place.glob("*.whl")
    return wheel


def shared(wheel: Path) -> dict[str, bytes]:
    """What a wheel puts into the prefix beside its Python modules."""
    with zipfile.ZipFile(wheel) as archive:
        return {
            name.partition(".data/data/")[2]: archive.read(name)
            for name in archive.namelist()
            if ".data/data/" in name
        }


@pytest.fixture(scope="module")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return build("standard", tmp_path_factory.mktemp("wheel"))


@pytest.fixture(scope="module")
def prefix(wheel: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A virtual environment of its own that the wheel is installed to."""
    place = tmp_path_factory.mktemp("prefix")
    venv.create(place)
    pip = (sys.executable, "-m", "pip", "--python", place / "bin" / "python", "install")
    options = ("--no-deps", "--no-index", "--no-compile", "--disable-pip-version-check", "-q")
    subprocess.run([*pip, *options, wheel], check=True, capture_output=True, timeout=HUNG_S)
    return place


@pytest.fixture
def package() -> Package:
    return parse_package(str(ROOT / "ament" / "package.xml"))


def test_the_installed_package_is_in_the_ament_index(
    prefix: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("AMENT_PREFIX_PATH", str(prefix))
    assert get_package_prefix("edgevox") == str(prefix)
    share = Path(get_package_share_directory("edgevox"))
    assert {file.name for file in (share / "launch").iterdir()} == LAUNCH_FILES
    assert (share / "package.xml").is_file()


def test_the_installed_package_has_the_robots_that_it_declares(prefix: Path) -> None:
    (packages,) = prefix.glob("lib/python*/site-packages")
    environment = {**os.environ, "PYTHONPATH": f"{packages}:{sysconfig.get_path('purelib')}"}
    command = [prefix / "lib" / "edgevox" / "edgevox-agent", "robot-of-nobody"]
    done = subprocess.run(command, env=environment, capture_output=True, text=True, timeout=HUNG_S)
    robots = PROJECT["entry-points"]["edgevox.robots"]
    assert done.returncode == 2
    assert f"(choose from {', '.join(map(repr, robots))})" in done.stderr


@pytest.mark.long
def test_every_program_can_be_run_from_the_installed_package(prefix: Path) -> None:
    found = {f.name for f in (prefix / "lib" / "edgevox").iterdir() if os.access(f, os.X_OK)}
    assert found == set(PROJECT["scripts"])
    for name in found:
        command = [prefix / "lib" / "edgevox" / name, "--help"]
        environment = {**os.environ, "PYTHONPATH": sysconfig.get_path("purelib")}  # what it needs
        done = run_program(command, env=environment)
        assert f"usage: {name}" in done.stdout, done.stderr


def test_an_editable_install_registers_the_same_files(wheel: Path, tmp_path: Path) -> None:
    files = shared(wheel)
    assert "share/ament_index/resource_index/packages/edgevox" in files
    assert shared(build("editable", tmp_path)) == files


def test_this_environment_is_registered_as_the_wheel_would(wheel: Path) -> None:
    for name, content in shared(wheel).items():
        assert (Path(sys.prefix) / name).read_bytes() == content, f"{name} is old: run make"


def test_the_package_has_the_python_packages_name_and_the_version_of_the_last_release(
    package: Package,
) -> None:
    assert package.name == edgevox.__name__
    changes = (ROOT / "CHANGELOG.md").read_text(encoding="utf-8")
    (released, *_) = re.findall(r"^## (\d\S*)", changes, re.MULTILINE)
    assert package.version == released
    assert Version(DECLARED) >= Version(released)
    assert package.licenses == [PROJECT["license"]]


def test_the_package_declares_every_ros_package_that_is_imported(package: Package) -> None:
    imported = set()
    for file in (*(ROOT / "edgevox" / "ros2").rglob("*.py"), *(ROOT / "launch").glob("*.py")):
        for node in ast.walk(ast.parse(file.read_text())):
            if isinstance(node, ast.ImportFrom) and node.module:
                imported.add(node.module.partition(".")[0])
            elif isinstance(node, ast.Import):
                imported.update(alias.name.partition(".")[0] for alias in node.names)
    here = Path(sys.prefix) / "share"
    needed = {name for name in imported if (here / name / "package.xml").is_file()}
    needed |= imported & {"launch", "launch_ros"}  # no wheel brings them
    assert "rclpy" in needed
    assert needed - {"edgevox"} <= {depend.name for depend in package.exec_depends}


class Prefix:
    """A prefix with the script in ``lib/edgevox`` and a console script that shows how it is run."""

    def __init__(self, place: Path) -> None:
        self.place = place
        self.script = place / "lib" / "edgevox" / "edgevox-agent"
        self.script.parent.mkdir(parents=True)
        shutil.copy(SCRIPT, self.script)

    def add_console_script(self) -> Path:
        program = self.place / "bin" / "edgevox-agent"
        program.parent.mkdir(parents=True)
        program.write_text('#!/bin/sh\necho "$@"\nenv\n')
        program.chmod(0o755)
        return program

    def add_wheels(self, packages: str) -> None:
        marker = self.place / "lib" / packages / "ros_wheels_bootstrapper.pth"
        marker.parent.mkdir(parents=True)
        marker.touch()

    def run(self, path: str = "/nowhere") -> subprocess.CompletedProcess[str]:
        return run_program(
            [self.script, "robot-apartment", "a b"],
            env={**FOREIGN, "PATH": f"{path}:/usr/bin:/bin"},
        )


def test_the_script_hands_on_arguments_and_the_sourced_ros_2(tmp_path: Path) -> None:
    one = Prefix(tmp_path / "my prefix")
    one.add_console_script()
    lines = one.run().stdout.splitlines()
    assert lines[0] == "robot-apartment a b"
    assert {f"{key}={value}" for key, value in FOREIGN.items()} <= set(lines)


@pytest.mark.parametrize("packages", ["python3.11/site-packages", "python3.12/dist-packages"])
def test_the_script_keeps_another_ros_2_from_an_environment_of_wheels(
    tmp_path: Path, packages: str
) -> None:
    one = Prefix(tmp_path)
    one.add_console_script()
    one.add_wheels(packages)
    shown = one.run().stdout
    assert shown.startswith("robot-apartment a b\n")
    assert not [key for key in FOREIGN if f"\n{key}=" in shown]


def test_from_a_workspace_the_script_finds_the_program_on_the_path(tmp_path: Path) -> None:
    workspace, environment = Prefix(tmp_path / "install"), Prefix(tmp_path / "venv")
    program = environment.add_console_script()
    environment.add_wheels("python3.11/site-packages")
    shown = workspace.run(path=str(program.parent)).stdout
    assert shown.startswith("robot-apartment a b\n")
    assert "LD_LIBRARY_PATH" not in shown


def test_where_the_program_is_missing_the_script_says_how_to_get_it(tmp_path: Path) -> None:
    done = Prefix(tmp_path).run()
    assert done.returncode == 127
    assert done.stderr.startswith("edgevox-agent: not found here or on PATH; install")
