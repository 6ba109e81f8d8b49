"""Files that the program wrote itself and reads when it starts: a damaged one never stops it.

What cannot be used is renamed, so that nothing is lost or written over, and the program goes on as
if the file had never been there.
"""

import os
import stat
from collections.abc import Callable
from pathlib import Path
from typing import TypeVar

from edgevox.core.files.user_file import LARGEST_TEXT_BYTES, read_text
from edgevox.core.log import get_logger

log = get_logger(__name__)

T = TypeVar("T")

BROKEN = ".broken-"
MOST_ASIDE = 100
"""So many damaged files of one name are kept; of more, each stays where it is, unused."""


class StateFiles:
    """Reads state, keeps aside what it cannot use, and says so once: in the log, and as `fault`."""

    def __init__(self) -> None:
        self._faults: dict[Path, str] = {}

    @property
    def fault(self) -> str:
        """Which files could not be used since the start; empty if all could. From any thread."""
        return "; ".join(tuple(self._faults.values()))

    def read(self, file: Path, parse: Callable[[str], T], *, secret: bool = False) -> T | None:
        """What `parse` makes of the file's text; None where there is no file, or none to be used.

        A file is of no use if it is no regular one, is too large, is no text, or if `parse` raises.
        Nothing of a `secret` one stands in the log. Raises `OSError` where it is not known what the
        file holds: what you may not read now need not be damaged.
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
        """Have this folder. What stands in its place is kept aside. Raises `OSError`."""
        if os.path.lexists(folder) and not folder.is_dir():
            self.keep_aside(folder, f"{folder}: expected a folder")
        folder.mkdir(parents=True, exist_ok=True, mode=0o700)

    def keep_aside(self, file: Path, reason: str) -> None:
        """Rename what is of no use for this reason, if anything is there."""
        if not os.path.lexists(file):
            return
        aside = _rename(file)
        if file in self._faults and not aside:
            return  # told already, and it could not be moved then, either
        kept = f"is kept as {aside}" if aside else "could not be renamed and stays unused"
        self._faults[file] = f"{file.name} was damaged and {kept}"
        log.error("state_kept_aside", file=str(file), aside=str(aside or ""), reason=reason)


def _is_regular(file: Path) -> bool:
    """Whether it is, or leads to, a regular file. Raises `OSError`, also where nothing is there."""
    try:
        return stat.S_ISREG(os.stat(file).st_mode)
    except FileNotFoundError:
        if os.path.lexists(file):  # a link to nothing
            return False
        raise
    except OSError:
        if os.path.islink(file):  # a link to itself
            return False
        raise


def _rename(file: Path) -> Path | None:
    """Its new name, which nothing had; None if it stays where it is."""
    names = (file.with_name(f"{file.name}{BROKEN}{number}") for number in range(1, MOST_ASIDE + 1))
    aside = next((name for name in names if not os.path.lexists(name)), None)
    if aside is None:
        return None
    try:
        os.rename(file, aside)
    except OSError:  # a disk that is read-only, or a file that is mounted there
        return None
    return aside
