"""The folders of recordings: the names of their files, their bytes, and which goes first.

A recording is a folder `edgevox-TIME`; `-002` follows where the clock was set back. What is being
written, or was left so, ends with `.open`: `edgevox-TIME_0.mcap.open`, `metadata.yaml.open`. A file
gets its own name in one step, once all of it is on the disk. `.broken` is at the end of a file in
which nothing can be read. Whoever writes to a folder, or mends or removes what is in it, holds its
lock, which ends with the process.
"""

import fcntl
import os
import re
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from datetime import UTC, datetime
from enum import StrEnum
from itertools import count
from pathlib import Path

from edgevox.core.files.state_files import sync_folder
from edgevox.core.files.user_file import size_bytes

PREFIX = "edgevox-"
"""The beginning of a recording's name. Folders with other names are not looked at."""
TIME = "%Y%m%d-%H%M%S"
"""What follows it: the start, in UTC."""
_TIME_LENGTH = len("20261128-120000")
OPEN = ".open"
BROKEN = ".broken"
METADATA = "metadata.yaml"
UPLOAD_FAILED, UPLOAD_DONE = "upload.failed", "upload.done"
"""The uploader's notes beside the recordings. The first is there for as long as its runs fail; the
second is as old as the begin of its last run that did not, and holds the seconds between two."""
UPLOAD_TAKES_S = 2 * 3600.0
"""A file that waits for longer than this, and the seconds between two runs, waits too long."""
_NUMBER = re.compile(r"_(\d+)\.mcap")


class WhenFull(StrEnum):
    """What happens once all recordings together have the bytes that they may have."""

    END = "end"
    """The recording ends."""
    WAIT = "wait"
    """Nothing is recorded until files were moved away."""
    RING = "ring"
    """The oldest finished files are removed, also where the disk has no room to spare."""


def new_folder(output: Path, now: datetime) -> Path:
    """The folder of a recording that begins now, which is not there yet."""
    first = output / f"{PREFIX}{now.astimezone(UTC):{TIME}}"
    if not first.exists():
        return first
    others = (first.with_name(f"{first.name}-{number:03}") for number in count(2))
    return next(one for one in others if not one.exists())


def begun(folder: Path) -> float | None:
    """When a recording began by the robot's clock, in seconds since 1970; None if nobody knows."""
    told = folder.name.removeprefix(PREFIX)[:_TIME_LENGTH]
    try:
        return datetime.strptime(f"{told}Z", f"{TIME}%z").timestamp()
    except ValueError:
        return None


def folders(output: Path) -> list[Path]:
    """The recordings in a folder, the oldest by name first; none where there is no such folder."""
    return sorted(one for one in output.glob(f"{PREFIX}*") if one.is_dir())


def used_bytes(output: Path) -> int:
    """The bytes of all recordings in a folder, with those that are written or broken."""
    return sum(size_bytes(file) for folder in folders(output) for file in _in(folder))


def upload_fault(output: Path, now_s: float) -> str:
    """Why recordings do not reach the store; empty if they do, or if no uploader was ever here."""
    if (output / UPLOAD_FAILED).exists():
        return "the upload fails: see the uploader's log"
    done = output / UPLOAD_DONE
    try:
        began_s, every_s = done.stat().st_mtime, int(done.read_text("ascii"))
    except (OSError, ValueError):
        return ""
    ends = (_changed_s(file) for folder in folders(output) for file in finished(folder))
    first_s = min((end_s for end_s in ends if end_s > began_s), default=now_s)
    if now_s - first_s <= UPLOAD_TAKES_S + every_s:
        return ""
    since = datetime.fromtimestamp(began_s, UTC)
    return f"nothing was uploaded since {since:%Y-%m-%d %H:%M} UTC: see the uploader's log"


def file_number(name: str) -> int:
    """The place of a file in its recording."""
    found = _NUMBER.search(name)
    return int(found[1]) if found else 0


def opened(folder: Path) -> list[Path]:
    """The files of a recording that were not finished, in their order."""
    return _in(folder, f".mcap{OPEN}")


def finished(folder: Path) -> list[Path]:
    """The files of a recording that are whole, in their order."""
    return _in(folder, ".mcap")


def give_name(file: Path) -> None:
    """Take `.open` off the name of a file that is whole and on the disk. Raises `OSError`."""
    os.replace(file, file.with_suffix(""))
    sync_folder(file.parent)


def hold(folder: Path) -> int | None:
    """Lock a recording; its lock ends when this file is closed. None where another has it.

    Raises `OSError`.
    """
    number = os.open(folder, os.O_RDONLY | os.O_DIRECTORY | os.O_CLOEXEC)
    try:
        fcntl.flock(number, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        os.close(number)
        return None
    except OSError:
        os.close(number)
        raise
    return number


@contextmanager
def held(folder: Path) -> Iterator[bool]:
    """Lock a recording for a while; False where another has it. Raises `OSError`."""
    number = hold(folder)
    try:
        yield number is not None
    finally:
        if number is not None:
            os.close(number)


def removable(folder: Path) -> Sequence[Path]:
    """The files of a recording that may go for others, the oldest first."""
    return _in(folder, ".mcap", f".mcap{BROKEN}")


def remove(file: Path) -> None:
    """Remove a file of a finished recording, whose `metadata.yaml` would name it, goes first.

    The files that are left play by themselves. Raises `OSError`.
    """
    (file.parent / METADATA).unlink(missing_ok=True)
    file.unlink(missing_ok=True)
    with suppress(OSError):  # there are more files
        file.parent.rmdir()


def _changed_s(file: Path) -> float:
    """When a file was changed last, in seconds since 1970; 0 if it was removed just now."""
    try:
        return file.stat().st_mtime
    except FileNotFoundError:
        return 0.0


def _in(folder: Path, *ends: str) -> list[Path]:
    """The files of a recording with one of these ends, or all; none if it was removed just now."""
    try:
        found = [file for file in folder.iterdir() if not ends or file.name.endswith(ends)]
    except FileNotFoundError:
        return []
    return sorted(found, key=lambda file: (file_number(file.name), file.name))
