"""One recording: a folder of MCAP files that follow each other, as rosbag2 lays them out."""

import logging
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path

from edgevox.ros2.recorder.mcap_file import McapFile, Message
from edgevox.ros2.recorder.metadata import FileInfo, write_metadata

log = logging.getLogger(__name__)


class Bag:
    """Begins another file when one is full. Every method but `lose_file` may raise `OSError`."""

    def __init__(self, folder: Path, most_bytes: int) -> None:
        self.folder = folder
        self._most_bytes = most_bytes
        self._finished: list[FileInfo] = []
        self._begun = 0
        self._file: McapFile | None = None
        folder.mkdir(parents=True)

    @property
    def files(self) -> int:
        """How many were begun."""
        return self._begun

    def open(self) -> None:
        """Begin a file, unless one is open."""
        if self._file is None:
            path = self.folder / f"{self.folder.name}_{self._begun}.mcap"
            self._begun += 1
            self._file = McapFile(path)

    def write(self, messages: Sequence[Message], notes: dict[str, str]) -> None:
        """Bring these to the disk. `notes` are put into a file that is full."""
        self.open()
        file = self._file
        if file is None:
            return
        for message in messages:
            file.write(message)
        file.flush()
        if file.size >= self._most_bytes:
            self.end_file(notes)

    def end_file(self, notes: dict[str, str]) -> None:
        """Close the file that is open, if there is one; the next `write` begins another."""
        file, self._file = self._file, None
        if file is None:
            return
        if not file.info.messages:  # nothing is lost with it
            file.abandon()
            file.path.unlink()
            return
        file.finish(notes)
        self._finished.append(file.info)
        write_metadata(self.folder, self._finished)

    def lose_file(self) -> None:
        """Give up the file that is open: what was flushed stays in it."""
        file, self._file = self._file, None
        if file is not None:
            with suppress(OSError):
                file.abandon()
