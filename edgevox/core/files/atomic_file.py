"""Writes a file so that whoever reads it, after a power cut too, finds the old text or the new."""

import os
from pathlib import Path

PRIVATE = 0o600
PUBLIC = 0o666
"""Less what the process's umask takes away, as of any file."""


def write_atomically(file: Path, text: str, mode: int = PRIVATE) -> None:
    """Put this text there, with these permissions. Raises `OSError`, and then it is as it was.

    One writer at a time: what one left behind half is written over by the next.
    """
    partial = file.with_name(f".{file.name}.partial")
    try:
        _write(partial, text.encode("utf-8"), mode)
        os.replace(partial, file)
    except OSError:
        partial.unlink(missing_ok=True)
        raise
    _sync_folder(file.parent)


def _write(file: Path, data: bytes, mode: int) -> None:
    file.unlink(missing_ok=True)  # whatever it is: a pipe would be waited for
    flags = os.O_WRONLY | os.O_CREAT | os.O_EXCL | os.O_NOFOLLOW | os.O_CLOEXEC
    with open(os.open(file, flags, mode), "wb") as stream:
        stream.write(data)
        stream.flush()
        os.fsync(stream.fileno())


def _sync_folder(folder: Path) -> None:
    """The new name is on the disk, too."""
    number = os.open(folder, os.O_RDONLY | os.O_DIRECTORY | os.O_CLOEXEC)
    try:
        os.fsync(number)
    finally:
        os.close(number)
