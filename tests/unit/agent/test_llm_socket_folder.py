"""Folders of models' sockets: of whoever lives they stay, of whoever was killed they go."""

import signal
import stat
import subprocess
import sys
from pathlib import Path

import pytest

from edgevox.agent.llm.xllamacpp_model import PREFIX, SocketFolder, remove_abandoned

HOLD = """
import sys, time
from pathlib import Path
from edgevox.agent.llm.xllamacpp_model import SocketFolder
folder = SocketFolder(Path(sys.argv[1]))
(folder.path / "llm.sock").touch()
print(folder.path, flush=True)
time.sleep(60)
"""


@pytest.fixture
def other(tmp_path):
    """Another process that has such a folder, and the folder."""
    process = subprocess.Popen(
        [sys.executable, "-c", HOLD, str(tmp_path)], stdout=subprocess.PIPE, text=True
    )
    try:
        yield process, Path(process.stdout.readline().strip())
    finally:
        process.kill()
        process.wait()
        process.stdout.close()


def test_what_a_killed_process_left_behind_goes_at_the_next_start(tmp_path, other):
    process, left = other
    assert (left / "llm.sock").exists()
    process.send_signal(signal.SIGKILL)
    process.wait()
    assert left.exists()
    mine = SocketFolder(tmp_path)
    assert list(tmp_path.iterdir()) == [mine.path]
    mine.close()


def test_what_a_living_process_uses_stays(tmp_path, other):
    _, used = other
    mine = SocketFolder(tmp_path)
    second = SocketFolder(tmp_path)
    assert (used / "llm.sock").exists()
    assert {used, mine.path, second.path} == set(tmp_path.iterdir())
    mine.close()
    second.close()


def test_nobody_else_may_enter_and_closing_removes_it(tmp_path):
    folder = SocketFolder(tmp_path)
    assert folder.path.name.startswith(PREFIX)
    assert stat.S_IMODE(folder.path.stat().st_mode) == 0o700
    folder.close()
    folder.close()
    assert not list(tmp_path.iterdir())


def test_nothing_else_is_touched(tmp_path):
    elsewhere = tmp_path / "elsewhere"
    elsewhere.mkdir()
    (elsewhere / "precious").touch()
    (tmp_path / f"{PREFIX}link").symlink_to(elsewhere)
    (tmp_path / f"{PREFIX}file").touch()
    (tmp_path / "edgevox-other").mkdir()
    remove_abandoned(tmp_path)
    assert (elsewhere / "precious").exists()
    assert len(list(tmp_path.iterdir())) == 4
