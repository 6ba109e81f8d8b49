"""Recordings begun and ended on the console, with a program in the recorder's place."""

import asyncio
import shutil
from collections import namedtuple

import aiohttp
import pytest
from recorder_program import RECORDS
from waiting import wait_until

from edgevox.apps.console import robot_recorder
from edgevox.apps.console.robot_recorder import RobotRecorder, open_recorder
from edgevox.console.sessions import Role
from edgevox.core.errors import EdgeVoxError
from edgevox.core.settings import load_settings
from tests.console_rig import console

FAILS = "import sys; print('warning', file=sys.stderr); sys.exit('output: disk full')"
Usage = namedtuple("Usage", "total used free")


@pytest.fixture
def recorder(tmp_path, monkeypatch):
    monkeypatch.setattr(robot_recorder, "PROGRAM", RECORDS)
    made = RobotRecorder(load_settings({}), tmp_path / "recordings", {})
    yield made
    made.stop()


def record(recorder):
    """Begin, wait until something is there, and end."""
    before = set(recorder.folder.glob("*/*.mcap"))
    recorder.start()
    wait_until(lambda: set(recorder.folder.glob("*/*.mcap")) - before)
    hidden = recorder.files()
    recorder.stop()
    return hidden


def test_what_was_recorded_is_offered_once_it_is_whole_newest_first(recorder):
    assert recorder.state() == {"running": False, "files": [], "why": ""}
    assert record(recorder) == []
    (first,) = recorder.files()
    assert first.read_bytes() == b"whole"
    assert record(recorder) == [first]
    assert [one.name for one in recorder.files()] == [
        "edgevox-0001_0.mcap",
        "edgevox-0000_0.mcap",
    ]
    assert recorder.state()["files"][1] == {"name": "edgevox-0000_0.mcap", "bytes": 5}


def test_it_says_that_it_records_and_does_not_begin_twice(recorder):
    recorder.start()
    state = recorder.state()
    assert (state["running"], state["seconds"] >= 0) == (True, True)
    with pytest.raises(EdgeVoxError, match="it records already"):
        recorder.start()
    assert recorder.state()["running"]
    recorder.stop()
    recorder.stop()
    assert not recorder.state()["running"]


def test_one_that_fails_says_why_and_the_next_may_begin(recorder, tmp_path, monkeypatch):
    monkeypatch.setattr(robot_recorder, "PROGRAM", FAILS)
    failing = RobotRecorder(load_settings({}), tmp_path / "failing", {})
    failing.start()
    wait_until(lambda: failing.state()["why"])
    state = failing.state()
    assert (state["running"], state["why"]) == (False, "output: disk full")
    failing.start()
    wait_until(lambda: not failing.state()["running"])


def test_without_room_nothing_begins(recorder, monkeypatch):
    monkeypatch.setattr(shutil, "disk_usage", lambda _: Usage(10**12, 10**12, 999_000_000))
    with pytest.raises(EdgeVoxError, match="999 MB of disk are free, expected 1000"):
        recorder.start()
    assert not recorder.state()["running"]


def test_a_folder_that_cannot_be_made_is_told(tmp_path):
    (tmp_path / "file").touch()
    with pytest.raises(EdgeVoxError, match="Not a directory"):
        RobotRecorder(load_settings({}), tmp_path / "file" / "recordings", {}).start()


def test_a_recording_is_removed_by_its_name_and_nothing_else_is(recorder, tmp_path):
    record(recorder)
    (tmp_path / "kept.mcap").touch()
    for name in ("../kept.mcap", "kept.mcap", "edgevox-0000", "..", ""):
        with pytest.raises(EdgeVoxError, match="is no recording"):
            recorder.delete(name)
    recorder.delete("edgevox-0000_0.mcap")
    assert list(recorder.folder.iterdir()) == []
    assert (tmp_path / "kept.mcap").exists()


def test_where_ros_2_says_nothing_there_is_no_recorder(tmp_path, monkeypatch):
    monkeypatch.setattr(robot_recorder, "find_spec", lambda name: object())
    assert open_recorder(load_settings({}), tmp_path, {}) is None
    assert open_recorder(load_settings({"ros2": True}), tmp_path, {})
    monkeypatch.setattr(robot_recorder, "find_spec", lambda name: name != "mcap" or None)
    assert open_recorder(load_settings({"ros2": True}), tmp_path, {}) is None


def test_with_dds_security_it_needs_an_enclave_of_its_own(tmp_path, monkeypatch):
    monkeypatch.setattr(robot_recorder, "find_spec", lambda name: object())
    secured = {"ROS_SECURITY_ENABLE": "true", "ROS_SECURITY_KEYSTORE": str(tmp_path)}
    asked = load_settings({"ros2": True, "agent_namespace": "/robot1"})
    assert open_recorder(asked, tmp_path, secured) is None
    (tmp_path / "enclaves/robot1/edgevox_recorder").mkdir(parents=True)
    made = open_recorder(asked, tmp_path, secured)
    assert made
    assert made.environment["ROS_SECURITY_ENCLAVE_OVERRIDE"] == "/robot1/edgevox_recorder"


def test_operators_take_it_home_and_nobody_else(recorder, tmp_path):
    record(recorder)
    with console(tmp_path, recorder=recorder) as rig:

        async def get(name, role=None):
            cookies = rig.cookie(role) if role else {}
            url = f"{rig.server.url}/api/recording/{name}"
            async with aiohttp.ClientSession(cookies=cookies) as client, client.get(url) as told:
                return told.status, told.headers.get("Content-Disposition"), await told.read()

        async def ask():
            name = "edgevox-0000_0.mcap"
            assert await get(name, Role.OPERATOR) == (200, "attachment", b"whole")
            for role, what, status in (
                (Role.VIEWER, name, 403),
                (None, name, 401),
                (Role.OPERATOR, "none.mcap", 404),
                (Role.OPERATOR, "..%2F..%2Fsessions.json", 404),
            ):
                assert (await get(what, role))[0] == status

        asyncio.run(ask())


def test_whoever_commands_records_and_whoever_watches_does_not(recorder, tmp_path):
    with console(tmp_path, recorder=recorder) as rig:

        async def watch():
            async with rig.page(Role.VIEWER) as page:
                return await page.ask(type="record", action="start")

        async def command():
            async with rig.page() as page:
                no_turn = await page.ask(type="record", action="start")
                await page.ask(type="lease", action="take")
                told = [
                    await page.ask(type="record", action=action)
                    for action in ("start", "start", "stop", "stop")
                ]
                gone = await page.ask(type="delete_recording", name="none.mcap")
                return no_turn["reason"], [one["type"] for one in told], gone["message"]

        assert asyncio.run(watch())["reason"] == "viewer"
        no_turn, told, gone = asyncio.run(command())
        assert (no_turn, told) == ("no_lease", ["ok", "error", "ok", "ok"])
        assert gone == "record: 'none.mcap' is no recording"
