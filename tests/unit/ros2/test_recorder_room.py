"""Recordings have a bound together: at it they end, wait, or give up their oldest files.

And whether an upload takes them away.
"""

import os
from dataclasses import dataclass

import pytest
from rclpy.serialization import serialize_message
from rosbags.rosbag2 import Reader
from std_msgs.msg import String
from support.clock import HeldClock
from waiting import wait_until

from edgevox.apps.recorder import parse_arguments
from edgevox.core.errors import InvalidValue
from edgevox.ros2.recorder.disk import COUNT_S, Disk, Room, WriteQueue, Writing
from edgevox.ros2.recorder.mcap import Bag, RecordedMessage
from edgevox.ros2.recorder.recorded_topics import choose_topics
from edgevox.ros2.recordings import (
    UPLOAD_DONE,
    UPLOAD_FAILED,
    UPLOAD_TAKES_S,
    WhenFull,
    held,
    upload_fault,
    used_bytes,
)

(TEXT,) = choose_topics("/robot1", ["response"])
OLDER, OLD, NOW = "edgevox-20261128-100000", "edgevox-20261128-110000", "edgevox-20261128-120000"
PLENTY = 1 << 40
SPARE_BYTES = 1_000


def said(number):
    data = serialize_message(String(data=f"{number}"))
    return RecordedMessage(TEXT, data, 1_000_000_000 + number, 1_000_000_000 + number)


def texts(folder):
    with Reader(folder) as bag:
        return [raw[8:].split(b"\0")[0].decode() for _, _, raw in bag.messages()]


def recorded(folder, files=2):
    """A finished recording with so many files of one message each."""
    bag = Bag(folder, 1)
    for number in range(files):
        bag.write([said(number)], {})
    bag.close()


def left(output):
    """The files of all recordings, by the end of the folder's name and their number."""
    found = sorted(output.glob("*/*.mcap*"))
    return [f"{one.parent.name[-6:]}_{one.name.partition('_')[2]}" for one in found]


@dataclass
class Rig:
    """A recording that is written, and the room that it finds."""

    disk: Disk
    clock: HeldClock
    free: int = PLENTY

    def __post_init__(self):
        self.bag = Bag(self.disk.folder, self.disk.most_bytes)
        self.room = Room(self.disk, self.bag, self.clock, lambda _: self.free)


@pytest.fixture
def rig_of(tmp_path):
    made = []

    def make(when_full, total_bytes=None):
        disk = Disk(tmp_path / NOW, 1, SPARE_BYTES, total_bytes, when_full)
        made.append(Rig(disk, HeldClock(100.0)))
        return made[-1]

    yield make
    for one in made:
        one.bag.close()


def test_a_ring_removes_the_oldest_files_one_by_one_until_there_is_room(rig_of, tmp_path):
    recorded(tmp_path / OLDER)
    recorded(tmp_path / OLD)
    rig = rig_of(WhenFull.RING, used_bytes(tmp_path))
    assert rig.room.find() == ""
    assert left(tmp_path) == ["100000_1.mcap", "110000_0.mcap", "110000_1.mcap"]
    assert not (tmp_path / OLDER / "metadata.yaml").exists()  # it would name the file that is gone
    assert (tmp_path / OLD / "metadata.yaml").exists()
    assert rig.room.find() == ""
    assert len(left(tmp_path)) == 3


def test_a_folder_goes_with_its_last_file(rig_of, tmp_path):
    recorded(tmp_path / OLD, 1)
    rig = rig_of(WhenFull.RING, used_bytes(tmp_path))
    assert rig.room.find() == ""
    assert not (tmp_path / OLD).exists()


def test_a_ring_removes_the_oldest_files_of_a_long_recording_whose_metadata_names_the_rest(
    rig_of, tmp_path
):
    rig = rig_of(WhenFull.RING, 15_000)
    for number in range(12):
        assert rig.room.find() == ""
        rig.bag.write([said(number)], {})
        rig.clock.advance(COUNT_S)
        assert used_bytes(tmp_path) < 15_000 + 5_000
    rig.bag.close()
    kept = texts(rig.bag.folder)
    assert 1 < len(kept) < 12
    assert kept == [str(number) for number in range(12)][-len(kept) :]


