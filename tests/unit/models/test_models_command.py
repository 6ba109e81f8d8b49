import os
import select
from pathlib import Path

import pytest

from edgevox.models.sources.tools import run_tool
from edgevox.models.store import SourceFailed


def run(script: str, where: Path, timeout_s: float = 60.0) -> str:
    return run_tool(["sh", "-c", script], where=where, timeout_s=timeout_s, environment={"A": "1"})


def test_what_a_tool_prints_is_given_back(tmp_path: Path) -> None:
    assert run("echo $A; pwd", tmp_path) == f"1\n{tmp_path}\n"


def test_a_tool_that_fails_is_quoted_with_its_telling_line(tmp_path: Path) -> None:
    with pytest.raises(SourceFailed, match=r"^fatal: no such thing$"):
        run("echo working; echo 'fatal: no such thing' >&2; echo sorry >&2; exit 3", tmp_path)


@pytest.mark.parametrize("prefix", ["npm error", "npm ERR!"])
def test_each_npm_is_quoted_with_what_went_wrong(tmp_path: Path, prefix: str) -> None:
    """Version 9, as Debian 12 has it, marks its lines in another way."""
    said = f"echo '{prefix} code ETARGET'; echo '{prefix} notarget No version'; echo '{prefix} log'"
    with pytest.raises(SourceFailed, match=r"^code ETARGET; notarget No version$"):
        run(f"{said}; exit 1", tmp_path)


def test_a_tool_that_takes_too_long_is_ended_with_all_it_started(tmp_path: Path) -> None:
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    reader = os.open(pipe, os.O_RDONLY | os.O_NONBLOCK)

    told, timeout_s = b"", 1
    while not told:  # until it had begun by then
        with pytest.raises(SourceFailed, match=f"sh took longer than {timeout_s} s"):
            run(f"{{ echo up; sleep 600; }} > {pipe} & wait", tmp_path, timeout_s=timeout_s)
        select.select([reader], [], [], 60)
        told, timeout_s = os.read(reader, 10), 2 * timeout_s

    assert told == b"up\n"
    select.select([reader], [], [], 60)
    assert os.read(reader, 10) == b"", "a process of its still has the pipe open"
    os.close(reader)
