"""The viewer on a real X server that has its screen in a file."""

import contextlib
import logging
import os
import shutil
import signal
import struct
import subprocess
import sys
import threading
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pytest
from guards import HUNG_S, run_program
from waiting import wait_until

from edgevox.robots.flat.apartment import ApartmentRobot
from edgevox.robots.flat.viewer import Viewer

pytestmark = pytest.mark.long

AGENT = str(Path(sys.executable).with_name("edgevox-agent"))
ROBOT_BLUE = (37, 99, 235)
SCREEN = "900x900x24"
RED, GREEN = (200, 30, 40), (20, 180, 60)


def child_pids(pid: int) -> list[int]:
    """The processes that a process started."""
    found = Path(f"/proc/{pid}/task").glob("*/children")
    return [int(child) for file in found for child in read(file).split()]


def command_line(pid: int) -> bytes:
    return read(Path(f"/proc/{pid}/cmdline"))


def read(file: Path) -> bytes:
    """What is in it; nothing of a thread or a process that is over by now."""
    with contextlib.suppress(FileNotFoundError, ProcessLookupError):
        return file.read_bytes()
    return b""


def children(pid: int) -> bytes:
    """The command lines of the processes that a process started."""
    return b"\n".join(map(command_line, child_pids(pid)))


def window_of_mine() -> int:
    """The process that shows this process's window."""
    (window,) = (pid for pid in child_pids(os.getpid()) if b"viewer_window" in command_line(pid))
    return window


class Screen:
    """What an X server shows."""

    def __init__(self, file: Path) -> None:
        self._file = file

    def count(self, color: tuple[int, int, int]) -> int:
        """How many pixels have this colour."""
        data = self._file.read_bytes()
        header = struct.unpack(">25I", data[:100])
        start, height, line = header[0] + 12 * header[19], header[5], header[12]
        pixels = np.frombuffer(data, np.uint8, height * line, start).reshape(-1, 4)
        return int((pixels[:, 2::-1] == color).all(axis=1).sum())


@pytest.fixture
def screen(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Screen]:
    """A display of its own."""
    if shutil.which("Xvfb") is None:
        pytest.fail("Xvfb is missing: apt-get install xvfb")
    ours, theirs = os.pipe()
    server = subprocess.Popen(
        ["Xvfb", "-displayfd", str(theirs), "-screen", "0", SCREEN, "-fbdir", str(tmp_path)],
        pass_fds=[theirs],
        stderr=subprocess.DEVNULL,
    )
    os.close(theirs)
    with open(ours, encoding="ascii") as told, server:
        monkeypatch.setenv("DISPLAY", f":{told.readline().strip()}")
        yield Screen(tmp_path / "Xvfb_screen0")
        server.terminate()


class Canvas:
    """A picture of one colour that can be changed."""

    def __init__(self) -> None:
        self.color = RED
        self.drawn = 0

    def __call__(self) -> np.ndarray:
        self.drawn += 1
        return np.full((120, 160, 3), self.color, dtype=np.uint8)


@pytest.fixture
def viewer() -> Iterator[Callable[..., Viewer]]:
    started: list[Viewer] = []

    def start(picture: Callable[[], np.ndarray]) -> Viewer:
        started.append(Viewer(picture, "a robot"))
        started[-1].start()
        return started[-1]

    yield start
    for one in started:
        one.close()


def test_the_window_shows_the_picture_and_follows_it(screen, viewer) -> None:
    canvas = Canvas()
    viewer(canvas)
    wait_until(lambda: screen.count(RED) == 120 * 160)

    canvas.color = GREEN

    wait_until(lambda: screen.count(GREEN) == 120 * 160)
    assert screen.count(RED) == 0


def test_it_shows_a_robot_and_closing_takes_the_window_and_the_thread_away(screen, viewer) -> None:
    with ApartmentRobot() as robot:
        shown = viewer(robot.picture)
        wait_until(lambda: screen.count(ROBOT_BLUE) > 200)

        shown.close()

    wait_until(lambda: screen.count(ROBOT_BLUE) == 0)
    assert not shown.running
    assert "viewer" not in [thread.name for thread in threading.enumerate()]


def test_a_window_that_dies_ends_the_viewer_and_nothing_else(screen, viewer, caplog) -> None:
    canvas = Canvas()
    shown = viewer(canvas)
    wait_until(lambda: screen.count(RED))

    os.kill(window_of_mine(), signal.SIGTERM)

    wait_until(lambda: not shown.running)
    assert "no_window" in caplog.text
    shown.close()


def test_a_window_that_hangs_is_closed_all_the_same(screen, viewer) -> None:
    canvas = Canvas()
    shown = viewer(canvas)
    wait_until(lambda: screen.count(RED))
    window = window_of_mine()
    os.kill(window, signal.SIGSTOP)
    wait_until(lambda: canvas.drawn > 2)

    shown.close()

    assert not shown.running
    assert window not in child_pids(os.getpid())


def test_a_picture_that_cannot_be_drawn_closes_the_window_and_is_logged(
    screen, viewer, caplog
) -> None:
    def broken() -> np.ndarray:
        raise RuntimeError("no light")

    with caplog.at_level(logging.ERROR):
        shown = viewer(broken)
        wait_until(lambda: not shown.running)

    assert "no light" in caplog.text
    assert b"viewer_window" not in children(os.getpid())


def test_without_a_display_one_line_says_so(viewer, monkeypatch, caplog) -> None:
    monkeypatch.delenv("DISPLAY", raising=False)

    shown = viewer(Canvas())
    wait_until(lambda: not shown.running)

    (record,) = caplog.records
    assert record.levelname == "WARNING"
    assert "no_window" in record.getMessage()
    assert "display" in record.getMessage()


def test_without_tkinter_the_window_says_what_to_install() -> None:
    script = (
        "import sys; sys.modules['tkinter'] = None\n"
        "from edgevox.robots.flat.viewer_window import main; sys.exit(main())"
    )

    done = run_program([sys.executable, "-c", script])

    assert done.returncode == 3
    assert "apt install python3-tk" in done.stderr


def test_the_window_ends_with_the_program_that_started_it(screen, tmp_path) -> None:
    script = """
import numpy as np, os, sys
from edgevox.robots.flat.viewer import Viewer
viewer = Viewer(lambda: np.full((50, 60, 3), (200, 30, 40), dtype=np.uint8), "a robot")
viewer.start()
sys.stdin.readline()
os._exit(1)
"""
    program = subprocess.Popen([sys.executable, "-c", script], stdin=subprocess.PIPE)
    wait_until(lambda: screen.count(RED) == 50 * 60)

    program.communicate(b"die\n", timeout=HUNG_S)

    wait_until(lambda: screen.count(RED) == 0)


@pytest.mark.parametrize(("flag", "shown"), [("--render", True), ("--no-render", False)])
def test_the_agent_shows_its_robot_unless_it_is_told_not_to(screen, flag, shown) -> None:
    command = [AGENT, "robot-irsim", "--text-mode", "--llm=none", flag]
    pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE, "stderr": subprocess.PIPE}
    with subprocess.Popen(command, **pipes) as agent:
        assert b"is ready" in agent.stdout.readline()
        if shown:
            wait_until(lambda: screen.count(ROBOT_BLUE) > 200)
        assert (b"viewer_window" in children(agent.pid)) is shown
        out, told = agent.communicate(b"where are you\n/quit\n", timeout=HUNG_S)

    assert agent.returncode == 0
    assert b"I am in the living room" in out
    assert told == b""
    wait_until(lambda: screen.count(ROBOT_BLUE) == 0)
