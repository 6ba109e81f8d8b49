"""The file of remembered places is whole at every moment, and nothing in it is ever lost."""

import json
import subprocess
import sys
import threading
from concurrent.futures import ThreadPoolExecutor

import phrases
import pytest
from small_disk import small_disk

from edgevox.agent.skills import SkillFailed
from edgevox.agent.skills.skill import OneOf
from edgevox.core.transforms import Pose2D
from edgevox.robots.places.memory import PlaceMemory, PlaceStore

HERE = Pose2D(1.25, -2.0, 1.5)
ROBOT, WORLD = "robot-apartment", "apartment"


def memory(folder, robot=ROBOT, world=WORLD):
    one = PlaceMemory(world, OneOf(("kitchen",)))
    one.open(PlaceStore(folder), robot)
    return one


def written(folder):
    return json.loads((folder / "places.json").read_text("utf-8"))["places"]


def test_what_is_remembered_is_there_after_a_restart_with_pose_and_frame(tmp_path):
    memory(tmp_path).remember("charger", HERE, "odom")

    place = memory(tmp_path).find("charger")

    assert (place.x, place.y, place.yaw, place.frame) == (1.25, -2.0, 1.5, "odom")
    assert written(tmp_path) == [
        {"robot": ROBOT, "world": WORLD, "name": "charger"}
        | {"x": 1.25, "y": -2.0, "yaw": 1.5, "frame": "odom"}
    ]


def test_a_folder_that_is_not_there_is_made_when_it_is_needed_and_not_before(tmp_path):
    folder = tmp_path / "state" / "edgevox"

    one = memory(folder)

    assert not folder.exists()
    one.remember("charger", HERE, "map")
    assert memory(folder).names() == ("charger",)


@pytest.mark.parametrize(("robot", "world"), [("robot-irsim", WORLD), (ROBOT, "workshop")])
def test_another_robot_and_another_world_share_the_file_but_no_place(tmp_path, robot, world):
    memory(tmp_path).remember("charger", HERE, "map")
    other = memory(tmp_path, robot, world)

    assert other.names() == ()
    other.remember("charger", Pose2D(0.0, 0.0, 0.0), "map")
    other.remember("shelf", HERE, "map")
    other.forget("charger")

    assert memory(tmp_path).names() == ("charger",)
    assert memory(tmp_path, robot, world).names() == ("shelf",)


def test_what_is_forgotten_is_gone_from_the_file(tmp_path):
    one = memory(tmp_path)
    one.remember("charger", HERE, "map")
    one.forget("charger")

    assert one.find("charger") is None
    assert memory(tmp_path).names() == ()


@pytest.mark.parametrize("name", ["..", "Grandma's bed", "充电站", "ऊपर की जगह", "a" * 40])
def test_a_name_is_data_and_never_a_part_of_a_path(tmp_path, name):
    one = memory(tmp_path)
    if name == "..":
        with pytest.raises(SkillFailed):
            one.remember(name, HERE, "map")
    else:
        one.remember(name, HERE, "map")
        assert memory(tmp_path).names() == (name,)
    assert {file.name for file in tmp_path.iterdir()} <= {"places.json", ".places.lock"}


CRASH = """
import os, sys
from pathlib import Path
from edgevox.core.files import state_files
from edgevox.agent.skills.skill import OneOf
from edgevox.core.transforms import Pose2D
from edgevox.robots.places.memory import PlaceMemory
from edgevox.robots.places.memory import PlaceStore
state_files.os.replace = lambda *_: os._exit(9)
one = PlaceMemory("apartment", OneOf(("kitchen",)))
one.open(PlaceStore(Path(sys.argv[1])), "robot-apartment")
one.remember("shelf", Pose2D(0.0, 0.0, 0.0), "map")
"""


def test_a_crash_between_writing_and_renaming_leaves_the_file_as_it_was(tmp_path):
    memory(tmp_path).remember("charger", HERE, "map")

    crashed = subprocess.run([sys.executable, "-c", CRASH, str(tmp_path)], check=False)

    assert crashed.returncode == 9
    assert (tmp_path / ".places.json.partial").exists()
    one = memory(tmp_path)
    assert one.names() == ("charger",)
    one.remember("shelf", HERE, "map")
    assert memory(tmp_path).names() == ("charger", "shelf")
    assert not (tmp_path / ".places.json.partial").exists()


