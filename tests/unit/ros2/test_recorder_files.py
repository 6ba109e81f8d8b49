"""What a recording is made of: schemas, files that follow each other, and a disk that fills up."""

import errno
import os
from pathlib import Path

import pytest
import yaml
from mcap import records
from mcap.exceptions import EndOfFile
from mcap.reader import make_reader
from mcap.stream_reader import StreamReader
from rclpy.serialization import serialize_message
from rosbags.rosbag2 import Reader
from std_msgs.msg import String
from waiting import wait_until

from edgevox.core.errors import InvalidValue
from edgevox.ros2.contract import PUBLISHED, SUBSCRIBED
from edgevox.ros2.recorder.disk import Disk, WriteQueue, Writing
from edgevox.ros2.recorder.mcap import (
    Bag,
    DefinitionMissing,
    McapFile,
    RecordedMessage,
    definition,
    type_hash,
)
from edgevox.ros2.recorder.recorded_topics import choose_topics
from edgevox.ros2.standard_topics import AUDIO, INTEROP

(TEXT,) = choose_topics("/robot1", ["response"])


def said(number, size=0, at_ns=1_000_000_000):
    data = serialize_message(String(data=f"{number}" + "x" * size))
    return RecordedMessage(TEXT, data, at_ns + number, at_ns + number)


def texts(folder):
    with Reader(folder) as bag:
        return [raw[8:].split(b"\0")[0].rstrip(b"x").decode() for _, _, raw in bag.messages()]


def test_a_definition_holds_all_that_it_refers_to_once():
    text = definition("nav_msgs/msg/Odometry")
    parts = text.split("=" * 80 + "\nMSG: ")
    names = [part.splitlines()[0] for part in parts[1:]]
    assert len(names) == len(set(names))
    assert set(names) == {
        "std_msgs/Header",
        "builtin_interfaces/Time",
        "geometry_msgs/PoseWithCovariance",
        "geometry_msgs/Pose",
        "geometry_msgs/Point",
        "geometry_msgs/Quaternion",
        "geometry_msgs/TwistWithCovariance",
        "geometry_msgs/Twist",
        "geometry_msgs/Vector3",
    }


@pytest.mark.parametrize("row", [*PUBLISHED, *SUBSCRIBED, *INTEROP, *AUDIO], ids=lambda r: r.topic)
def test_every_type_of_the_contract_has_a_definition_and_a_hash(row):
    assert definition(row.type)
    assert type_hash(row.type).startswith("RIHS01_")


def test_a_type_that_is_not_installed_is_said():
    with pytest.raises(DefinitionMissing, match=r"moon_msgs/msg/Dust: got no .msg file"):
        definition("moon_msgs/msg/Dust")
    with pytest.raises(InvalidValue, match="topics: got 'moon_msgs/msg/Dust'"):
        choose_topics("/edgevox", ["/dust:moon_msgs/msg/Dust"])


def test_every_topic_of_the_contract_is_recorded_and_sound_only_when_asked_for():
    everything = {one.name for one in choose_topics("/robot1")}
    assert {f"/robot1/{row.topic}" for row in (*PUBLISHED, *SUBSCRIBED)} <= everything
    assert {row.topic for row in INTEROP if row.topic.startswith("/")} <= everything
    assert not everything & {"/robot1/audio_in", "/robot1/audio_out"}
    chosen = choose_topics("/", ["audio_in", "/other:std_msgs/msg/String"])
    assert [one.name for one in chosen] == ["/audio_in", "/other"]


def test_an_unknown_topic_is_refused_with_those_that_are_known():
    with pytest.raises(InvalidValue, match=r"topics: got 'respons', expected .*response"):
        choose_topics("/edgevox", ["respons"])


