"""MCAP recordings that stay readable up to the last flush, whatever happens to process or disk.

`McapFile` is one file. `mcap` makes the bytes and this module brings them to the disk, because the
writer of `rosbags` (whose reader checks these files in the tests) opens the file itself and offers
no flush: a killed process would lose up to a megabyte, a full disk would leave half a record, and
files would not be split.

`Bag` is a recording: a folder of MCAP files that follow each other, with the `metadata.yaml` of
rosbag2. Each has its name only once it is whole (`recordings`).

`definition_of` reads the text of a message type's definition, with all types that it refers to,
from the installed interfaces, comments and all. `rosbags` would write its own text for the types
that it knows, and bring four packages into the image.
"""

import importlib.util
import json
import os
import re
from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import IO, cast

from mcap.writer import Writer

from edgevox import __version__
from edgevox.core.errors import EdgeVoxError
from edgevox.core.files.state_files import sync_folder
from edgevox.ros2.recorder.mend import mend_files
from edgevox.ros2.recorder.metadata import FileInfo, RecordingInfo, TopicInfo, qos_yaml
from edgevox.ros2.recorder.recorded_topics import Recorded
from edgevox.ros2.recordings import OPEN, give_name, hold

_SEPARATOR = "=" * 80
_FIELD = re.compile(r"^\s*(?P<type>[A-Za-z][\w/]*)(?:<=\d+)?(?:\[[^\]]*\])?\s+[A-Za-z]\w*")
_PRIMITIVES = frozenset(
    {
        *("bool", "byte", "char", "float32", "float64", "string", "wstring"),
        *("int8", "int16", "int32", "int64", "uint8", "uint16", "uint32", "uint64"),
    }
)
_HASH = "type_hashes"


class DefinitionMissing(EdgeVoxError):
    """The `.msg` file of a type is nowhere to be found."""


def definition(kind: str) -> str:
    """All of `package/msg/Type` in the format that MCAP calls ros2msg.

    Raises `DefinitionMissing`.
    """
    known = {kind: _read(kind)}
    waiting = [kind]
    while waiting:
        one = waiting.pop()
        for inner in _refers_to(known[one], one.partition("/")[0]):
            if inner not in known:
                known[inner] = _read(inner)
                waiting.append(inner)
    parts = [known.pop(kind).rstrip("\n")]
    for name, text in known.items():
        parts.append(f"{_SEPARATOR}\nMSG: {name.replace('/msg/', '/')}\n{text.rstrip()}")
    return "\n".join(parts) + "\n"


def type_hash(kind: str) -> str:
    """The REP 2016 hash of a type, as a publisher offers it; empty where it was not installed."""
    file = _file(kind, ".json")
    if file is None:
        return ""
    hashes = json.loads(file.read_text(encoding="utf-8")).get(_HASH, ())
    return next((str(one["hash_string"]) for one in hashes if one["type_name"] == kind), "")


def _refers_to(text: str, package: str) -> Iterator[str]:
    for line in text.splitlines():
        found = _FIELD.match(line.partition("#")[0])
        if found is None or found["type"] in _PRIMITIVES:
            continue
        names = found["type"].split("/")
        yield f"{names[0] if len(names) > 1 else package}/msg/{names[-1]}"


def _read(kind: str) -> str:
    file = _file(kind, ".msg")
    if file is None:
        raise DefinitionMissing(f"{kind}: got no .msg file, expected one in an ament prefix")
    return file.read_text(encoding="utf-8")


def _file(kind: str, suffix: str) -> Path | None:
    package = kind.partition("/")[0]
    candidates = (prefix / "share" / f"{kind}{suffix}" for prefix in _prefixes(package))
    return next((file for file in candidates if file.is_file()), None)


def _prefixes(package: str) -> Iterator[Path]:
    """Return the module's install prefix, then those in the environment."""
    spec = importlib.util.find_spec(package)
    if spec and spec.origin:
        yield from list(Path(spec.origin).parents)[3:6]  # PREFIX[/local]/lib/pythonX/site-packages
    for prefix in os.environ.get("AMENT_PREFIX_PATH", "").split(os.pathsep):
        if prefix:
            yield Path(prefix)


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
    It is written under `open_path`; whoever finished it gives it its name.
    """

    def __init__(self, path: Path) -> None:
        self.open_path = path.with_name(f"{path.name}{OPEN}")
        self.info = FileInfo(path.name)
        self._buffer = _Buffer()
        self._writer = Writer(cast("IO[bytes]", self._buffer))
        self._channels: dict[str, int] = {}
        self._topics: dict[str, TopicInfo] = {}
        self._schemas: dict[str, int] = {}
        self._sequence: dict[str, int] = {}
        self._file = os.open(self.open_path, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o644)
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
        self.info.count(self._topics[name], message.received_ns, message.received_ns)

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
        told = TopicInfo(topic.name, topic.type, qos_yaml(topic.qos), type_hash(topic.type))
        self._topics[topic.name] = told
        about = {"offered_qos_profiles": told.qos, "topic_type_hash": told.type_hash}
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
    """Begins another file when one is full. Every method but `lose_file` may raise `OSError`.

    Its folder is locked until it is closed, so that no other recorder mends its files.
    """

    def __init__(self, folder: Path, most_bytes: int) -> None:
        self.folder = folder
        self._most_bytes = most_bytes
        self._info = RecordingInfo()
        self._unnamed: list[Path] = []
        """Files that are whole, and have not got their names yet."""
        self._begun = 0
        self._ended_bytes = 0
        self._file: McapFile | None = None
        folder.mkdir(parents=True)
        sync_folder(folder.parent)
        self._lock = hold(folder)

    @property
    def files(self) -> int:
        """The number of files that were begun."""
        return self._begun

    @property
    def size(self) -> int:
        """The bytes that were written, also of files that have gone since."""
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
        if self._unnamed:
            self._name()

    def end_file(self, notes: dict[str, str]) -> None:
        """Close the file that is open, if there is one, with `notes`; `write` begins another."""
        file = self._file
        if file is None:
            return
        if not file.info.messages:  # nothing is lost with it
            self.lose_file()
            file.open_path.unlink(missing_ok=True)
            self._ended_bytes -= file.size
            return
        file.finish(notes)
        self._file = None
        self._ended_bytes += file.size
        self._info.add(file.info)
        self._unnamed.append(file.open_path)
        self._name()

    def lose_file(self) -> None:
        """Give up the file that is open: what was flushed stays in it, for `close` to mend."""
        file, self._file = self._file, None
        if file is None:
            return
        self._ended_bytes += file.size
        with suppress(OSError):
            file.abandon()
            if not file.size:
                file.open_path.unlink()

    def remove(self, file: Path) -> None:
        """Remove one of its finished files; `metadata.yaml` will not name it."""
        self._info.remove(file.name)
        self._info.write(self.folder)
        file.unlink(missing_ok=True)

    def close(self) -> None:
        """Mend the files that were lost, and write `metadata.yaml`. The last call."""
        lock, self._lock = self._lock, None
        try:
            mend_files(self.folder)
        finally:
            if lock is not None:
                os.close(lock)

    def _name(self) -> None:
        # The list of files first: after a kill, a file with its name may have been moved away.
        self._info.write(self.folder)
        while self._unnamed:
            give_name(self._unnamed[0])
            self._unnamed.pop(0)
