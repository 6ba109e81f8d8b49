"""What a machine lacks is said at once, by the names that Debian has for it."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from guards import run_program

ROOT = Path(__file__).parents[3]
LIST = ROOT / "requirements" / "debian.list"
PARTS = {
    "run",
    "unit",
    "talk",
    "wrong",
    "training",
    "programs",
    "robots",
    "models",
    "ros2",
    "docs",
    "browser",
    "compose",
}
LACKING = """
# a comment
python3-tk      robots       false
there           robots,ros2  true
gone            ros2         command -v no-such-program
everywhere      run          false
"""


@pytest.fixture
def check(tmp_path, monkeypatch):
    monkeypatch.setenv("DEBIAN_LIST", str(tmp_path / "list"))
    (tmp_path / "list").write_text(LACKING)

    def run(*arguments: str, python: str = sys.executable) -> subprocess.CompletedProcess:
        return run_program(
            [ROOT / "scripts" / "check_machine", *arguments], env=os.environ | {"PYTHON": python}
        )

    return run


@pytest.mark.parametrize(
    ("parts", "lacking"),
    [
        ([], "everywhere"),
        (["robots"], "python3-tk everywhere"),
        (["ros2"], "gone everywhere"),
        (["unit", "robots", "ros2"], "python3-tk gone everywhere"),
    ],
)
def test_what_is_missing_for_what_is_to_be_done_is_named_with_how_to_get_it(check, parts, lacking):
    done = check(*parts, python="python3")

    assert done.returncode == 1
    assert done.stderr == f"Missing; get it with: sudo apt install {lacking}\n"


def test_a_python_that_was_chosen_has_packages_of_its_own(check):
    assert "install python3.12-tk everywhere" in check("robots", python="python3.12").stderr


def test_all_that_is_missing_is_listed_for_whoever_installs_it(check):
    done = check("--names", python="python3")

    assert (done.returncode, done.stdout.split()) == (0, ["python3-tk", "gone", "everywhere"])


def test_a_python_that_will_not_do_is_refused_with_those_that_will(check, tmp_path, monkeypatch):
    (tmp_path / "list").write_text("")
    old = tmp_path / "python"
    old.write_text('#!/bin/sh\n[ "$1" = --version ] && echo Python 3.9.2\nexit 1\n')
    old.chmod(0o755)

    done = check(python=str(old))

    assert done.returncode == 1
    assert "needs Python 3.11 to 3.13; Python 3.9.2" in done.stderr
    assert check().returncode == 0


def test_every_line_of_the_list_has_a_package_parts_that_there_are_and_a_check():
    lines = [
        one.split(None, 2) for one in LIST.read_text().splitlines() if one[:1] not in ("#", "")
    ]
    assert all(len(line) == 3 for line in lines)
    for package, parts, _ in lines:
        assert set(parts.split(",")) <= PARTS, package


def environment_of_nobody() -> dict[str, str]:
    """Without what the `make` has set that runs this test."""
    ours = ("MAKE", "ALL", "LONG", "NAMED", "PARTS")
    return {name: value for name, value in os.environ.items() if not name.startswith(ours)}


def dry_run(*arguments: str, **environment: str) -> list[str]:
    """What `make` would do."""
    kept = environment_of_nobody()
    return run_program(
        ["make", "--dry-run", "--silent", *arguments], cwd=ROOT, env=kept | environment
    ).stdout.splitlines()


@pytest.mark.parametrize(
    ("arguments", "parts", "needs"),
    [
        ("tests/unit/core/test_bus.py", "unit", ".venv/done/msgs"),
        ("tests/programs", "programs", ""),
        ("tests/unit tests/robots/test_tui.py -x", "robots unit", ".venv/done/msgs test-models"),
        ("tests/ros2", "ros2", ".venv/done/msgs test-models"),
        (
            "--durations=20",
            "unit talk wrong training programs robots models ros2 docs browser compose",
            ".venv/done/llama-cpp .venv/done/msgs .venv/done/page test-image test-models",
        ),
    ],
)
def test_make_test_runs_the_parts_that_are_named_and_builds_what_they_need(arguments, parts, needs):
    shown = dry_run("test", f"ARGS={arguments}")

    assert f' PARTS="{parts}" ' in shown[0]
    assert shown[1].split()[-len(arguments.split()) :] == arguments.split()
    assert dry_run("test-needs", f"TESTED={parts}") == [f"echo {needs}"]


STUB_OF_MAKE = """
test-needs:
	@echo $(if $(filter models,$(TESTED)),broken)
.venv/done/dev:
	@true
broken:
	@false
