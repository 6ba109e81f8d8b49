"""Recordings begun and ended on the console, with a program in the recorder's place."""

import asyncio
import json
import os
import shutil
import signal
import subprocess
import sys
from collections import namedtuple
from datetime import UTC, datetime

import aiohttp
import pytest
from logs_rig import logging_to_memory
from mcap.reader import make_reader
from rclpy.serialization import serialize_message
from recorder_program import RECORDS
from std_msgs.msg import String
from support.clock import HeldClock
from waiting import wait_until

from edgevox.apps.console import robot_recorder
from edgevox.apps.console.robot_recorder import NoRecorder, RobotRecorder, open_recorder
from edgevox.console.page_files import PAGE
from edgevox.console.sessions import Role
from edgevox.core.errors import EdgeVoxError
from edgevox.core.languages import LANGUAGES
from edgevox.core.settings import load_settings
from edgevox.ros2.recorder.mcap import Bag, RecordedMessage
from edgevox.ros2.recorder.recorded_topics import choose_topics
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
    before = set(recorder.kept.folder.glob("*/*.mcap.open"))
    recorder.start()
    wait_until(lambda: set(recorder.kept.folder.glob("*/*.mcap.open")) - before)
    hidden = recorder.files()
    recorder.stop()
    return hidden


def test_what_was_recorded_is_offered_once_it_is_whole_newest_first(recorder):
    state = recorder.state()
    assert (state["running"], state["files"], state["why"]) == (False, [], "")
    assert record(recorder) == []
    (first,) = recorder.files()
    assert first.read_bytes() == b"whole"
    assert record(recorder) == [first]
    assert [one.name for one in recorder.files()] == [
        "edgevox-20261123-140001_0.mcap",
        "edgevox-20261123-140000_0.mcap",
    ]
    begun = datetime(2026, 11, 23, 14, tzinfo=UTC).timestamp()
    assert recorder.state()["files"][1] == {"name": first.name, "bytes": 5, "begun": begun}


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


def test_without_room_on_the_disk_nothing_begins_and_that_is_told(recorder, monkeypatch):
    monkeypatch.setattr(shutil, "disk_usage", lambda _: Usage(10**12, 10**12, 549_000_000))
    with pytest.raises(EdgeVoxError, match="room for 49 MB, expected 50"):
        recorder.start()
    state = recorder.state()
    assert (state["running"], state["full"], state["room"]) == (False, True, 49_000_000)


def test_all_recordings_together_have_a_bound_and_none_goes_for_another(tmp_path, monkeypatch):
    monkeypatch.setattr(robot_recorder, "PROGRAM", RECORDS)
    folder = tmp_path / "recordings"
    monkeypatch.setattr(shutil, "disk_usage", lambda _: Usage(10**12, 0, 10**12))
    recorder = RobotRecorder(load_settings({"console_recordings_mb": 60}), folder, {})
    assert (recorder.state()["full"], recorder.state()["room"]) == (False, 60_000_000)
    record(recorder)
    (file,) = recorder.files()
    os.truncate(file, 10_000_001)
    assert recorder.state()["full"]
    with pytest.raises(EdgeVoxError, match="room for 49 MB, expected 50"):
        recorder.start()
    assert recorder.files() == [file]
    recorder.delete(file.name)
    assert not recorder.state()["full"]


def test_a_recording_may_have_the_room_that_there_is(tmp_path, monkeypatch):
    monkeypatch.setattr(robot_recorder, "PROGRAM", "import sys; sys.exit(repr(sys.argv))")
    monkeypatch.setattr(shutil, "disk_usage", lambda _: Usage(10**12, 0, 10**12))
    settings = load_settings({"console_recordings_mb": 70})
    recorder = RobotRecorder(settings, tmp_path / "recordings", {})
    recorder.start()
    wait_until(lambda: recorder.state()["why"])
    assert "'--most', '70'" in recorder.state()["why"]


def test_while_it_records_a_disk_that_is_full_is_told(recorder, monkeypatch):
    recorder.start()
    wait_until(lambda: list(recorder.kept.folder.glob("*/*.mcap.open")))
    state = recorder.state()
    assert (state["bytes"], state["full"]) == (len(b"begun"), False)
    monkeypatch.setattr(shutil, "disk_usage", lambda _: Usage(10**12, 10**12, 499_000_000))
    assert recorder.state()["full"]


