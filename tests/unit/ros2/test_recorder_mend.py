"""Recordings that were cut off are mended, or named as broken; only whole files have a name."""

import os
import shutil
from datetime import datetime, timedelta, timezone

import pytest
from mcap.reader import make_reader
from mcap.stream_reader import StreamReader
from rclpy.serialization import serialize_message
from rosbags.rosbag2 import Reader
from std_msgs.msg import Int32, String

from edgevox.ros2.recorder.mcap import Bag, RecordedMessage
from edgevox.ros2.recorder.mend import mend_files, mend_recordings
from edgevox.ros2.recorder.recorded_topics import choose_topics
from edgevox.ros2.recordings import begun, folders, held, new_folder, used_bytes

TEXT, NUMBER = choose_topics("/robot1", ["response", "/number:std_msgs/msg/Int32"])
NAME = "edgevox-20261128-120000"
START_NS = 1_000_000_000
CHUNK = 0x06


def said(number, at_ns=START_NS):
    data = serialize_message(String(data=f"{number}"))
    return RecordedMessage(TEXT, data, at_ns + number, at_ns + number)


def counted(number):
    data = serialize_message(Int32(data=number))
    return RecordedMessage(NUMBER, data, START_NS + number, START_NS + number)


def texts(folder):
    with Reader(folder) as bag:
        rows = bag.messages()
        return [raw[8:].split(b"\0")[0].decode() for one, _, raw in rows if one.topic == TEXT.name]


def killed(folder):
    """A recording as a kill leaves it: each of its chunks has two topics."""
    bag = Bag(folder.parent / "live" / folder.name, 1 << 30)
    for number in range(3):
        bag.write([said(number), counted(number)], {})
    return copied(bag, folder) / f"{folder.name}_0.mcap.open"


def killed_with_files(folder, files):
    """The same with more than one file; how many texts it has."""
    bag = Bag(folder.parent / "live" / folder.name, 1_500)
    number = 0
    while bag.files < files:
        bag.write([said(number)], {})
        number += 1
    copied(bag, folder)
    return number


def copied(bag, folder):
    """What is on the disk at this moment; nobody holds the copy."""
    shutil.copytree(bag.folder, folder)
    bag.close()
    return folder


def records_of(data):
    """Where the records of a file begin and end, each with its kind."""
    found, at = [], 8
    while at + 9 <= len(data):
        end = at + 9 + int.from_bytes(data[at + 1 : at + 9], "little")
        found.append((at, end, data[at]))
        at = end
    return found


def chunk_ends(data):
    """How many bytes a file needs so that one, two, ... of its chunks are whole."""
    return [end for _, end, kind in records_of(data) if kind == CHUNK]


def complete(path):
    """Check all sums, the summary and the order of a file; its texts."""
    with path.open("rb") as stream:
        assert list(StreamReader(stream, validate_crcs=True).records)
        stream.seek(0)
        reader = make_reader(stream, validate_crcs=True)
        rows = list(reader.iter_messages(topics=[TEXT.name]))
        told = reader.get_summary()
        assert told.statistics.message_count == sum(told.statistics.channel_message_counts.values())
        assert len(told.chunk_indexes) == told.statistics.chunk_count
        for index in told.chunk_indexes:
            assert index.message_index_offsets.keys() == {1, 2}
        return [message.data[8:].split(b"\0")[0].decode() for _, _, message in rows]