@pytest.mark.parametrize(
    ("text", "field"),
    [
        ("", "valid JSON"),
        ("{", "valid JSON"),
        ("\x00" * 100, "valid JSON"),
        ('{"version": 2, "places": []}', "version"),
        ('{"version": 1}', "places"),
        ('{"version": 1, "places": [{"robot": "r"}]}', "places.0.world"),
        ('{"version": 1, "places": [{"robot": "r", "x": "1"}]}', "places.0."),
        ('{"version": 1, "places": [], "places": []}', "is there more than once"),
    ],
)
def test_a_file_that_cannot_be_read_is_named_with_its_field_and_kept_aside(
    tmp_path, caplog, capsys, text, field
):
    (tmp_path / "places.json").write_text(text)

    one = memory(tmp_path)
    one.remember("charger", HERE, "map")

    told = caplog.text + "".join(capsys.readouterr())
    assert "state_kept_aside" in told
    assert str(tmp_path / "places.json") in told
    assert field in told
    assert (tmp_path / "places.json.broken-1").read_text() == text
    assert memory(tmp_path).names() == ("charger",)


def test_a_second_broken_file_does_not_take_the_place_of_the_first(tmp_path):
    for text in ("first", "second"):
        (tmp_path / "places.json").write_text(text)
        memory(tmp_path)

    assert (tmp_path / "places.json.broken-1").read_text() == "first"
    assert (tmp_path / "places.json.broken-2").read_text() == "second"


def test_a_file_that_breaks_while_the_robot_runs_is_kept_aside_too(tmp_path):
    one = memory(tmp_path)
    one.remember("charger", HERE, "map")
    (tmp_path / "places.json").write_text("rubbish")

    one.remember("shelf", HERE, "map")

    assert (tmp_path / "places.json.broken-1").read_text() == "rubbish"
    assert one.names() == ("charger", "shelf")
    assert memory(tmp_path).names() == ("charger", "shelf")


def test_a_folder_that_is_none_refuses_to_remember_and_nothing_changes(tmp_path):
    (tmp_path / "file").write_text("mine")
    one = memory(tmp_path / "file" / "places")

    with pytest.raises(SkillFailed, check=phrases.because("places_unsaved")):
        one.remember("charger", HERE, "map")

    assert one.names() == ()
    assert (tmp_path / "file").read_text() == "mine"


def test_a_full_disk_refuses_to_remember_and_to_forget_until_there_is_room(tmp_path):
    with small_disk(tmp_path / "disk") as disk:
        one = memory(disk.path)
        one.remember("charger", HERE, "map")
        disk.fill()

        with pytest.raises(SkillFailed, match="No space left"):
            one.remember("shelf", HERE, "map")
        with pytest.raises(SkillFailed, match="No space left"):
            one.forget("charger")
        assert one.names() == memory(disk.path).names() == ("charger",)

        disk.free()
        one.remember("shelf", HERE, "map")
        assert memory(disk.path).names() == ("charger", "shelf")


def test_many_threads_and_robots_remember_at_once_and_nothing_is_lost(tmp_path):
    robots = [memory(tmp_path, f"robot {number}") for number in range(4)]
    begin = threading.Barrier(8)

    def work(number):
        begin.wait()
        for turn in range(5):
            robots[number % 4].remember(f"place {'abcdefgh'[number]}{turn}", HERE, "map")

    with ThreadPoolExecutor(8) as pool:
        list(pool.map(work, range(8)))

    assert len(written(tmp_path)) == 40
    assert all(len(memory(tmp_path, f"robot {n}").names()) == 10 for n in range(4))


def test_a_name_in_the_file_that_could_not_be_given_now_stays_there_unused_and_is_named(
    tmp_path, caplog
):
    names = [
        "nest",
        "my nests",
        "the kitchen",
        "kit-chen",
        "go back",
        "home",
        "Küche",
        "stop",
        "bay",
    ]
    place = {"robot": ROBOT, "world": WORLD, "x": 1.0, "y": 2.0, "yaw": None, "frame": "map"}
    file = {"version": 1, "places": [place | {"name": name} for name in names]}
    (tmp_path / "places.json").write_text(json.dumps(file), "utf-8")

    one = memory(tmp_path)

    assert one.names() == ("nest", "bay")
    assert [each["name"] for each in written(tmp_path)] == names
    (told,) = (record.msg for record in caplog.records if record.msg["event"] == "places_unused")
    assert told["count"] == 7
    assert "my nests" in told["said"].text
