"""A file that the program wrote itself may be damaged: it is kept aside, and the robot comes up."""

import hashlib
import json
import os
import threading
from pathlib import Path

import pytest
from small_disk import small_disk

from edgevox.agent.skills import SkillFailed
from edgevox.agent.skills.skill import OneOf
from edgevox.console.certificates import CurrentTls, own_tls
from edgevox.console.sessions import Pairing, Role, Sessions
from edgevox.core.errors import InvalidValue
from edgevox.core.files.state_files import StateFiles, write_atomically
from edgevox.core.files.user_file import LARGEST_TEXT_BYTES
from edgevox.core.status import Level
from edgevox.core.transforms import Pose2D
from edgevox.models.manifest import ModelFile
from edgevox.models.store import STAMPS, forget, is_whole
from edgevox.robots.flat.apartment import ApartmentRobot
from edgevox.robots.places.memory import MOST_PLACES, PlaceMemory, PlaceStore
from edgevox.robots.sim_loop import SimComponent

NAMES = ("localhost", "127.0.0.1")
HANG_S = 30.0
HERE = Pose2D(1.0, 2.0, 0.0)


def break_it(file: Path, how: str) -> None:
    """Put something in the place of a file that no program wrote there."""
    file.parent.mkdir(parents=True, exist_ok=True)
    file.unlink(missing_ok=True)
    match how:
        case "a pipe":
            os.mkfifo(file)
        case "a folder":
            (file / "inside").mkdir(parents=True)
        case "a device":
            file.symlink_to("/dev/zero")
        case "a link to nothing":
            file.symlink_to("nowhere")
        case "a link to itself":
            file.symlink_to(file.name)
        case "too large":
            with file.open("wb") as stream:
                stream.truncate(1 << 33)
        case "no text":
            file.write_bytes(b"\xff\xfe\x00" * 100)
        case "empty":
            file.write_bytes(b"")
        case "other JSON":
            file.write_text('[{"id": null}]', encoding="utf-8")
        case "deep":
            file.write_text("[" * 100_000, encoding="utf-8")


HOW = ("a pipe", "a folder", "a device", "a link to nothing", "a link to itself", "too large",
       "no text", "empty", "other JSON", "deep")  # fmt: skip


def within_time(work):
    """What it returns, unless it hangs: a pipe is waited for without an end."""
    found = []
    thread = threading.Thread(target=lambda: found.append(work()), daemon=True)
    thread.start()
    thread.join(HANG_S)
    assert found, "it hangs, or it raised"
    return found[0]


def kept_aside(file: Path) -> bool:
    return os.path.lexists(file.with_name(f"{file.name}.broken-1"))


def memory(folder: Path) -> PlaceMemory:
    one = PlaceMemory("apartment", OneOf(("kitchen",)))
    one.open(PlaceStore(folder), "robot-apartment")
    return one


@pytest.mark.parametrize("how", HOW)
def test_places_that_cannot_be_read_are_kept_aside_and_new_ones_are_remembered(
    tmp_path, how, caplog
):
    file = tmp_path / "places.json"
    break_it(file, how)

    one = within_time(lambda: memory(tmp_path))

    assert kept_aside(file)
    assert "places.json" in one.fault
    assert caplog.text.count("state_kept_aside") == 1
    one.remember("charger", HERE, "map")
    assert memory(tmp_path).names() == ("charger",)


def places(count: int) -> str:
    one = {"robot": "robot-apartment", "world": "apartment", "x": 1.0, "y": 1.0, "yaw": None}
    listed = [{**one, "name": f"place {number}"} for number in range(count)]
    return json.dumps({"version": 1, "places": listed})


def test_a_file_with_more_places_than_can_be_taught_is_kept_aside(tmp_path):
    file = tmp_path / "places.json"
    file.write_text(places(MOST_PLACES), encoding="utf-8")
    assert len(memory(tmp_path).names()) == MOST_PLACES
    file.write_text(places(5000), encoding="utf-8")

    assert memory(tmp_path).names() == ()
    assert kept_aside(file)


@pytest.mark.parametrize("how", ["a pipe", "a folder", "a link to nothing"])
@pytest.mark.parametrize("name", [".places.lock", ".places.json.partial"])
def test_what_stands_in_the_way_of_writing_places_hangs_nobody(tmp_path, name, how):
    break_it(tmp_path / name, how)

    def remember() -> str:
        try:
            memory(tmp_path).remember("charger", HERE, "map")
        except SkillFailed as error:
            return error.reason.code
        return ""

    assert within_time(remember) in ("", "places_unsaved")


def test_a_damaged_file_that_cannot_be_renamed_is_not_written_over(tmp_path, monkeypatch):
    file = tmp_path / "places.json"
    file.write_text("precious", encoding="utf-8")

    def refuse(*_: object) -> None:
        raise OSError(16, "Device or resource busy")

    monkeypatch.setattr("edgevox.core.files.state_files.os.rename", refuse)
    one = memory(tmp_path)
    with pytest.raises(SkillFailed):
        one.remember("charger", HERE, "map")

    assert file.read_text() == "precious"


def test_diagnostics_say_that_places_were_kept_aside(tmp_path):
    (tmp_path / "places.json").write_text("rubbish")
    body = ApartmentRobot(speed=0.0)
    body.place_memory.open(PlaceStore(tmp_path), body.name)

    status = SimComponent(body).status()

    assert status.level is Level.WARN
    assert "places.json was damaged and is kept as" in status.message


@pytest.mark.parametrize("how", HOW)
@pytest.mark.parametrize("name", ["ca.crt", "ca.key", "console.crt", "console.key"])
def test_a_damaged_key_or_certificate_is_kept_aside_and_another_is_made(tmp_path, name, how):
    own_tls(tmp_path, NAMES)
    break_it(tmp_path / name, how)
    state = StateFiles()

    tls = within_time(lambda: own_tls(tmp_path, NAMES, state=state))

    assert CurrentTls(tls).context
    assert kept_aside(tmp_path / name)
    assert name in state.fault


