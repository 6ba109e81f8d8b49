"""On the public Python index the name of our import package belongs to somebody else: nothing here
may have it installed.
"""

import importlib.util
import re
import shutil
import subprocess
import sysconfig
import tomllib
import venv
from collections.abc import Iterator
from importlib import metadata
from pathlib import Path

import pytest
from guards import HUNG_S
from packaging.requirements import InvalidRequirement, Requirement
from packaging.utils import canonicalize_name

ROOT = Path(__file__).resolve().parent.parent.parent
OURS = "edgevox-robot"
THEIRS = "edgevox"
ALONE = rf"(?<![\w./-]){THEIRS}"
INSTALLS = re.compile(
    r"(?:\bpip3?\b[^\n]*? install|\bpipx (?:install|run)|\buv (?:pip install|add|tool install)"
    r"|\buvx|\bpoetry add|\bpip3? (?:download|wheel))\s(?P<asked>[^\n;|&]*)",
    re.IGNORECASE,
)
NAMES = (
    re.compile(rf"{ALONE}\[[a-z][a-z0-9,_ -]*\]", re.IGNORECASE),  # with extras
    re.compile(rf"{ALONE}\s*(?:[=~!]=|[<>]=?)=?\s*\d", re.IGNORECASE),  # with a version
    re.compile(rf"{ALONE} @ \w", re.IGNORECASE),  # with an address
    re.compile(rf"Requires-Dist: {THEIRS}\b(?!-)", re.IGNORECASE),
    re.compile(rf"(?:dependencies|requires)\s*=\s*\[[^\]]*[\"']{THEIRS}[\"'\s;]", re.IGNORECASE),
    re.compile(rf"pypi(?:\.org/(?:project|simple))?/{THEIRS}(?![\w-])", re.IGNORECASE),
    re.compile(rf"\b(?:version|distribution|metadata)\([\"']{THEIRS}[\"']\)"),
    re.compile(rf"no-emit-package={THEIRS}(?![\w-])"),
)


INSTALLER = (
    "pip",
    "hatchling",
    "editables",
    "packaging",
    "pathspec",
    "pluggy",
    "trove_classifiers",
)


def names_theirs(text: str) -> list[str]:
    """What in a text would have a stranger's package installed or looked up."""
    joined = text.replace("\\\n", " ")
    asked = [token for one in INSTALLS.finditer(joined) for token in one["asked"].split()]
    found = [token for token in asked if distribution(token.strip("\"'`().,")) == THEIRS]
    return found + [one[0] for pattern in NAMES for one in pattern.finditer(joined)]


def distribution(requirement: str) -> str:
    """The name that pip would look for on an index; empty for what is none, such as a path."""
    try:
        return canonicalize_name(Requirement(requirement).name)
    except InvalidRequirement:
        return ""


def tracked() -> Iterator[tuple[str, str]]:
    """Every text that git knows, with its path."""
    command = ["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard"]
    listed = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True).stdout
    for path in filter(None, listed.split("\0")):
        try:
            yield path, (ROOT / path).read_text(encoding="utf-8")
        except (UnicodeDecodeError, FileNotFoundError):
            continue


def project(path: str) -> dict[str, object]:
    return tomllib.loads((ROOT / path).read_text(encoding="utf-8"))["project"]


def test_nothing_here_names_a_strangers_package_as_something_to_install() -> None:
    found = {path: named for path, text in tracked() if (named := names_theirs(text))}
    assert not found


@pytest.mark.parametrize(
    "text",
    [
        f"pip install {THEIRS}",
        f"~/venv/bin/python -m pip install -qq '{THEIRS}[voice,llm]'",
        f"pip install --upgrade \\\n    {THEIRS}==0.2",
        f"run `pip install {THEIRS.title()}`.",
        f"uv add {THEIRS}",
        f"install {THEIRS}[ros2]",
        f'dependencies = [\n    "numpy",\n    "{THEIRS}",\n]',
        f"{THEIRS}>=0.1",
        f"Requires-Dist: {THEIRS} (>=1)",
        f"https://pypi.org/project/{THEIRS}/",
        f'version("{THEIRS}")',
    ],
)
def test_every_way_of_naming_it_is_seen(text: str) -> None:
    assert names_theirs(text)


