"""Opening of files that people name: only regular ones, of a bounded size, and without waiting.

A pipe would block, a device may have no end, and both look like files until they are open.
"""

import errno
import os
import stat
from pathlib import Path
from typing import BinaryIO

from edgevox.core.errors import InvalidValue

LARGEST_TEXT_BYTES = 1_000_000


def regular(path: str, flags: int) -> int:
    """An `opener` for `open` that raises `OSError` at once if the path is no regular file."""
    number = os.open(path, flags | os.O_NONBLOCK | os.O_NOCTTY | os.O_CLOEXEC, 0o666)
    mode = os.fstat(number).st_mode
    if stat.S_ISREG(mode):
        return number
    os.close(number)
    code = errno.EISDIR if stat.S_ISDIR(mode) else errno.EINVAL
    raise OSError(code, "Is a directory" if stat.S_ISDIR(mode) else "Not a regular file", path)


def open_file(file: Path, field: str, most_bytes: int) -> BinaryIO:
    """Open a file to read. Raises `InvalidValue`, naming `field`, if it is no file or too large."""
    try:
        stream = open(file, "rb", opener=regular)  # noqa: SIM115 - the caller's
    except (OSError, ValueError) as error:  # a name may hold a NUL
        reason = getattr(error, "strerror", None) or str(error)
        raise InvalidValue(field, str(file), f"a file that can be read ({reason})") from None
    if os.fstat(stream.fileno()).st_size > most_bytes:
        stream.close()
        raise _too_large(file, field, most_bytes)
    return stream


def read_text(file: Path, field: str) -> str:
    """The file's text. Raises `InvalidValue`, naming `field`, if it is no readable small text."""
    with open_file(file, field, LARGEST_TEXT_BYTES) as stream:
        try:
            data = stream.read(LARGEST_TEXT_BYTES + 1)
            if len(data) > LARGEST_TEXT_BYTES:  # it grew, or is one of /proc, which have no size
                raise _too_large(file, field, LARGEST_TEXT_BYTES)
            return data.decode("utf-8")
        except OSError as error:
            raise InvalidValue(
                field, str(file), f"a file that can be read ({error.strerror})"
            ) from None
        except UnicodeDecodeError:
            raise InvalidValue(field, str(file), "a text in UTF-8") from None


def size_bytes(file: Path) -> int:
    """The size of a regular file; 0 if it is none, or was removed."""
    try:
        seen = file.stat()  # once: it may vanish between two questions
    except OSError:
        return 0
    return seen.st_size if stat.S_ISREG(seen.st_mode) else 0


def _too_large(file: Path, field: str, most_bytes: int) -> InvalidValue:
    return InvalidValue(field, str(file), f"at most {most_bytes} bytes")
