"""What a machine lacks is said at once, by the names that Debian has for it."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
LIST = ROOT / "requirements" / "debian.list"
PARTS = {"run", "unit", "programs", "robots", "models", "ros2", "docs", "browser", "compose"}
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
        return subprocess.run(
            [ROOT / "scripts" / "check_machine", *arguments],
            env=os.environ | {"PYTHON": python},
            capture_output=True,
            text=True,
            timeout=60,
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


def test_a_machine_without_an_engine_is_told_so_where_containers_are_tested(check, monkeypatch):
    monkeypatch.setenv("DOCKER_HOST", "tcp://127.0.0.1:1")
    Path(os.environ["DEBIAN_LIST"]).write_text("", encoding="utf-8")

    assert "No container engine answers" in check("compose").stderr
    assert check("unit").stderr == ""


def test_every_line_of_the_list_has_a_package_parts_that_there_are_and_a_check():
    lines = [
        one.split(None, 2) for one in LIST.read_text().splitlines() if one[:1] not in ("#", "")
    ]
    assert all(len(line) == 3 for line in lines)
    for package, parts, _ in lines:
        assert set(parts.split(",")) <= PARTS, package


def test_ci_and_make_ask_the_same_list():
    for asks in (".ci/run", "Makefile"):
        assert "scripts/check_machine" in (ROOT / asks).read_text()


@pytest.mark.parametrize(
    ("arguments", "parts", "built"),
    [
        ("tests/unit/test_bus.py", "unit", []),
        ("tests/programs", "programs", []),
        ("tests/unit tests/robots/test_tui.py -x", "robots unit", ["test-models"]),
        ("tests/ros2", "ros2", [".venv/done/msgs", "test-models"]),
        (
            "--durations=20",
            "unit programs robots models ros2 docs browser compose",
            [
                ".venv/done/llama-cpp",
                ".venv/done/msgs",
                ".venv/done/page",
                "test-image",
                "test-models",
            ],
        ),
    ],
)
def test_make_test_fetches_and_builds_what_the_named_tests_need_and_no_more(
    arguments, parts, built
):
    shown = subprocess.run(
        ["make", "--dry-run", "--silent", "test", f"ARGS={arguments}", "MAKE=echo makes"],
        cwd=ROOT,
        env={name: value for name, value in os.environ.items() if not name.startswith("MAKE")},
        capture_output=True,
        text=True,
        timeout=60,
    ).stdout.splitlines()

    assert shown[0] == f"PYTHON=python3 scripts/check_machine {parts}"
    (needs,) = (line.split() for line in shown if line.startswith("makes") and " -j2 " in line)
    assert needs[needs.index("-j2") + 1 :] == [".venv/done/dev", *built]


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
    kept = {name: value for name, value in os.environ.items() if not name.startswith("MAKE")}
    shown = subprocess.run(
        ["make", "--dry-run", "--silent", "run", f"ARGS={arguments}"],
        cwd=ROOT,
        env=kept | environment,
        capture_output=True,
        text=True,
        timeout=60,
    ).stdout.splitlines()

    assert ("--console-optional" in shown[-1]) is served
    assert shown[-1].endswith(arguments or shown[-1])
