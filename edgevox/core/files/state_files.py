"""State files, which the program writes itself and reads at its start; damage never stops it.

They are written atomically: after a power cut, a file holds the old text or the new one, never a
mixture. A file that cannot be used is renamed, so that nothing is lost or overwritten, and the
program goes on as if the file had never existed.
"""

import os
import stat
from collections.abc import Callable
from pathlib import Path
from typing import TypeVar

from edgevox.core.files.user_file import LARGEST_TEXT_BYTES, read_text
from edgevox.core.log import get_logger

log = get_logger(__name__)

PRIVATE = 0o600
PUBLIC = 0o666
"""Permissions of a public file, from which the process's umask is taken."""


def write_atomically(file: Path, content: str | bytes, mode: int = PRIVATE) -> None:
    """Write a text or bytes with these permissions. After an `OSError` the file is unchanged.

    Only one writer may write a file at a time; it replaces the partial file of an earlier one.
    """
    partial = file.with_name(f".{file.name}.partial")
    try:
        _write(partial, content.encode("utf-8") if isinstance(content, str) else content, mode)
        os.replace(partial, file)
    except OSError:
        partial.unlink(missing_ok=True)
        raise
    sync_folder(file.parent)


def _write(file: Path, data: bytes, mode: int) -> None:
    file.unlink(missing_ok=True)  # of any kind: opening a pipe would block
    flags = os.O_WRONLY | os.O_CREAT | os.O_EXCL | os.O_NOFOLLOW | os.O_CLOEXEC
    with open(os.open(file, flags, mode), "wb") as stream:
        stream.write(data)
        stream.flush()
        os.fsync(stream.fileno())


def sync_folder(folder: Path) -> None:
    """Make sure that the new name is on the disk as well."""
    number = os.open(folder, os.O_RDONLY | os.O_DIRECTORY | os.O_CLOEXEC)
    try:
        os.fsync(number)
    finally:
        os.close(number)


T = TypeVar("T")

BROKEN = ".broken-"
MOST_ASIDE = 100
"""Number of damaged files of one name that are renamed; a further one stays in place, unused."""


class StateFiles:
    """Reads state files and renames unusable ones; reports each once, in the log and as `fault`."""

    def __init__(self) -> None:
        self._faults: dict[Path, str] = {}

    @property
    def fault(self) -> str:
        """The files that could not be used since the start; empty if none. Any thread may ask."""
        return "; ".join(tuple(self._faults.values()))

    def read(self, file: Path, parse: Callable[[str], T], *, secret: bool = False) -> T | None:
        """The result of `parse` for the file's text; None without a usable file.

        A file is unusable if it is not regular, too large or no text, or if `parse` raises. The
        log shows nothing of a `secret` file. Raises `OSError` for a file that cannot be read now,
        since it may be intact.
        """
        try:
            if _is_regular(file):
                open(file, "rb").close()  # raises for what may not be read
                return parse(read_text(file, str(file)))
            reason = f"{file}: expected a regular file of at most {LARGEST_TEXT_BYTES} bytes"
        except FileNotFoundError:
            return None
        except OSError:
            raise
        except Exception as error:  # noqa: BLE001 - a damaged file breaks a parser in any way
            told = type(error).__name__ if secret else str(error) or repr(error)
            reason = f"{file}: damaged ({told})" if secret else told
        self.keep_aside(file, reason)
        return None

    def make_folder(self, folder: Path) -> None:
        """Make a folder; rename another file in its place. Raises `OSError`."""
        if os.path.lexists(folder) and not folder.is_dir():
            self.keep_aside(folder, f"{folder}: expected a folder")
        folder.mkdir(parents=True, exist_ok=True, mode=0o700)

    def keep_aside(self, file: Path, reason: str) -> None:
        """Rename an unusable file, if it exists, and report the reason."""
        if not os.path.lexists(file):
            return
        aside = _rename(file)
        if file in self._faults and not aside:
            return  # reported already: it could not be renamed before either
        kept = f"is kept as {aside}" if aside else "could not be renamed and stays unused"
        self._faults[file] = f"{file.name} was damaged and {kept}"
        log.error("state_kept_aside", file=str(file), aside=str(aside or ""), reason=reason)


def _is_regular(file: Path) -> bool:
    """True for a regular file or a link to one. Raises `OSError`, also for a missing file."""
    found = os.lstat(file)  # asked once: another process may make the file at any moment
    if not stat.S_ISLNK(found.st_mode):
        return stat.S_ISREG(found.st_mode)
    try:
        return stat.S_ISREG(os.stat(file).st_mode)
    except OSError:
        return False  # a link to nothing, or to itself


def _rename(file: Path) -> Path | None:
    """Rename a file to an unused name and return that; None if it stays in place."""
    names = (file.with_name(f"{file.name}{BROKEN}{number}") for number in range(1, MOST_ASIDE + 1))
    aside = next((name for name in names if not os.path.lexists(name)), None)
    if aside is None:
        return None
    try:
        os.rename(file, aside)
    except OSError:  # a disk that is read-only, or a file that is mounted there
        return None
    return aside
