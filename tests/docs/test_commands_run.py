"""Commands of the pages, run as they stand, page by page."""

import os
import shutil
import sys
from pathlib import Path

import pytest
from guards import run_program
from page_commands import PAGES, ROOT, commands, proofs

pytestmark = pytest.mark.long

TABLE = proofs()


def runnable(page):
    """The page's commands that can be run, each once, in their order."""
    first = {c: next((p for p in TABLE if p.covers(c)), None) for c in commands(page)}
    return [command for command, proof in first.items() if proof and proof.run]


def already(page):
    """What the pages before this one run, too; that is not run again, unless it installs."""
    before = PAGES[: PAGES.index(page)]
    return {plain(c) for one in before for c in runnable(one) if not c.startswith("pip")}


def plain(command):
    """The programs are on the PATH, too."""
    return command.replace(".venv/bin/", "")


@pytest.fixture
def folder(tmp_path):
    """A place like the repository's root, in which commands may write what they like."""
    for name in ("scenarios", "examples", "Makefile"):
        (tmp_path / name).symlink_to(ROOT / name)
    (tmp_path / ".venv").symlink_to(sys.prefix)
    return tmp_path


@pytest.fixture
def environment(tmp_path):
    """The programs are on the PATH, and what is installed goes nowhere else."""
    inherited = {
        k: v for k, v in os.environ.items() if not k.startswith(("EDGEVOX_", "ROS_DOMAIN"))
    }
    bin_folder = Path(sys.executable).parent
    site = str(tmp_path / "site")
    return (
        inherited
        | {
            "PATH": f"{bin_folder}:{inherited['PATH']}",
            "PIP_TARGET": site,
            "PYTHONPATH": site,
            "EDGEVOX_OFFLINE": "1",
            "DISPLAY": "",
            "WAYLAND_DISPLAY": "",
        }
        | ({"EDGEVOX_MODELS_DIR": at} if (at := os.environ.get("EDGEVOX_MODELS_DIR")) else {})
    )


@pytest.mark.parametrize("page", [one for one in PAGES if runnable(one)], ids=lambda one: one.name)
def test_the_commands_of_a_page_do_what_they_should(page, folder, environment):
    assert shutil.which("bash")
    for command in runnable(page):
        if plain(command) in already(page):
            continue
        done = run_program(["bash", "-euo", "pipefail", "-c", command], cwd=folder, env=environment)
        assert done.returncode == 0, f"{command}\n{done.stdout}{done.stderr}"
        assert "Traceback" not in done.stderr, command
