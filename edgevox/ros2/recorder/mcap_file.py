"""One MCAP file, whole up to its last flush whatever happens to the process or the disk.

`mcap` makes the bytes and we bring them to the disk, because the writer of `rosbags` (whose reader
checks our files in the tests) opens the file itself and offers no flush: a process that is killed
would lose up to a megabyte, a full disk would leave half a record, and nothing would be split.
"""

import os
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import IO, cast

from mcap.writer import Writer

from edgevox import __version__
from edgevox.ros2.recorder.definitions import definition, type_hash
from edgevox.ros2.recorder.metadata import FileInfo, qos_yaml
from edgevox.ros2.recorder.recorded_topics import Recorded


@dataclass(frozen=True, slots=True)
class RecordedMessage:
    """One message as it came, still serialised; both times since 1970."""

    topic: Recorded
    data: bytes
    received_ns: int
    sent_ns: int


class _Buffer:
    """Takes what the writer writes, until somebody takes it from here to the disk."""

    def __init__(self) -> None:
        self._parts: list[bytes] = []
        self._offset = 0

    def write(self, data: bytes) -> int:
        self._parts.append(bytes(data))
        self._offset += len(data)
        return len(data)

    def tell(self) -> int:
        return self._offset

    def flush(self) -> None:
        """There is nothing below."""

    def held(self) -> bytes:
        """All that nobody has taken."""
        return b"".join(self._parts)

    def forget(self) -> None:
        """It was taken."""
        self._parts = []


class McapFile:
    """Is made new; after an `OSError` of `flush` or `finish` it holds what was flushed before.

    What could not be flushed is kept: a later `flush` or `finish` brings it to the disk.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self.info = FileInfo(path.name)
        self._buffer = _Buffer()
        self._writer = Writer(cast("IO[bytes]", self._buffer))
        self._channels: dict[str, int] = {}
        self._schemas: dict[str, int] = {}
        self._sequence: dict[str, int] = {}
        self._file = os.open(path, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o644)
        self.size = 0
        self.ended = False
        """Whether its end was written, if perhaps not yet to the disk."""
        self._writer.start(profile="ros2", library=f"edgevox {__version__}")

    def write(self, message: RecordedMessage) -> None:
        """Add it to what the next flush brings to the disk."""
        name = message.topic.name
        if name not in self._channels:
            self._channels[name] = self._add_channel(message.topic)
        self._sequence[name] = self._sequence.get(name, 0) + 1
        self._writer.add_message(
            self._channels[name],
            log_time=message.received_ns,
            data=message.data,
            publish_time=message.sent_ns,
            sequence=self._sequence[name],
        )
        self.info.count(message.topic, message.received_ns)

    def flush(self) -> None:
        """What was written is in the file, also if the process is killed now."""
        self._writer.flush()
        self._to_disk()

    def finish(self, notes: dict[str, str]) -> None:
        """Write `notes` and the indexes, and close it. May be tried again after an `OSError`."""
        if not self.ended:
            self._writer.flush()
            self._writer.add_metadata("edgevox", notes)
            self._writer.finish()
            self.ended = True
        self._to_disk()
        os.fsync(self._file)
        self.abandon()

    def abandon(self) -> None:
        """Close it as it is: readable, without the indexes at its end."""
        file, self._file = self._file, -1
        if file >= 0:
            os.close(file)

    def _add_channel(self, topic: Recorded) -> int:
        if topic.type not in self._schemas:
            text = definition(topic.type).encode()
            self._schemas[topic.type] = self._writer.register_schema(topic.type, "ros2msg", text)
        about = {
            "offered_qos_profiles": qos_yaml(topic.qos),
            "topic_type_hash": type_hash(topic.type),
        }
        return self._writer.register_channel(topic.name, "cdr", self._schemas[topic.type], about)

    def _to_disk(self) -> None:
        left = memoryview(self._buffer.held())
        written = 0
        try:
            while left:
                done = os.write(self._file, left)
                left, written = left[done:], written + done
        except OSError:
            with suppress(OSError):
                os.ftruncate(self._file, self.size)
                os.lseek(self._file, self.size, os.SEEK_SET)
            raise
        self._buffer.forget()
        self.size += written
