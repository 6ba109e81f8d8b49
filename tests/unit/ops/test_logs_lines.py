"""One line an event, whoever wrote it: fields, ids, exceptions, colours."""

import asyncio
import json
import logging
import os
import pty
import subprocess
import sys
import threading
import warnings
from pathlib import Path

import pytest
from logs_rig import logging_to_memory

from edgevox.core.log import Said, bound, get_logger
from edgevox.core.settings import Settings
from edgevox.ops.logs import set_level, set_up, tear_down
from edgevox.ops.logs.line_formatter import MOST_CHARACTERS

log = get_logger("edgevox.test")


@pytest.fixture(autouse=True)
def _levels():
    yield
    set_level("edgevox", 0)


def test_a_line_says_when_how_bad_who_what_and_more():
    with logging_to_memory() as logged:
        log.warning("sound_lost", device="usb", retry_s=2.5, tries=[1, 2], file=Path("x.wav"))
    (line,) = logged.lines
    assert line.pop("ts").endswith("Z")
    assert line == {
        "level": "warning",
        "logger": "edgevox.test",
        "event": "sound_lost",
        "device": "usb",
        "retry_s": 2.5,
        "tries": [1, 2],
        "file": "x.wav",
    }


def test_what_json_cannot_hold_is_a_line_all_the_same():
    with logging_to_memory() as logged:
        log.info("odd", nan=float("nan"), lines="a\nb\x1b[31m", deep={1: {2}}, long="x" * 20_000)
    (line,) = logged.lines
    assert (line["nan"], line["lines"], line["deep"]) == ("nan", "a\nb\x1b[31m", {"1": [2]})
    assert len(line["long"]) < MOST_CHARACTERS + 20
    assert logged.text.count("\n") == 1


def test_the_turn_and_the_goal_are_on_every_line_of_their_thread_and_on_no_other():
    def elsewhere():
        log.info("other")

    with logging_to_memory() as logged:
        with bound(turn=3, goal="7"):
            log.info("mine")
            logging.getLogger("library").info("theirs")
            thread = threading.Thread(target=elsewhere)
            thread.start()
            thread.join()
        log.info("after")
    ids = {line["event"]: (line.get("turn"), line.get("goal")) for line in logged.lines}
    assert ids["mine"] == ids["theirs"] == (3, "7")
    assert ids["other"] == ids["after"] == (None, None)


def test_libraries_warnings_and_what_nobody_caught_are_lines_like_ours():
    def breaks():
        raise OSError("the card\nis gone")

    with logging_to_memory(log_level="debug") as logged:
        logging.getLogger("httpx").info("HTTP %s", 200)
        logging.getLogger("asyncio").warning("slow")
        warnings.warn("old", DeprecationWarning, stacklevel=1)
        thread = threading.Thread(target=breaks, name="ear")
        thread.start()
        thread.join()
        try:
            breaks()
        except OSError:
            sys.excepthook(*sys.exc_info())
        asyncio.run(_debugged())
    by_logger = {line["logger"]: line for line in logged.lines}
    assert by_logger["httpx"]["event"] == "HTTP 200"
    assert "asyncio" in by_logger
    assert "old" in by_logger["py.warnings"]["event"]
    (thread_line,) = logged.of("thread_broke")
    assert thread_line["level"] == "critical"
    assert thread_line["thread"] == "ear"
    assert "Traceback" in thread_line["exception"]
    assert thread_line["exception"].endswith("is gone")
    assert "breaks" in logged.of("program_broke")[0]["exception"]


async def _debugged():
    asyncio.get_running_loop().set_debug(True)


def test_below_its_level_nothing_is_written_and_levels_change_while_it_runs():
    with logging_to_memory() as logged:
        log.debug("one")
        set_level("edgevox", logging.DEBUG)
        log.debug("two")
        logging.getLogger("library").debug("three")
        set_level("edgevox.test", logging.ERROR)
        log.warning("four")
        set_level("edgevox.test", logging.NOTSET)
        log.debug("five")
    assert [line["event"] for line in logged.lines] == ["two", "five"]


def test_what_somebody_said_shows_only_its_length_above_debug_unless_asked():
    said = Said("the secret is xyzzy")
    with logging_to_memory() as hidden:
        log.info("heard", text=said, inside={"name": said})
    with logging_to_memory(log_speech=True) as shown:
        log.info("heard", text=said)
    with logging_to_memory(log_level="debug") as debug:
        log.info("heard", text=said)
        log.debug("heard", text=said)
    assert "xyzzy" not in hidden.text
    assert hidden.lines[0]["text"] == "<19 characters>"
    assert shown.lines[0]["text"] == "the secret is xyzzy"
    assert [line["text"] for line in debug.lines] == ["<19 characters>", "the secret is xyzzy"]


def test_without_being_set_up_lines_go_to_pythons_logging_and_print_nothing(caplog):
    with caplog.at_level(logging.INFO):
        log.info("heard", by="me", text=Said("xyzzy"))
    assert caplog.messages == ["heard by='me' text=<5 characters>"]
    quiet = "from edgevox.core.log import get_logger; get_logger('edgevox.x').warning('shown', a=1)"
    ran = subprocess.run([sys.executable, "-c", quiet], capture_output=True, timeout=60)
    assert (ran.stdout, ran.stderr) == (b"", b"")


def test_a_line_is_never_made_of_positional_arguments():
    with logging_to_memory(), pytest.raises(TypeError, match="fields by name"):
        log.warning("lost %s", "usb")


def test_for_people_a_line_is_plain_text_and_one_line_whatever_it_holds():
    with logging_to_memory(log_format="auto") as logged:
        log.warning("sound_lost", device="a\nb\x1b[2J")
    (line,) = logged.text.splitlines()
    assert "sound_lost" in line
    assert "[edgevox.test]" in line
    assert "\x1b" not in line
    assert "\\x1b[2J" in line


def test_colours_are_for_terminals_and_for_who_asks(monkeypatch):
    monkeypatch.delenv("NO_COLOR", raising=False)
    with logging_to_memory(log_format="console") as asked:
        log.warning("sound_lost")
    assert "\x1b[" in asked.text
    ours, theirs = pty.openpty()
    with open(theirs, "w", encoding="utf-8") as terminal:
        set_up(Settings(log_format="auto"), terminal)
        log.warning("sound_lost")
        tear_down()
    assert b"\x1b[" in os.read(ours, 4096)
    os.close(ours)


def test_a_reader_that_stops_reading_stops_nobody_and_is_told_what_it_missed():
    reading, writing = os.pipe()
    with open(writing, "w", encoding="utf-8") as stream, open(reading, "rb", buffering=0) as reader:
        set_up(Settings(log_format="json", log_level="info"), stream)
        for number in range(2000):
            log.info("flood", number=number, more="x" * 200)
        heard = reader.read(1 << 20)
        log.info("after")
        tear_down()
        heard += reader.read(1 << 20)
    lines = [json.loads(line) for line in heard.splitlines()]
    written = [line for line in lines if line["event"] == "flood"]
    (lost,) = [line["lines"] for line in lines if line["event"] == "log_lines_lost"]
    assert lost > 1000
    assert len(written) + lost == 2000
    assert lines[-1]["event"] == "after"