def test_a_folder_that_cannot_be_made_is_told(tmp_path):
    (tmp_path / "file").touch()
    with pytest.raises(EdgeVoxError, match="Not a directory"):
        RobotRecorder(load_settings({}), tmp_path / "file" / "recordings", {}).start()


def test_a_recording_is_removed_by_its_name_and_nothing_else_is(recorder, tmp_path):
    record(recorder)
    (tmp_path / "kept.mcap").touch()
    for name in ("../kept.mcap", "kept.mcap", "edgevox-20261123-140000", "..", ""):
        with pytest.raises(EdgeVoxError, match="is no recording"):
            recorder.delete(name)
    recorder.delete("edgevox-20261123-140000_0.mcap")
    assert list(recorder.kept.folder.iterdir()) == []
    assert (tmp_path / "kept.mcap").exists()


def test_of_several_files_of_one_recording_each_is_taken_and_removed_by_itself(tmp_path):
    recorder = RobotRecorder(load_settings({}), tmp_path, {})
    bag = tmp_path / "edgevox-20261123-140000"
    bag.mkdir()
    for name in ("a.mcap", "b.mcap", "metadata.yaml"):
        (bag / name).touch()
    assert [one.name for one in recorder.files()] == ["b.mcap", "a.mcap"]
    recorder.delete("a.mcap")
    assert [one.name for one in recorder.files()] == ["b.mcap"]
    recorder.delete("b.mcap")
    assert not bag.exists()


def test_whoever_listens_is_told_that_it_begins_and_ends(recorder):
    told = []
    forget = recorder.listen(told.append)
    record(recorder)
    wait_until(lambda: len(told) == 2)
    assert told == [True, False]
    forget()
    record(recorder)
    assert told == [True, False]


def test_a_recorder_whose_agent_is_gone_ends_as_if_it_were_asked_to():
    program = (
        "import threading, edgevox.apps.recorder as recorder;"
        "recorder.main = lambda: threading.Event().wait(); recorder.main_under_agent()"
    )
    with subprocess.Popen([sys.executable, "-c", program], stdin=subprocess.PIPE) as process:
        assert process.poll() is None
        process.stdin.close()  # as the kernel does for an agent that was killed
        assert process.wait() == -signal.SIGTERM


def test_what_a_killed_agent_left_is_offered_once_it_is_mended(tmp_path):
    live = Bag(tmp_path / "live" / "edgevox-20261123-140000", 1 << 30)
    (topic,) = choose_topics("/robot1", ["response"])
    live.write([RecordedMessage(topic, serialize_message(String(data="hi")), 1, 1)], {})
    shutil.copytree(live.folder, tmp_path / "recordings" / live.folder.name)  # as a kill leaves it
    live.close()
    recorder = RobotRecorder(load_settings({}), tmp_path / "recordings", os.environ)
    assert recorder.files() == []
    recorder.mend()
    wait_until(recorder.files)
    recorder.close()
    (file,) = recorder.files()
    with file.open("rb") as stream:
        assert make_reader(stream).get_summary().statistics.message_count == 1
    assert not recorder.kept.unfinished()


def test_where_nothing_can_be_recorded_it_says_what_is_missing(tmp_path, monkeypatch):
    monkeypatch.setattr(robot_recorder, "find_spec", lambda name: object())
    asked = load_settings({"ros2": True})
    assert open_recorder(load_settings({}), tmp_path, {}) is NoRecorder.ROS2
    assert isinstance(open_recorder(asked, tmp_path, {}), RobotRecorder)
    for missing, why in (("mcap", NoRecorder.EXTRA), ("rclpy", NoRecorder.ROS2)):
        monkeypatch.setattr(
            robot_recorder, "find_spec", lambda name, missing=missing: name != missing or None
        )
        assert open_recorder(asked, tmp_path, {}) is why


@pytest.mark.parametrize("why", NoRecorder)
@pytest.mark.parametrize("language", LANGUAGES)
def test_the_page_has_words_for_what_is_missing(language, why):
    words = json.loads((PAGE / f"languages/{language}.json").read_text(encoding="utf-8"))
    assert words[f"record_needs_{why}"]