def test_a_broken_file_counts_and_may_go(rig_of, tmp_path):
    (tmp_path / OLD).mkdir()
    (tmp_path / OLD / f"{OLD}_0.mcap.broken").write_bytes(b"x" * 100)
    rig = rig_of(WhenFull.RING, 100)
    assert rig.room.find() == ""
    assert left(tmp_path) == []


def test_what_is_not_finished_or_belongs_to_another_is_never_removed(rig_of, tmp_path):
    (tmp_path / OLDER).mkdir()
    (tmp_path / OLDER / f"{OLDER}_0.mcap").write_bytes(b"whole")
    (tmp_path / OLDER / f"{OLDER}_1.mcap.open").write_bytes(b"to be mended")
    recorded(tmp_path / OLD, 1)
    (tmp_path / "mine").mkdir()
    (tmp_path / "mine" / "mine_0.mcap").write_bytes(b"a person's own")
    before = left(tmp_path)
    rig = rig_of(WhenFull.RING, 1)
    rig.bag.open()
    with held(tmp_path / OLD):  # as another recorder that writes to it
        assert rig.room.find().startswith("recordings have ")
    rig.bag.lose_file()
    assert left(tmp_path) == before


def test_a_ring_gives_the_disk_back_one_file_every_few_seconds(rig_of, tmp_path):
    recorded(tmp_path / OLD)
    rig = rig_of(WhenFull.RING)
    rig.free = SPARE_BYTES - 1
    assert rig.room.find() == ""
    assert left(tmp_path) == ["110000_1.mcap"]
    assert rig.room.find() == ""  # the disk may not tell at once that it has room
    assert left(tmp_path) == ["110000_1.mcap"]
    rig.clock.advance(COUNT_S)
    assert rig.room.find() == ""
    assert left(tmp_path) == []
    rig.clock.advance(COUNT_S)
    assert rig.room.find() == "the disk is full: 0 MB are left, 0 MB are needed"


@pytest.mark.parametrize("when_full", list(WhenFull))
def test_a_recording_that_others_leave_no_room_stops_once_and_keeps_what_it_has(
    tmp_path, when_full
):
    """And goes on once, although they go on writing around what is to be spared."""
    clock, free, inbox = HeldClock(100.0), SPARE_BYTES, WriteQueue()
    disk = Disk(tmp_path / NOW, 1 << 30, SPARE_BYTES, None, when_full)
    writing = Writing(inbox, disk, clock=clock, free_bytes=lambda _: free, flush_s=0.0)
    stopped = []

    def look(times=20):
        for number in range(times):
            inbox.put(said(number))
            writing.look()
            stopped.append(bool(writing.fault))
            clock.advance(1.0)

    look()
    free = SPARE_BYTES - 1
    look()
    for wobble in range(20):
        free = SPARE_BYTES - 100 + 10 * wobble
        look(1)
    assert stopped[:20] == [False] * 20
    assert stopped[20:] == [True] * 40
    assert left(tmp_path) == ["120000_0.mcap"]
    free = 2 * SPARE_BYTES
    look()
    free = SPARE_BYTES
    look()
    assert not any(stopped[65:])
    writing.bag.close()
    assert len(left(tmp_path)) == 2


@pytest.mark.parametrize("when_full", [WhenFull.WAIT, WhenFull.END])
def test_without_a_ring_nothing_is_removed(rig_of, tmp_path, when_full):
    recorded(tmp_path / OLD)
    before = left(tmp_path)
    rig = rig_of(when_full, 1)
    rig.free = 0
    assert rig.room.find()
    assert left(tmp_path) == before


def test_what_waits_goes_on_when_files_were_moved_away(rig_of, tmp_path):
    recorded(tmp_path / OLD)
    rig = rig_of(WhenFull.WAIT, used_bytes(tmp_path))
    assert rig.room.find() == "recordings have 0 MB, and may have 0 MB"
    (tmp_path / OLD / f"{OLD}_0.mcap").unlink()
    rig.clock.advance(COUNT_S)
    assert rig.room.find() == ""


