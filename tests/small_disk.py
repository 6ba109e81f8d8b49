"""A real disk of a megabyte, which can be filled up and freed again."""

import os
import subprocess
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

_ROOT = [] if os.geteuid() == 0 else ["sudo", "--non-interactive"]


class SmallDisk:
    """A tmpfs; `path` is a folder in it."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self._filler = path / "filler"

    def fill(self) -> None:
        """Somebody else takes all the room there is."""
        with self._filler.open("ab", buffering=0) as filler:
            while os.statvfs(self.path).f_bavail:
                with suppress(OSError):
                    filler.write(b"x" * 4096)

    def seal(self, *, sealed: bool = True) -> None:
        """Nothing can be written any more, by root neither; or it can again."""
        mode = "ro" if sealed else "rw"
        subprocess.run([*_ROOT, "mount", "-o", f"remount,{mode}", str(self.path)], check=True)

    def free(self) -> None:
        """There is room again."""
        self._filler.unlink()


@contextmanager
def small_disk(at: Path, size_kb: int = 1024) -> Iterator[SmallDisk]:
    """Mount it; needs root, or sudo without a password, as .ci/run does."""
    at.mkdir()
    options = f"size={size_kb}k,mode=1777"
    subprocess.run([*_ROOT, "mount", "-t", "tmpfs", "-o", options, "tmpfs", str(at)], check=True)
    try:
        yield SmallDisk(at)
    finally:
        subprocess.run([*_ROOT, "umount", "--lazy", str(at)], check=True)
