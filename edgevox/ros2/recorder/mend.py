"""Ends the files that a kill or a power cut left open, so that every reader opens them.

A file keeps its chunks up to the last whole one, and gets the indexes that its writer could not
write. This happens in place: another copy would need as much room again. It may be cut off at any
moment, and begun again.
"""

import os
import struct
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from io import BytesIO
from pathlib import Path
from typing import BinaryIO
from zlib import crc32

from mcap.data_stream import ReadDataStream, RecordBuilder
from mcap.exceptions import McapError
from mcap.opcode import Opcode
from mcap.records import (
    Channel,
    Chunk,
    ChunkIndex,
    DataEnd,
    Footer,
    McapRecord,
    MessageIndex,
    Metadata,
    MetadataIndex,
    Schema,
    Statistics,
    SummaryOffset,
)
from mcap.stream_reader import get_chunk_data_stream
from mcap.writer import MCAP0_MAGIC as MAGIC

from edgevox.core.log import get_logger
from edgevox.ros2.recorder.metadata import FileInfo, RecordingInfo, TopicInfo
from edgevox.ros2.recordings import (
    BROKEN,
    METADATA,
    OPEN,
    finished,
    folders,
    give_name,
    held,
    opened,
)

log = get_logger(__name__)

_HEAD = struct.Struct("<BQ")
"""A record's kind and length."""
_MESSAGE = struct.Struct("<HIQ")
"""The beginning of a message: channel, sequence, time."""
_FOOTER = struct.Struct("<BQQQ")
MOST_CHUNK_BYTES = 1 << 30
"""A chunk that tells of more is damaged: the writer's have a megabyte and a message."""
_DAMAGED = (McapError, ValueError, LookupError, struct.error)


def mend_recordings(output: Path, stopped: Callable[[], bool]) -> None:
    """Mend all recordings in a folder that nobody writes, until `stopped`.

    What could not be written is logged, and left for the next time.
    """
    for folder in folders(output):
        if stopped():
            return
        left = opened(folder) or list(folder.glob(f"{METADATA}{OPEN}"))
        if not left:
            continue
        try:
            with held(folder) as ours:
                if ours:
                    mend_files(folder)
        except OSError as error:
            reason = str(error.strerror or error)
            log.warning("recording_not_mended", folder=str(folder), reason=reason)


def mend_files(folder: Path) -> None:
    """Give all files of a recording their ends and names, and it its `metadata.yaml`.

    The caller has locked the folder. Raises `OSError`; then it is to be called again.
    """
    info = RecordingInfo.read(folder)
    whole: list[Path] = []
    for path in opened(folder):
        mended = _end(path)
        if mended:
            info.add(mended)
            whole.append(path)
    for path in finished(folder):
        if path.name not in info.files:
            with path.open("rb") as stream:
                contents = _scan(stream, path.name).info
            if contents.messages:
                info.add(contents)
    unfinished = folder / f"{METADATA}{OPEN}"
    if not info.files:
        unfinished.unlink(missing_ok=True)
        return
    info.write(folder)
    for path in whole:
        give_name(path)
    give_name(unfinished)


def _end(path: Path) -> FileInfo | None:
    """End one file; None where it has no message: it is removed if it is empty, else broken."""
    name = path.with_suffix("").name
    size = path.stat().st_size
    with path.open("r+b") as stream:
        found = _scan(stream, name)
        if found.info.messages:
            stream.seek(found.end)
            stream.truncate()
            stream.write(found.rest())
            stream.flush()
            os.fsync(stream.fileno())
    if found.info.messages:
        log.warning("recording_mended", file=name, messages=found.info.messages)
        return found.info
    if found.end == size:
        path.unlink()
    else:
        broken = path.with_suffix(BROKEN)
        path.rename(broken)
        log.error("recording_broken", file=str(broken), bytes=size)
    return None


