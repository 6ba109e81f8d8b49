"""Atomic writing: after a power cut, a file holds the old text or the new one, never a mixture."""

import os
from pathlib import Path

PRIVATE = 0o600
PUBLIC = 0o666
"""Permissions of a public file, from which the process's umask is taken."""


def write_atomically(file: Path, text: str, mode: int = PRIVATE) -> None:
    """Write a text with these permissions. After an `OSError` the file is unchanged.

    Only one writer may write a file at a time; it replaces the partial file of an earlier one.
    """
    partial = file.with_name(f".{file.name}.partial")
    try:
        _write(partial, text.encode("utf-8"), mode)
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