def test_a_file_that_is_cut_anywhere_keeps_its_whole_chunks_and_is_else_named_as_broken(tmp_path):
    bag = Bag(tmp_path / NAME, 1 << 30)
    for number in range(3):
        bag.write([said(number), counted(number)], {})
    bag.end_file({"dropped /robot1/state": "7"})
    bag.close()
    data = (bag.folder / f"{NAME}_0.mcap").read_bytes()
    ends = chunk_ends(data)
    assert len(ends) == 3
    sizes = {0, 1, 7, 8, len(data) - 8, len(data) - 1, len(data)}
    for begin, end, _ in records_of(data):  # in its kind, its length, its contents, its last byte
        sizes |= {begin, begin + 1, begin + 5, begin + 9, (begin + end) // 2, end - 1}
    for size in sorted(sizes):
        folder = tmp_path / f"cut{size}"
        folder.mkdir()
        (folder / f"{NAME}_0.mcap.open").write_bytes(data[:size])
        mend_files(folder)
        whole = sum(end <= size for end in ends)
        names = {file.name for file in folder.iterdir()}
        if whole:
            assert names == {f"{NAME}_0.mcap", "metadata.yaml"}, size
            expected = [str(number) for number in range(whole)]
            assert complete(folder / f"{NAME}_0.mcap") == expected, size
            if size in ends:
                assert texts(folder) == expected
        else:
            assert names <= {f"{NAME}_0.mcap.broken"}, size
    assert complete(folder / f"{NAME}_0.mcap") == ["0", "1", "2"]


@pytest.mark.parametrize("junk", [bytes(5_000), b"\xff" * 5_000, b"\x06" + b"\x01" * 40])
def test_what_a_power_cut_left_behind_the_last_chunk_is_cut_off(tmp_path, junk):
    path = killed(tmp_path / NAME)
    with path.open("ab") as stream:
        stream.write(junk)
    mend_files(tmp_path / NAME)
    assert complete(tmp_path / NAME / f"{NAME}_0.mcap") == ["0", "1", "2"]


def test_a_chunk_whose_bytes_were_changed_ends_the_file(tmp_path):
    path = killed(tmp_path / NAME)
    data = bytearray(path.read_bytes())
    first, second, _ = chunk_ends(data)
    data[second - 10] ^= 0xFF
    path.write_bytes(data)
    mend_files(tmp_path / NAME)
    assert complete(tmp_path / NAME / f"{NAME}_0.mcap") == ["0"]
    assert first < second


@pytest.mark.parametrize("clock_ns", [[START_NS] * 3, [2 * START_NS, 0, START_NS]])
def test_what_was_written_as_the_end_of_a_mended_file_is_what_its_writer_writes(tmp_path, clock_ns):
    bag = Bag(tmp_path / NAME, 1 << 30)
    for number, at_ns in enumerate(clock_ns):
        bag.write([said(number + 1, at_ns), counted(number), said(number, at_ns)], {})
    bag.end_file({"dropped /robot1/state": "7"})
    bag.close()
    whole = bag.folder / f"{NAME}_0.mcap"
    data, about = whole.read_bytes(), (bag.folder / "metadata.yaml").read_bytes()
    whole.rename(bag.folder / f"{NAME}_0.mcap.open")
    (bag.folder / "metadata.yaml").unlink()
    mend_files(bag.folder)
    assert (bag.folder / "metadata.yaml").read_bytes() == about
    assert whole.read_bytes() == data


def test_the_metadata_of_a_mended_recording_names_the_files_that_were_moved_away_too(tmp_path):
    folder = tmp_path / NAME
    number = killed_with_files(folder, 4)
    store = tmp_path / "store"
    store.mkdir()
    for file in folder.glob("*.mcap"):
        file.rename(store / file.name)
    mend_files(folder)
    for file in folder.iterdir():
        file.rename(store / file.name)
    assert sorted(file.name for file in store.iterdir()) == [
        *(f"{NAME}_{one}.mcap" for one in range(4)),
        "metadata.yaml",
    ]
    assert texts(store) == [str(one) for one in range(number)]


def test_a_name_is_given_after_the_bytes_are_synced_and_the_metadata_last(tmp_path, monkeypatch):
    seen = []

    def sync(number):
        seen.append(("sync", os.path.basename(os.readlink(f"/proc/self/fd/{number}"))))

    def replace(old, new):
        seen.append(("name", os.path.basename(new)))
        rename(old, new)

    rename = os.replace
    bag = Bag(tmp_path / NAME, 1 << 30)
    monkeypatch.setattr(os, "fsync", sync)
    monkeypatch.setattr(os, "replace", replace)
    bag.write([said(1)], {})
    bag.end_file({})
    bag.close()
    written, file, metadata = ".metadata.yaml.open.partial", f"{NAME}_0.mcap", "metadata.yaml"
    listed = [("sync", written), ("name", "metadata.yaml.open"), ("sync", NAME)]
    assert seen == [
        ("sync", f"{file}.open"),
        *listed,
        *(("name", file), ("sync", NAME)),
        *listed,
        *(("name", metadata), ("sync", NAME)),
    ]


def test_while_it_is_recorded_only_whole_files_have_their_names_and_there_is_no_metadata(tmp_path):
    bag = Bag(tmp_path / NAME, 1_500)
    number = 0
    while bag.files < 3:
        bag.write([said(number)], {})
        number += 1
        for file in bag.folder.glob("*.mcap"):
            with file.open("rb") as stream:
                assert make_reader(stream).get_summary()
        assert not (bag.folder / "metadata.yaml").exists()
    bag.close()


def test_a_recording_that_another_writes_is_let_alone(tmp_path):
    bag = Bag(tmp_path / NAME, 1 << 30)
    bag.write([said(1)], {})
    mend_recordings(tmp_path, lambda: False)
    assert [one.name for one in bag.folder.iterdir()] == [f"{NAME}_0.mcap.open"]
    bag.write([said(2)], {})
    bag.end_file({})
    bag.close()
    assert texts(bag.folder) == ["1", "2"]
    with held(bag.folder) as ours:
        assert ours


def test_recordings_are_mended_until_it_is_told_to_stop_and_others_folders_are_not_touched(
    tmp_path,
):
    paths = [killed(tmp_path / name) for name in (NAME, "edgevox-20261128-130000", "other")]
    mend_recordings(tmp_path, lambda: True)
    assert all(path.exists() for path in paths)
    mend_recordings(tmp_path, lambda: False)
    assert [path.exists() for path in paths] == [False, False, True]


def test_what_cannot_be_written_is_left_for_the_next_time(tmp_path, monkeypatch, caplog):
    path = killed(tmp_path / NAME)

    def full(_):
        raise OSError(28, os.strerror(28))

    monkeypatch.setattr(os, "fsync", full)
    mend_recordings(tmp_path, lambda: False)
    assert path.exists()
    assert "recording_not_mended" in caplog.text
    monkeypatch.undo()
    mend_recordings(tmp_path, lambda: False)
    assert complete(path.with_suffix("")) == ["0", "1", "2"]


@pytest.mark.parametrize("text", ["", "[1, 2]", "{a: ", "rosbag2_bagfile_information: {files: 3}"])
def test_metadata_that_cannot_be_read_are_made_of_the_files(tmp_path, text):
    folder = tmp_path / NAME
    number = killed_with_files(folder, 3)
    (folder / "metadata.yaml.open").write_text(text)
    mend_files(folder)
    assert texts(folder) == [str(one) for one in range(number)]


def test_all_bytes_of_recordings_count_and_no_others(tmp_path):
    path = killed(tmp_path / NAME)
    (tmp_path / NAME / "x.mcap.broken").write_bytes(b"12345")
    (tmp_path / "mine.txt").write_bytes(b"123")
    killed(tmp_path / "other")
    assert used_bytes(tmp_path) == path.stat().st_size + 5


def test_a_recording_never_gets_the_name_of_another_though_the_clock_is_set_back(tmp_path):
    now = datetime(2026, 11, 28, 14, 0, tzinfo=timezone(timedelta(hours=2)))
    made = [new_folder(tmp_path, now)]
    for _ in range(10):
        made[-1].mkdir()
        made.append(new_folder(tmp_path, now))
    made[-1].mkdir()
    assert [one.name for one in made[:3]] == [NAME, f"{NAME}-002", f"{NAME}-003"]
    assert folders(tmp_path) == made
    assert {begun(one) for one in made} == {now.timestamp()}
    assert begun(tmp_path / "edgevox-mine") is None
