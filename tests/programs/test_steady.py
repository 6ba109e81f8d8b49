"""`make steady`: which runs it makes, and that one which fails is told."""

import subprocess
import sys
from pathlib import Path

import pytest
from guards import HUNG_S

pytestmark = pytest.mark.long

STEADY = Path(__file__).parents[2] / "scripts" / "steady.py"
GOOD = "def test_it(): assert True\n"
BAD = "def test_it(): assert False, 'for a reason'\n"


def steady(*arguments: str) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, STEADY, *arguments]
    return subprocess.run(command, capture_output=True, text=True, timeout=HUNG_S)


@pytest.fixture
def file(tmp_path):
    def write(text: str) -> str:
        (tmp_path / "test_it.py").write_text(text)
        return str(tmp_path / "test_it.py")

    return write


def test_every_run_is_a_row_of_the_table_and_all_that_pass_end_with_0(file):
    done = steady("--only", "random", "--runs", "2", file(GOOD))

    assert done.returncode == 0, done.stdout + done.stderr
    table = done.stdout.rpartition("\n\n")[2].splitlines()
    assert [row.split()[:4] for row in table[:-1]] == [
        ["random", "1", "of", "2"],
        ["random", "2", "of", "2"],
    ]
    assert all("passed" in row for row in table[:-1])
    assert table[-1] == "0 of 2 runs failed"


def test_a_run_that_fails_is_shown_and_ends_it_with_1_after_all_others(file):
    done = steady("--only", "idle,core", "--runs", "1", file(BAD))

    assert done.returncode == 1
    assert "for a reason" in done.stdout
    assert done.stdout.splitlines()[-1] == "2 of 2 runs failed"


@pytest.mark.parametrize("wrong", [["--only", "idle,lazy"], ["--runs", "0"]])
def test_what_makes_no_sense_is_refused(wrong):
    done = steady(*wrong)

    assert done.returncode == 2
    assert "expected" in done.stderr