@pytest.mark.parametrize(
    "text",
    [
        f"pip install src/{THEIRS}",
        f"~/{THEIRS}/bin/pip install 'src/{THEIRS}[voice,llm]'",
        "pip install '.[voice]' in EdgeVox's folder",
        f"pip install --no-deps ./examples/own_robot && {THEIRS}-agent robot-shuttle",
        f"import {THEIRS}",
        f"pip uninstall --yes {THEIRS}",
        f'dependencies = ["{OURS}"]',
    ],
)
def test_our_own_paths_and_programs_are_not_taken_for_it(text: str) -> None:
    assert not names_theirs(text)


def test_the_examples_and_the_locks_know_our_own_name() -> None:
    assert project("pyproject.toml")["name"] == OURS
    for example in ("own_robot", "own_skill", "own_ros_skill"):
        assert project(f"examples/{example}/pyproject.toml")["dependencies"] == [OURS]
    for lock in (ROOT / "requirements").glob("*.lock"):
        names = {distribution(line.split(" \\")[0]) for line in lock.read_text().splitlines()}
        assert names.isdisjoint({OURS, THEIRS}), f"{lock.name} would look for EdgeVox on an index"


class Environment:
    """A virtual environment with nothing but what installs from a folder."""

    def __init__(self, place: Path) -> None:
        venv.create(place, symlinks=True)
        self.place = place
        self._packages = Path(sysconfig.get_path("purelib", vars={"base": str(place)}))
        tools = place / "tools"
        tools.mkdir()
        for name in INSTALLER:
            spec = importlib.util.find_spec(name)
            assert spec
            assert spec.origin
            (tools / name).symlink_to(Path(spec.origin).parent)
        (self._packages / "tools.pth").write_text(f"{tools}\n")

    def install(self, folder: Path) -> None:
        pip = [self.place / "bin" / "python", "-m", "pip", "install", "--quiet", "--no-deps"]
        options = ["--no-index", "--no-build-isolation", "--editable", folder]
        subprocess.run([*pip, *options], check=True, capture_output=True, timeout=HUNG_S)

    def distributions(self) -> list[str]:
        return [one.name for one in metadata.distributions(path=[str(self._packages)])]


def by_its_old_name(place: Path) -> Path:
    """A folder of EdgeVox from when pip knew it by the name that is not ours."""
    ours = ("ament", "launch", "LICENSE", "README.md", "pyproject.toml")
    ours += ("edgevox/__init__.py", "edgevox/core/version.py")
    for name in ours:
        source, copy = ROOT / name, place / name
        copy.parent.mkdir(parents=True, exist_ok=True)
        (shutil.copytree if source.is_dir() else shutil.copy)(source, copy)
    about = place / "pyproject.toml"
    about.write_text(about.read_text().replace(f'name = "{OURS}"', f'name = "{THEIRS}"'))
    return place


def test_make_replaces_what_is_installed_by_the_old_name(tmp_path: Path) -> None:
    there = Environment(tmp_path / "venv")
    there.install(by_its_old_name(tmp_path / "old"))
    assert there.distributions() == [THEIRS]
    done = there.place / "done"
    done.mkdir()
    (done / "locked").touch()
    make = ["make", f"VENV={there.place}", "-o", done / "locked", done / "run"]
    ran = subprocess.run(make, cwd=ROOT, capture_output=True, text=True, timeout=HUNG_S)
    assert ran.returncode == 0, ran.stderr
    assert there.distributions() == [OURS]
    for program in project("pyproject.toml")["scripts"]:
        assert (there.place / "bin" / program).is_file()