@dataclass
class _Found:
    """What a file has in front of its indexes, up to `end`."""

    info: FileInfo
    end: int = 0
    schemas: dict[int, Schema] = field(default_factory=dict)
    channels: dict[int, Channel] = field(default_factory=dict)
    counts: dict[int, int] = field(default_factory=dict)
    chunks: list[ChunkIndex] = field(default_factory=list)
    metadata: list[MetadataIndex] = field(default_factory=list)
    last: dict[int, list[tuple[int, int]]] = field(default_factory=dict)
    """Times and places of the last chunk's messages, by channel."""

    def take(self, at: int, kind: int, body: bytes) -> bool:
        """Take in a record that begins at this place; False if the data end in front of it."""
        after = at + _HEAD.size + len(body)
        if kind == Opcode.MESSAGE_INDEX and self.chunks:
            self._take_index(at, after - at, MessageIndex.read(_stream(body)))
            if not self._indexed():
                return True  # the chunk ends here, until all of its indexes are seen
        elif not self._indexed():
            return False
        elif kind == Opcode.CHUNK:
            self._take_chunk(at, after - at, Chunk.read(_stream(body)))
        elif kind == Opcode.METADATA:
            name = Metadata.read(_stream(body)).name
            self.metadata.append(MetadataIndex(offset=at, length=after - at, name=name))
        elif kind != Opcode.HEADER:
            return False
        self.end = after
        return True

    def rest(self) -> bytes:
        """The bytes that belong behind `end`: indexes, summary and footer."""
        made = RecordBuilder()
        if not self._indexed():
            chunk = self.chunks[-1]
            chunk.message_index_offsets.clear()
            for channel, records in self.last.items():
                chunk.message_index_offsets[channel] = self.end + made.count
                MessageIndex(channel, records).write(made)
            chunk.message_index_length = made.count
        DataEnd(0).write(made)
        data = bytes(made.end())
        return data + self._summary(self.end + len(data)) + MAGIC

    def _indexed(self) -> bool:
        return not self.chunks or self.chunks[-1].message_index_offsets.keys() == self.last.keys()

    def _take_index(self, at: int, length: int, index: MessageIndex) -> None:
        chunk = self.chunks[-1]
        if self.last.get(index.channel_id) != index.records:
            raise ValueError("an index of another chunk")
        chunk.message_index_offsets[index.channel_id] = at
        chunk.message_index_length += length

    def _take_chunk(self, at: int, length: int, chunk: Chunk) -> None:
        if chunk.uncompressed_size > MOST_CHUNK_BYTES:
            raise ValueError("a chunk of this size")
        try:
            stream, size = get_chunk_data_stream(chunk, validate_crc=True)
        except Exception as error:  # the library that decompresses has its own, without a root
            raise ValueError(f"a chunk that cannot be decompressed: {error!r}") from error
        schemas, channels, messages = _break_up(stream.read(size))
        known = self.channels | channels
        topics = {one: _topic(known[one], self.schemas | schemas) for one in messages}
        self.schemas |= schemas
        self.channels = known
        self.last = messages
        for one, rows in messages.items():
            self.counts[one] = self.counts.get(one, 0) + len(rows)
            times = [time for time, _ in rows]
            self.info.count(topics[one], min(times), max(times), len(rows))
        self.chunks.append(
            ChunkIndex(
                chunk_length=length,
                chunk_start_offset=at,
                compression=chunk.compression,
                compressed_size=len(chunk.data),
                message_end_time=chunk.message_end_time,
                message_index_length=0,
                message_index_offsets={},
                message_start_time=chunk.message_start_time,
                uncompressed_size=chunk.uncompressed_size,
            )
        )

    def _summary(self, start: int) -> bytes:
        made = RecordBuilder()
        groups: Sequence[tuple[Opcode, Sequence[McapRecord]]] = (
            (Opcode.SCHEMA, list(self.schemas.values())),
            (Opcode.CHANNEL, list(self.channels.values())),
            (Opcode.STATISTICS, [self._statistics()]),
            (Opcode.CHUNK_INDEX, self.chunks),
            (Opcode.ATTACHMENT_INDEX, ()),
            (Opcode.METADATA_INDEX, self.metadata),
        )
        offsets: list[SummaryOffset] = []
        for kind, records in groups:
            begun = made.count
            for record in records:
                record.write(made)
            offsets.append(
                SummaryOffset(
                    group_opcode=kind, group_start=start + begun, group_length=made.count - begun
                )
            )
        offsets_start = start + made.count
        for offset in offsets:
            offset.write(made)
        data = bytes(made.end())
        head = _FOOTER.pack(Opcode.FOOTER, 8 + 8 + 4, start, offsets_start)
        crc = crc32(head, crc32(data))
        Footer(summary_start=start, summary_offset_start=offsets_start, summary_crc=crc).write(made)
        return data + bytes(made.end())

    def _statistics(self) -> Statistics:
        return Statistics(
            attachment_count=0,
            channel_count=len(self.channels),
            channel_message_counts=self.counts,
            chunk_count=len(self.chunks),
            message_count=self.info.messages,
            message_end_time=self.info.last_ns,
            message_start_time=self.info.first_ns,
            metadata_count=len(self.metadata),
            schema_count=len(self.schemas),
        )


def _scan(stream: BinaryIO, name: str) -> _Found:
    """Read a file up to its last whole chunk."""
    found = _Found(FileInfo(name))
    if stream.read(len(MAGIC)) != MAGIC:
        return found
    found.end = len(MAGIC)
    try:
        for at, kind, body in _records(stream, len(MAGIC)):
            if not found.take(at, kind, body):
                break
    except _DAMAGED as error:
        log.debug("recording_damaged", file=name, reason=repr(error))
    return found


def _records(stream: BinaryIO, at: int) -> Iterator[tuple[int, int, bytes]]:
    """The whole records from here on, each with its place and kind."""
    size = os.fstat(stream.fileno()).st_size
    while at + _HEAD.size <= size:
        kind, length = _HEAD.unpack(stream.read(_HEAD.size))
        after = at + _HEAD.size + length
        if after > size:
            return
        yield at, kind, stream.read(length)
        at = after


def _break_up(
    data: bytes,
) -> tuple[dict[int, Schema], dict[int, Channel], dict[int, list[tuple[int, int]]]]:
    """The schemas and channels of a chunk by their numbers, and where its messages are."""
    schemas: dict[int, Schema] = {}
    channels: dict[int, Channel] = {}
    messages: dict[int, list[tuple[int, int]]] = {}
    at = 0
    while at < len(data):
        kind, length = _HEAD.unpack_from(data, at)
        begun, after = at + _HEAD.size, at + _HEAD.size + length
        if kind == Opcode.MESSAGE:
            channel, _, time_ns = _MESSAGE.unpack_from(data, begun)
            messages.setdefault(channel, []).append((time_ns, at))
        elif kind == Opcode.SCHEMA:
            schema = Schema.read(_stream(data[begun:after]))
            schemas[schema.id] = schema
        elif kind == Opcode.CHANNEL:
            told = Channel.read(_stream(data[begun:after]))
            channels[told.id] = told
        at = after
    return schemas, channels, messages


def _topic(channel: Channel, schemas: dict[int, Schema]) -> TopicInfo:
    about = channel.metadata
    qos, type_hash = about.get("offered_qos_profiles", "[]"), about.get("topic_type_hash", "")
    return TopicInfo(channel.topic, schemas[channel.schema_id].name, qos, type_hash)


def _stream(data: bytes) -> ReadDataStream:
    return ReadDataStream(BytesIO(data))