def test_with_dds_security_it_needs_an_enclave_of_its_own(tmp_path, monkeypatch):
    monkeypatch.setattr(robot_recorder, "find_spec", lambda name: object())
    secured = {"ROS_SECURITY_ENABLE": "true", "ROS_SECURITY_KEYSTORE": str(tmp_path)}
    asked = load_settings({"ros2": True, "agent_namespace": "/robot1"})
    assert open_recorder(asked, tmp_path, secured) is NoRecorder.ENCLAVE
    (tmp_path / "enclaves/robot1/edgevox_recorder").mkdir(parents=True)
    made = open_recorder(asked, tmp_path, secured)
    assert made
    assert made.environment["ROS_SECURITY_ENCLAVE_OVERRIDE"] == "/robot1/edgevox_recorder"
    asked_for = {
        "EDGEVOX_SECURITY_KEYSTORE": str(tmp_path),
        "EDGEVOX_SECURITY_ENCLAVE": "/robot1/edgevox",
    }
    made = open_recorder(asked, tmp_path, secured | asked_for)
    assert made.environment["EDGEVOX_SECURITY_ENCLAVE"] == "/robot1/edgevox_recorder"


def test_operators_take_it_home_and_nobody_else(recorder, tmp_path):
    record(recorder)
    with console(tmp_path, recorder=recorder) as rig:

        async def get(name, role=None):
            cookies = rig.cookie(role) if role else {}
            url = f"{rig.server.url}/api/recording/{name}"
            async with aiohttp.ClientSession(cookies=cookies) as client, client.get(url) as told:
                return told.status, told.headers.get("Content-Disposition"), await told.read()

        async def ask():
            name = "edgevox-20261123-140000_0.mcap"
            attached = f"attachment; filename*=UTF-8''{name}"
            assert await get(name, Role.OPERATOR) == (200, attached, b"whole")
            for role, what, status in (
                (Role.VIEWER, name, 403),
                (None, name, 401),
                (Role.OPERATOR, "none.mcap", 404),
                (Role.OPERATOR, "..%2F..%2Fsessions.json", 404),
            ):
                assert (await get(what, role))[0] == status

        asyncio.run(ask())


def test_one_browser_does_not_download_without_end(recorder, tmp_path):
    record(recorder)
    (file,) = recorder.files()
    clock = HeldClock()
    with console(tmp_path, recorder=recorder, clock=clock) as rig:
        url, other = f"{rig.server.url}/api/recording/{file.name}", rig.cookie(name="other")

        async def ask():
            async with aiohttp.ClientSession(cookies=rig.cookie()) as client:
                told = []
                for _ in range(21):
                    async with client.get(url) as answer:
                        told.append(answer.status)
                clock.now_s += 2.0
                async with client.get(url) as answer:
                    told.append(answer.status)
            async with aiohttp.ClientSession(cookies=other) as client, client.get(url) as answer:
                return [*told, answer.status]

        assert asyncio.run(ask()) == [200] * 20 + [429, 200, 200]


def test_every_page_is_told_that_it_records_whatever_it_looks_at(recorder, tmp_path):
    with console(tmp_path, recorder=recorder) as rig:

        async def watch():
            async with rig.page(Role.VIEWER) as page:
                before = page.hello["recording"]
                recorder.start()
                begun = await page.until("recording")
                async with rig.page(Role.VIEWER) as late:
                    hello = late.hello["recording"]
                recorder.stop()
                ended = await page.until("recording")
                return before, begun["running"], hello, ended["running"]

        assert asyncio.run(watch()) == (False, True, True, False)


def test_the_log_has_who_began_ended_took_and_deleted_a_recording(recorder, tmp_path):
    with logging_to_memory() as logged, console(tmp_path, recorder=recorder) as rig:

        async def use():
            cookie = rig.cookie()
            async with rig.page(cookie=cookie) as page:
                await page.ask(type="lease", action="take")
                await page.ask(type="record", action="start")
                await asyncio.to_thread(
                    wait_until, lambda: list(recorder.kept.folder.glob("*/*.mcap.open"))
                )
                await page.ask(type="record", action="stop")
                (file,) = recorder.files()
                url = f"{rig.server.url}/api/recording/{file.name}"
                async with aiohttp.ClientSession(cookies=cookie) as client:
                    await (await client.get(url)).read()
                await page.ask(type="delete_recording", name=file.name)
                return page.hello["client"], file.name

        session, name = asyncio.run(use())
        asked = logged.of("console_recording_asked")
    assert {one["session"] for one in asked} == {session}
    assert [(one["action"], one["name"]) for one in asked] == [
        ("start", ""),
        ("stop", ""),
        ("take", name),
        ("delete", name),
    ]


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