def test_a_file_says_what_it_holds_to_the_readers_of_two_libraries(tmp_path):
    bag = Bag(tmp_path / "one", 1 << 30)
    bag.write([said(1), said(2)], {})
    bag.write([said(3)], {})
    bag.end_file({"dropped /robot1/state": "7"})
    bag.close()
    with (tmp_path / "one" / "one_0.mcap").open("rb") as stream:
        reader = make_reader(stream)
        found = [(schema, channel, message) for schema, channel, message in reader.iter_messages()]
        assert reader.get_header().profile == "ros2"
        assert next(reader.iter_metadata()).metadata == {"dropped /robot1/state": "7"}
    schema, channel, _ = found[0]
    assert (schema.name, schema.encoding) == ("std_msgs/msg/String", "ros2msg")
    assert (channel.topic, channel.message_encoding) == ("/robot1/response", "cdr")
    qos = yaml.safe_load(channel.metadata["offered_qos_profiles"])[0]
    assert (qos["reliability"], qos["depth"]) == ("reliable", 10)
    assert texts(tmp_path / "one") == ["1", "2", "3"]


def test_a_full_file_is_followed_by_another_and_the_folder_reads_as_one(tmp_path):
    bag = Bag(tmp_path / "many", 700)
    for number in range(9):
        bag.write([said(number, size=number)], {})
    bag.end_file({})
    bag.close()
    assert bag.files > 2
    assert sorted(f.name for f in bag.folder.glob("*.mcap")) == [
        f"many_{number}.mcap" for number in range(bag.files)
    ]
    assert texts(bag.folder) == [str(number) for number in range(9)]
    about = yaml.safe_load((bag.folder / "metadata.yaml").read_text())
    about = about["rosbag2_bagfile_information"]
    assert (about["message_count"], about["storage_identifier"]) == (9, "mcap")


HOUR_NS = 3_600_000_000_000
SET_BACK = (30 * HOUR_NS, 10 * HOUR_NS, 20 * HOUR_NS)
"""The clock while it is recorded: it is set far back, and then forward again."""