def test_it_tells_how_much_there_is_and_is_left(rig_of, tmp_path):
    recorded(tmp_path / OLD)
    rig = rig_of(WhenFull.END)
    rig.room.find()
    assert (rig.room.used_bytes, rig.room.free_bytes) == (used_bytes(tmp_path), PLENTY)
    rig.bag.open()
    rig.bag.write([said(1)], {})
    there = used_bytes(tmp_path) - (rig.bag.folder / "metadata.yaml.open").stat().st_size
    assert rig.room.used_bytes == there


def test_a_recording_in_a_ring_goes_on_and_loses_nothing_that_is_new(tmp_path):
    recorded(tmp_path / OLD, 4)
    inbox = WriteQueue()
    disk = Disk(tmp_path / NOW, 1, 0, used_bytes(tmp_path), WhenFull.RING)
    writing = Writing(inbox, disk, flush_s=0.02)
    writing.start()
    for number in range(8):
        inbox.put(said(number))
        wait_until(lambda number=number: writing.written == number + 1)
    writing.close()
    assert not writing.fault
    assert not inbox.dropped
    kept = texts(tmp_path / NOW)
    assert kept[-1] == "7"
    assert not writing.full.is_set()


def test_a_ring_needs_room_for_two_files_because_the_open_one_never_goes():
    with pytest.raises(InvalidValue, match=r"most: got 100.0, expected a number of 512 or more"):
        parse_arguments(["--most", "100", "--when-full", "ring"])
    assert parse_arguments(["--most", "512", "--when-full", "ring"]).when_full is WhenFull.RING
    assert parse_arguments(["--most", "100"]).when_full is WhenFull.END


EVERY_S = 60
BEGAN_S = 1_795_000_000.0
LONGEST_S = UPLOAD_TAKES_S + EVERY_S


def aged(file, changed_s):
    os.utime(file, (changed_s, changed_s))


@pytest.fixture
def uploaded(tmp_path):
    """A recording of two files, and the note of a run that took the first of them."""
    recorded(tmp_path / OLD)
    (tmp_path / UPLOAD_DONE).write_text(f"{EVERY_S}\n")
    aged(tmp_path / UPLOAD_DONE, BEGAN_S)
    aged(tmp_path / OLD / f"{OLD}_0.mcap", BEGAN_S - 10)
    aged(tmp_path / OLD / f"{OLD}_1.mcap", BEGAN_S + 10)
    return tmp_path


def test_an_upload_is_behind_where_a_file_waits_for_too_long(uploaded):
    assert upload_fault(uploaded, BEGAN_S + 10 + LONGEST_S) == ""
    told = upload_fault(uploaded, BEGAN_S + 11 + LONGEST_S)
    assert told.startswith("nothing was uploaded since 2026-11-18 11:06 UTC")


def test_an_upload_that_has_taken_all_is_not_behind_however_long_nothing_is_recorded(uploaded):
    (uploaded / OLD / f"{OLD}_1.mcap").unlink()
    assert upload_fault(uploaded, BEGAN_S + 10 * LONGEST_S) == ""


def test_an_upload_that_fails_is_told_at_once(uploaded):
    (uploaded / UPLOAD_FAILED).touch()
    assert upload_fault(uploaded, BEGAN_S) == "the upload fails: see the uploader's log"


@pytest.mark.parametrize("note", [None, b"", b"often", b"\xff"])
def test_nothing_is_said_of_an_upload_that_left_no_note_or_is_writing_it(uploaded, note):
    (uploaded / UPLOAD_DONE).unlink()
    if note is not None:
        (uploaded / UPLOAD_DONE).write_bytes(note)
        aged(uploaded / UPLOAD_DONE, BEGAN_S)
    assert upload_fault(uploaded, BEGAN_S + 10 * LONGEST_S) == ""
