"""Tests in workers of pytest-xdist: what runs beside what, and what runs alone."""

import fcntl
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from itertools import chain, zip_longest
from pathlib import Path
from typing import TypeVar

from xdist.scheduler import LoadFileScheduling

COMPUTING = ("models", "robots", "programs", "docs", "talk", "unit", "wrong")
"""The parts of the tests that mostly compute, the longest first."""
WAITING = ("compose", "ros2", "browser")
"""Those that mostly wait: for containers, a page, the other end of a wire, a robot to arrive."""
LAST = "test_chaos.py"
SHARING = {
    "tests/models/test_listener_micro_wake_word.py": "tests/models/test_listener_wake_word.py",
}
"""Files that run in the worker of another one, which has already prepared what costs them most."""

ONE_NETWORK = ("tests/compose/", "tests/browser/")
"""Parts that run in one worker: whenever a container comes or goes the machine's network is another
one, and a browser then drops what it loads."""

Item = TypeVar("Item")


def part_of(path: Path) -> str:
    """The folder of `tests` that it is in."""
    folders = path.parts
    return folders[folders.index("tests") + 1] if "tests" in folders[:-1] else path.parent.name


def in_turns(items: Iterable[tuple[Path, Item]]) -> list[Item]:
    """What computes and what waits, a file of each in turn, so that both are under way at once."""
    files: dict[Path, list[Item]] = {}
    for path, item in items:
        files.setdefault(path, []).append(item)
    lanes = [
        [path for part in parts for path in files if part_of(path) == part and path.name != LAST]
        for parts in (COMPUTING, WAITING)
    ]
    placed = [path for path in chain(*zip_longest(*lanes)) if path is not None]
    rest = [path for path in files if path not in placed and path.name != LAST]
    last = [path for path in files if path.name == LAST]
    return [item for path in (*placed, *rest, *last) for item in files[path]]


def together(test: str) -> str:
    """Tests for which this is the same run in one worker: those of a file, and of who shares."""
    file = test.split("::", 1)[0]
    return ONE_NETWORK[0] if file.startswith(ONE_NETWORK) else SHARING.get(file, file)


class Scheduling(LoadFileScheduling):
    """As `--dist loadfile`, with the files that are `SHARING`."""

    def _split_scope(self, nodeid: str) -> str:
        return together(nodeid)


class Room:
    """A room that many processes share, until one of them wants it alone.

    Whoever wants it alone waits at the door until those who are inside have left, and nobody else
    comes in before it. The folder is the same for all who share it.
    """

    def __init__(self, folder: Path) -> None:
        self._door, self._room = folder / "door", folder / "room"

    @contextmanager
    def shared(self) -> Iterator[None]:
        with self._room.open("w") as room:
            with self._door.open("w") as door:
                fcntl.flock(door, fcntl.LOCK_EX)
                fcntl.flock(room, fcntl.LOCK_SH)
            yield

    @contextmanager
    def alone(self) -> Iterator[None]:
        with self._room.open("w") as room:
            with self._door.open("w") as door:
                fcntl.flock(door, fcntl.LOCK_EX)
                fcntl.flock(room, fcntl.LOCK_EX)
            yield