def test_only_what_is_damaged_is_made_anew(tmp_path):
    own_tls(tmp_path, NAMES)
    authority = (tmp_path / "ca.crt").read_bytes()
    (tmp_path / "console.key").write_text("rubbish")

    own_tls(tmp_path, NAMES)

    assert (tmp_path / "ca.crt").read_bytes() == authority


@pytest.mark.parametrize("name", ["ca.key", "console.key"])
def test_a_key_of_another_certificate_is_not_taken_and_not_lost(tmp_path, name):
    own_tls(tmp_path / "one", NAMES)
    own_tls(tmp_path / "two", NAMES)
    (tmp_path / "one" / name).write_bytes((tmp_path / "two" / name).read_bytes())

    assert CurrentTls(own_tls(tmp_path / "one", NAMES)).context


def test_a_console_that_runs_never_makes_another_authority(tmp_path):
    tls = own_tls(tmp_path, NAMES)
    (tmp_path / "ca.key").write_text("rubbish")

    with pytest.raises(InvalidValue, match="console_folder"):
        tls.renew()

    assert (tmp_path / "ca.key").read_text() == "rubbish"


@pytest.mark.parametrize("how", HOW)
def test_a_damaged_session_counts_as_none_and_the_others_are_let_in(tmp_path, how, caplog):
    sessions = Sessions(tmp_path)
    lost, its_cookie = sessions.begin(Role.OPERATOR, "phone", "10.0.0.1")
    kept, cookie = sessions.begin(Role.VIEWER, "tablet", "10.0.0.2")
    break_it(tmp_path / "sessions" / f"{lost.id}.json", how)

    assert within_time(lambda: [sessions.of_cookie(its_cookie)]) == [None]

    assert sessions.of_cookie(cookie) == kept
    assert sessions.all() == [kept]
    assert kept_aside(tmp_path / "sessions" / f"{lost.id}.json")
    assert caplog.text.count("state_kept_aside") == 1


@pytest.mark.parametrize("how", HOW)
def test_a_damaged_pairing_code_lets_nobody_in_and_another_can_be_made(tmp_path, how):
    pairing = Pairing(tmp_path)
    code = pairing.offer()
    break_it(tmp_path / "pairing.json", how)

    assert within_time(lambda: [pairing.redeem(code.code)]) == [None]
    assert kept_aside(tmp_path / "pairing.json")
    assert pairing.redeem(pairing.offer().code) is Role.OPERATOR


@pytest.mark.parametrize("how", ["a pipe", "empty", "a link to nothing"])
def test_what_is_no_folder_of_sessions_is_kept_aside(tmp_path, how):
    break_it(tmp_path / "sessions", how)
    sessions = Sessions(tmp_path)

    assert within_time(sessions.all) == []
    session, cookie = sessions.begin(Role.VIEWER, "tablet", "10.0.0.2")
    assert sessions.of_cookie(cookie) == session


def test_nothing_of_a_damaged_code_session_or_key_is_in_the_log(tmp_path, caplog):
    for name in ("pairing.json", "ca.key", "sessions/0123456789abcdef.json"):
        file = tmp_path / name
        file.parent.mkdir(exist_ok=True)
        file.write_text('{"code": "SECRETCODE", "hash": "SECRETHASH"')

    Pairing(tmp_path).redeem("x")
    Sessions(tmp_path).all()
    own_tls(tmp_path, NAMES)

    assert caplog.text.count("state_kept_aside") == 3
    assert "SECRET" not in caplog.text


def test_a_disk_that_is_full_leaves_what_is_there_to_be_read(tmp_path):
    with small_disk(tmp_path / "disk") as disk:
        own_tls(disk.path, NAMES)
        memory(disk.path).remember("charger", HERE, "map")
        (disk.path / ".places.lock").unlink()
        disk.fill()

        assert CurrentTls(own_tls(disk.path, NAMES)).context
        assert memory(disk.path).names() == ("charger",)


def test_stamps_of_models_that_cannot_be_read_are_made_again(tmp_path):
    os.mkfifo(tmp_path / STAMPS)
    file = ModelFile(name="one", size=1, sha256=hashlib.sha256(b"x").hexdigest())
    (tmp_path / "one").write_bytes(b"x")
    assert within_time(lambda: is_whole(tmp_path, file))
    forget(tmp_path)


def test_what_was_left_half_written_is_written_over_whatever_it_is(tmp_path):
    os.mkfifo(tmp_path / ".thing.partial")
    within_time(lambda: [write_atomically(tmp_path / "thing", "new")])
    assert (tmp_path / "thing").read_text() == "new"


def test_a_file_as_large_as_may_be_is_read(tmp_path):
    (tmp_path / "thing").write_text("x" * LARGEST_TEXT_BYTES)
    assert StateFiles().read(tmp_path / "thing", len) == LARGEST_TEXT_BYTES


def test_a_file_that_appears_while_it_is_looked_for_is_not_taken_for_a_damaged_one(
    tmp_path, monkeypatch
):
    file = tmp_path / "state.json"

    def look(how):
        def looked(path, *args, **more):
            try:
                return how(path, *args, **more)
            finally:
                if path == file:
                    file.write_text("whole", encoding="utf-8")

        return looked

    for name in ("stat", "lstat"):
        monkeypatch.setattr(os, name, look(getattr(os, name)))
    files = StateFiles()
    assert files.read(file, str) in (None, "whole")
    assert not files.fault
    assert file.read_text(encoding="utf-8") == "whole"
