"""The room that recordings have on the disk, and which files go for others."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from edgevox.core.clock import Clock
from edgevox.core.files.user_file import size_bytes
from edgevox.core.log import get_logger
from edgevox.ros2.recorder.mcap import Bag
from edgevox.ros2.recordings import (
    WhenFull,
    finished,
    folders,
    held,
    opened,
    removable,
    remove,
    used_bytes,
)

log = get_logger(__name__)

MB = 1_000_000
COUNT_S = 5.0
"""The files of other recordings are counted after this time again."""


@dataclass(frozen=True)
class Disk:
    """The folder to write to, and the limits on its files."""

    folder: Path
    """One for this recording alone; others are beside it."""
    most_bytes: int = 256 * MB
    """The largest size of one file."""
    spare_bytes: int = 100 * MB
    """Free space that is left to others."""
    total_bytes: int | None = None
    """The size that all recordings together may reach; None for no limit."""
    when_full: WhenFull = WhenFull.END


class Room:
    """Looks whether there is room for what a bag will write, on the thread that writes it."""

    def __init__(
        self, disk: Disk, bag: Bag, clock: Clock, free_bytes: Callable[[Path], int]
    ) -> None:
        self._disk = disk
        self._bag = bag
        self._clock = clock
        self._free_bytes = free_bytes
        self._others_bytes = 0
        self._count_at_s = 0.0
        self._removed_until_s = 0.0
        self.free_bytes = 0
        """Free space on the disk, at the last look."""

    @property
    def used_bytes(self) -> int:
        """The bytes of all recordings, at the last look and with what was written since."""
        return self._others_bytes + self._bag.size

    @property
    def over(self) -> bool:
        """Whether the recordings have all that they may have."""
        most = self._disk.total_bytes
        return most is not None and self.used_bytes >= most

    def find(self) -> str:
        """Make room, if that is asked for; the reason why there is none, else empty.

        Raises `OSError`.
        """
        ring = self._disk.when_full is WhenFull.RING
        self._look()
        while ring and self.over and self._remove_oldest():
            self._look()
        if self._disk.when_full is not WhenFull.END and self.over:
            most = self._disk.total_bytes or 0
            return f"recordings have {self.used_bytes // MB} MB, and may have {most // MB} MB"
        spare = self._disk.spare_bytes
        if self.free_bytes < spare and not (ring and self._spare_one()):
            left = self.free_bytes // MB
            return f"the disk is full: {left} MB are left, {spare // MB} MB are for others"
        return ""

    def _look(self) -> None:
        now_s = self._clock.now()
        if now_s >= self._count_at_s:
            self._others_bytes = used_bytes(self._disk.folder.parent) - self._bag.size
            self._count_at_s = now_s + COUNT_S
        self.free_bytes = self._free_bytes(self._disk.folder)

    def _spare_one(self) -> bool:
        """Remove one file every few seconds: a disk may take a while to tell that it has room."""
        now_s = self._clock.now()
        if now_s < self._removed_until_s:
            return True
        if not self._remove_oldest():
            return False
        self._removed_until_s = now_s + COUNT_S
        return True

    def _remove_oldest(self) -> bool:
        """Remove the oldest file that may go, of others' recordings first; False without any."""
        self._count_at_s = 0.0
        own = self._bag.folder
        for folder in folders(self._disk.folder.parent):
            if folder == own or not removable(folder):
                continue
            with held(folder) as ours:
                if ours and not opened(folder):
                    return _tell(removable(folder)[0], remove)
        return any(_tell(file, self._bag.remove) for file in finished(own)[:1])


def _tell(file: Path, remove_it: Callable[[Path], None]) -> bool:
    size = size_bytes(file)
    remove_it(file)
    log.info("recording_removed", file=file.name, bytes=size)
    return True
