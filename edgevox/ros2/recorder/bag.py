"""One recording: a folder of MCAP files that follow each other, as rosbag2 lays them out."""

from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path

from edgevox.ros2.recorder.mcap_file import McapFile, RecordedMessage
from edgevox.ros2.recorder.metadata import FileInfo, write_metadata


class Bag:
    """Begins another file when one is full. Every method but `lose_file` may raise `OSError`."""

    def __init__(self, folder: Path, most_bytes: int) -> None:
        self.folder = folder
        self._most_bytes = most_bytes
        self._finished: list[FileInfo] = []
        self._begun = 0
        self._ended_bytes = 0
        self._told = True
        self._file: McapFile | None = None
        folder.mkdir(parents=True)

    @property
    def files(self) -> int:
        """How many were begun."""
        return self._begun

    @property
    def size(self) -> int:
        """How many bytes of all its files are on the disk."""
        return self._ended_bytes + (self._file.size if self._file else 0)

    def open(self) -> None:
        """Begin a file, unless one is open."""
        if self._file is None:
            path = self.folder / f"{self.folder.name}_{self._begun}.mcap"
            self._file = McapFile(path)
            self._begun += 1

    def write(self, messages: Sequence[RecordedMessage], notes: dict[str, str]) -> None:
        """Bring these to the disk; `catch_up` does what this could not. `notes`: see `end_file`."""
        self.open()
        file = self._file
        if file is None:
            return
        for message in messages:
            file.write(message)
        file.flush()
        if file.size >= self._most_bytes:
            self.end_file(notes)

    def catch_up(self, notes: dict[str, str]) -> None:
        """Bring to the disk what it did not take before. Call it before the next `write`."""
        if self._file is not None and self._file.ended:
            self.end_file(notes)
        elif self._file is not None:
            self._file.flush()
        if not self._told:
            self._tell()

    def end_file(self, notes: dict[str, str]) -> None:
        """Close the file that is open, if there is one, with `notes`; `write` begins another."""
        file = self._file
        if file is None:
            return
        if not file.info.messages:  # nothing is lost with it
            self.lose_file()
            file.path.unlink(missing_ok=True)
            self._ended_bytes -= file.size
            return
        file.finish(notes)
        self._file = None
        self._ended_bytes += file.size
        self._finished.append(file.info)
        self._tell()

    def lose_file(self) -> None:
        """Give up the file that is open: what was flushed stays in it."""
        file, self._file = self._file, None
        if file is None:
            return
        self._ended_bytes += file.size
        with suppress(OSError):
            file.abandon()
            if not file.size:
                file.path.unlink()

    def _tell(self) -> None:
        self._told = False
        write_metadata(self.folder, self._finished)
        self._told = True
