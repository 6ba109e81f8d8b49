"""MCAP recordings that stay readable up to the last flush, whatever happens to process or disk.

`McapFile` is one file. `mcap` makes the bytes and this module brings them to the disk, because the
writer of `rosbags` (whose reader checks these files in the tests) opens the file itself and offers
no flush: a killed process would lose up to a megabyte, a full disk would leave half a record, and
files would not be split.

`Bag` is a recording: a folder of MCAP files that follow each other, with the `metadata.yaml` of
rosbag2.
"""

import os
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import IO, Any, cast

import yaml
from mcap.writer import Writer

from edgevox import __version__
from edgevox.core.files.atomic_file import PUBLIC, write_atomically
from edgevox.ros2.contract_rows import QosSpec
from edgevox.ros2.recorder.definitions import definition, type_hash
from edgevox.ros2.recorder.recorded_topics import Recorded

NAME = "metadata.yaml"
VERSION = 9
"""The version of rosbag2's format in Jazzy."""
_FOR_EVER = {"sec": 9223372036, "nsec": 854775807}


@dataclass
class FileInfo:
    """The contents of one file."""

    name: str
    first_ns: int = 0
    last_ns: int = 0
    counts: dict[Recorded, int] = field(default_factory=dict)

    @property
    def messages(self) -> int:
        """The number of messages in it."""
        return sum(self.counts.values())

    def count(self, topic: Recorded, when_ns: int) -> None:
        """Add one message."""
        self.first_ns = min(self.first_ns or when_ns, when_ns)
        self.last_ns = max(self.last_ns, when_ns)
        self.counts[topic] = self.counts.get(topic, 0) + 1


def qos_yaml(qos: QosSpec) -> str:
    """An offered quality of service, as a channel of an MCAP file names it."""
    return yaml.safe_dump([_qos(qos)], sort_keys=False)


def write_metadata(folder: Path, files: Sequence[FileInfo]) -> None:
    """Write it for these finished files; it is whole or as it was. Raises `OSError`."""
    text = yaml.safe_dump({"rosbag2_bagfile_information": _describe(files)}, sort_keys=False)
    write_atomically(folder / NAME, text, PUBLIC)


def _describe(files: Sequence[FileInfo]) -> dict[str, Any]:
    heard = [one for one in files if one.messages]
    first_ns = min((one.first_ns for one in heard), default=0)
    last_ns = max((one.last_ns for one in heard), default=0)
    counts: dict[Recorded, int] = {}
    for one in files:
        for topic, number in one.counts.items():
            counts[topic] = counts.get(topic, 0) + number
    return {
        "version": VERSION,
        "storage_identifier": "mcap",
        **_span(first_ns, last_ns),
        "message_count": sum(counts.values()),
        "topics_with_message_count": [
            {"topic_metadata": _topic(topic), "message_count": number}
            for topic, number in counts.items()
        ],
        "compression_format": "",
        "compression_mode": "",
        "relative_file_paths": [one.name for one in files],
        "files": [
            {"path": one.name, **_span(one.first_ns, one.last_ns), "message_count": one.messages}
            for one in files
        ],
        "custom_data": None,
        "ros_distro": os.environ.get("ROS_DISTRO", "jazzy"),
    }


def _span(first_ns: int, last_ns: int) -> dict[str, Any]:
    return {
        "starting_time": {"nanoseconds_since_epoch": first_ns},
        "duration": {"nanoseconds": last_ns - first_ns},
    }


def _topic(topic: Recorded) -> dict[str, Any]:
    return {
        "name": topic.name,
        "type": topic.type,
        "serialization_format": "cdr",
        "offered_qos_profiles": [_qos(topic.qos)],
        "type_description_hash": type_hash(topic.type),
    }


def _qos(qos: QosSpec) -> dict[str, Any]:
    return {
        "history": "keep_last",
        "depth": qos.depth,
        "reliability": "reliable" if qos.reliable else "best_effort",
        "durability": "transient_local" if qos.transient_local else "volatile",
        "deadline": dict(_FOR_EVER),
        "lifespan": dict(_FOR_EVER),
        "liveliness": "automatic",
        "liveliness_lease_duration": dict(_FOR_EVER),
        "avoid_ros_namespace_conventions": False,
    }


@dataclass(frozen=True, slots=True)
class RecordedMessage:
    """A message as it came, still serialised."""

    topic: Recorded
    data: bytes
    received_ns: int
    """Nanoseconds of Unix time."""
    sent_ns: int
    """Nanoseconds of Unix time."""


class _Buffer:
    """Takes the writer's bytes, until they are taken to the disk."""

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
        """Do nothing: there is no layer below."""

    def held(self) -> bytes:
        """The bytes that were not taken yet."""
        return b"".join(self._parts)

    def forget(self) -> None:
        """Drop the bytes, which were written."""
        self._parts = []


class McapFile:
    """A new file; after an `OSError` of `flush` or `finish` it holds the earlier flushes.

    Bytes that could not be flushed are kept: a later `flush` or `finish` brings them to the disk.
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
        """Whether its end was written, though perhaps not to the disk yet."""
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
        """Bring the messages to the file, so that they survive a kill of the process."""
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
        """The number of files that were begun."""
        return self._begun

    @property
    def size(self) -> int:
        """The bytes of all its files on the disk."""
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