def test_more_than_a_hundred_files_are_read_in_their_order_also_after_silence_and_a_set_clock(
    tmp_path,
):
    bag = Bag(tmp_path / "edgevox-1", 600)
    written = []
    while bag.files <= 110:
        number = len(written)
        written.append(said(number, 50, SET_BACK[bag.files // 40]))
        bag.write(written[-1:], {})
        bag.write([], {})
    bag.end_file({})
    bag.close()
    about = yaml.safe_load((bag.folder / "metadata.yaml").read_text())
    about = about["rosbag2_bagfile_information"]
    in_files = []
    for name in about["relative_file_paths"]:
        with (bag.folder / name).open("rb") as stream:
            reader = make_reader(stream, validate_crcs=True)
            rows = [message for _, _, message in reader.iter_messages(log_time_order=False)]
            assert reader.get_summary().statistics.message_count == len(rows)
            assert [one.sequence for one in rows] == list(range(1, len(rows) + 1))
            in_files += [(one.log_time, one.data) for one in rows]
    assert in_files == [(one.received_ns, one.data) for one in written]
    assert sorted(texts(bag.folder), key=int) == [str(number) for number in range(len(written))]
    times = [one.received_ns for one in written]
    assert about["starting_time"]["nanoseconds_since_epoch"] == min(times)
    assert about["duration"]["nanoseconds"] == max(times) - min(times)


def test_a_recording_of_nothing_leaves_no_file(tmp_path):
    bag = Bag(tmp_path / "none", 2_000)
    bag.write([], {})
    bag.end_file({})
    bag.close()
    assert list(bag.folder.iterdir()) == []


def test_a_file_that_was_not_ended_holds_what_was_flushed(tmp_path):
    file = McapFile(tmp_path / "cut.mcap")
    for number in range(3):
        file.write(said(number))
    file.flush()
    file.write(said(3))
    file.abandon()
    assert read_what_is_there(tmp_path / "cut.mcap.open") == ["0", "1", "2"]
    assert file.size == (tmp_path / "cut.mcap.open").stat().st_size


def test_what_does_not_fit_in_is_dropped_and_counted():
    inbox = WriteQueue(most_messages=2)
    for number in range(5):
        inbox.put(said(number))
    assert len(inbox.take()) == 2
    assert inbox.dropped == {"/robot1/response": 3}
    small = WriteQueue(most_bytes=100)
    small.put(said(1, size=200))
    assert small.take() == []
    small.put(said(1))
    assert len(small.take()) == 1


@pytest.fixture
def recording(tmp_path):
    free = {"bytes": 1 << 40}
    inbox = WriteQueue()
    disk = Disk(tmp_path / "bag", spare_bytes=1_000_000)
    one = Writing(inbox, disk, free_bytes=lambda _: free["bytes"], flush_s=0.02, retry_s=0.1)
    one.start()
    yield inbox, one, free
    one.close()


def test_a_disk_that_is_full_ends_the_file_says_so_and_goes_on_when_there_is_room(
    recording, caplog
):
    inbox, writing, free = recording
    inbox.put(said(1))
    wait_until(lambda: writing.written == 1)
    free["bytes"] = 900_000
    wait_until(lambda: writing.fault)
    assert writing.fault == "the disk is full: 0 MB are left, 1 MB are needed"
    inbox.put(said(2))
    wait_until(lambda: inbox.dropped)
    free["bytes"] = 1 << 40
    wait_until(lambda: not writing.fault)
    inbox.put(said(3))
    writing.close()
    assert texts(writing.bag.folder) == ["1", "3"]
    stops = [one for one in caplog.messages if one.startswith("recording_stopped")]
    assert len(stops) == 1
    assert "recording_goes_on" in caplog.messages


def test_a_write_that_fails_loses_one_file_only_up_to_its_last_flush(recording, monkeypatch):
    inbox, writing, _ = recording
    inbox.put(said(1))
    wait_until(lambda: writing.written == 1)
    monkeypatch.setattr("os.write", failing(errno.EIO))
    inbox.put(said(2))
    wait_until(lambda: inbox.dropped)
    assert "Input/output error" in writing.fault
    monkeypatch.undo()
    wait_until(lambda: not writing.fault)
    inbox.put(said(3))
    writing.close()
    assert texts(writing.bag.folder) == ["1", "3"]


def test_all_files_together_tell_when_they_have_what_they_may(tmp_path):
    inbox = WriteQueue()
    disk = Disk(tmp_path / "edgevox-1", most_bytes=3_000, spare_bytes=0, total_bytes=8_000)
    writing = Writing(inbox, disk, flush_s=0.02)
    writing.start()
    said_so_far = 0
    while not writing.full.is_set():
        for number in range(said_so_far, said_so_far + 40):
            inbox.put(said(number))
        said_so_far += 40
        wait_until(lambda so_far=said_so_far: writing.written == so_far)
    writing.close()
    files = list(disk.folder.glob("*.mcap"))
    assert len(files) > 1
    assert writing.bag.size == sum(one.stat().st_size for one in files) >= 8_000
    assert texts(disk.folder) == [str(number) for number in range(said_so_far)]


def test_a_disk_that_never_took_a_byte_leaves_no_empty_files(recording, monkeypatch):
    inbox, writing, _ = recording
    monkeypatch.setattr("os.write", failing(errno.EIO))
    for number in range(4):
        inbox.put(said(number))
        wait_until(lambda number=number: inbox.dropped.total() > number)
    assert list(writing.bag.folder.iterdir()) == []
    monkeypatch.undo()
    wait_until(lambda: not writing.fault)


def failing(number):
    def fail(*_):
        raise OSError(number, os.strerror(number))

    return fail


def read_what_is_there(path: Path):
    """The texts of a file that has no end."""
    found = []
    with path.open("rb") as stream, pytest.raises(EndOfFile):
        found.extend(
            record.data[8:].split(b"\0")[0].decode()
            for record in StreamReader(stream).records
            if isinstance(record, records.Message)
        )
    return found