"""
STUB_OF_PYTHON = """#!/bin/sh
echo "$@" >>ran
exit "$ENDS"
"""
NOWHERE = "tcp://127.0.0.1:1"


@pytest.fixture
def run_tests(tmp_path):
    """Runs `scripts/run_tests` where `make` builds nothing and pytest notes what it is to run."""
    for script in ("check_machine", "run_tests"):
        (tmp_path / "scripts").mkdir(exist_ok=True)
        shutil.copy(ROOT / "scripts" / script, tmp_path / "scripts")
    programs = tmp_path / "programs"
    programs.mkdir()
    for name, text in {"sudo": 'shift; exec "$@"', "apt-get": 'echo "$@" >>installed'}.items():
        (programs / name).write_text(f"#!/bin/sh\n{text}\n")
        (programs / name).chmod(0o755)
    (tmp_path / "Makefile").write_text(STUB_OF_MAKE)
    python = tmp_path / ".venv" / "bin" / "python"
    python.parent.mkdir(parents=True)
    python.write_text(STUB_OF_PYTHON)
    python.chmod(0o755)
    packages = tmp_path / "list"
    packages.write_text("gone ros2 test -e installed\nthere unit true\n")

    def run(parts: str, ends: int = 0, **environment: str) -> subprocess.CompletedProcess:
        kept = environment_of_nobody()
        told = {
            "PARTS": parts,
            "ENDS": str(ends),
            "PYTHON": "python3",
            "DEBIAN_LIST": str(packages),
            "DOCKER_HOST": NOWHERE,
            "PATH": f"{programs}:{os.environ['PATH']}",
        }
        return run_program(
            [tmp_path / "scripts" / "run_tests", "-x"], cwd=tmp_path, env=kept | told | environment
        )

    return run


def ran(tmp_path: Path) -> list[str]:
    """What pytest was to run, each time."""
    told = tmp_path / "ran"
    return told.read_text().splitlines() if told.exists() else []


def test_what_is_missing_is_installed_after_a_line_that_says_so(run_tests, tmp_path):
    done = run_tests("unit ros2")

    assert done.stdout.splitlines()[0] == "Installing what is missing here: gone"
    assert "install -qq -y --no-install-recommends gone" in (tmp_path / "installed").read_text()
    assert [line.split()[-2:] for line in ran(tmp_path)] == [["tests/unit", "tests/ros2"]]
    assert "NOT RUN" not in done.stdout


def test_what_cannot_run_is_left_out_and_told_last_with_how_to_get_it(run_tests, tmp_path):
    (tmp_path / "programs" / "apt-get").write_text("#!/bin/sh\nexit 1\n")  # no network

    done = run_tests("unit ros2 compose models")

    assert [line.split()[-1] for line in ran(tmp_path)] == ["tests/unit"]
    *_, heading, ros2, compose, models, last = done.stdout.splitlines()
    assert heading == "NOT RUN:"
    assert ros2 == "  tests/ros2: gone is missing; get it with: sudo apt install gone"
    assert "sudo .ci/engine" in compose
    assert "tests/models" in models
    assert last == "Ended with 0, WITHOUT 3 of 4 parts of the tests."
    assert done.returncode == 0


@pytest.mark.parametrize("asked", ["ALL", "NAMED"])
def test_what_was_asked_for_by_name_is_never_left_out(run_tests, tmp_path, asked):
    done = run_tests("unit compose", **{asked: "1"})

    assert done.returncode == 1
    assert ran(tmp_path) == []
    assert "tests/compose" in done.stderr


def test_a_test_that_fails_fails_the_run_also_where_long_ones_pass_after_it(run_tests, tmp_path):
    assert run_tests("unit", ends=1).returncode == 1
    assert run_tests("unit", LONG="1").returncode == 0
    assert [" -m not long" in line for line in ran(tmp_path)] == [True, True, False]
    assert " -m long" in ran(tmp_path)[-1]


@pytest.mark.parametrize(
    ("arguments", "environment", "served"),
    [
        ("", {}, True),
        ("--text-mode", {}, True),
        ("--console", {}, False),  # by hand: there a taken port is an error
        ("--no-console", {}, False),
        ("--scenario scenarios/errand.yaml", {}, False),
        ("", {"EDGEVOX_CONSOLE": "false"}, False),
    ],
)
def test_make_run_serves_the_console_unless_told_otherwise(arguments, environment, served):
    shown = dry_run("run", f"ARGS={arguments}", **environment)

    assert ("--console-optional" in shown[-1]) is served
    assert shown[-1].endswith(arguments or shown[-1])
