"""What others send reaches a terminal or a log in codes: it steers neither, and forges no line."""

import logging
import re
import unicodedata
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st
from logs_rig import logging_to_memory

import edgevox
from edgevox.apps.console_command import main as console_command
from edgevox.apps.doctor.check import CheckAnswer, CheckVerdict
from edgevox.apps.doctor.command import print_table
from edgevox.apps.listen import ListenView
from edgevox.apps.streams import show
from edgevox.apps.terminal.view import UpdateBuffer, View
from edgevox.console.sessions import Role, Sessions
from edgevox.core.agent_events import GoalChanged, GoalRejected, GoalStatus, HandedOver, ToolCalled
from edgevox.core.bus import Bus
from edgevox.core.commands import Heard
from edgevox.core.controls import Controls
from edgevox.core.errors import InvalidValue
from edgevox.core.events import Responded, SentenceReady, TokenGenerated, Transcribed, WakeWordHeard
from edgevox.core.files.text import one_line, printable, printable_in_colour
from edgevox.core.log import Said, get_logger
from edgevox.core.reason import Reason
from edgevox.core.status import Level
from edgevox.ops.logs.observer import BusLog
from edgevox.scenario.format import SayStep
from edgevox.scenario.run import StepResult, line

log = get_logger("edgevox.test")
CODE = Path(edgevox.__file__).parent

FORGED = "12:00:00 [error] forged"
HOSTILE = (
    f"nice\x1b[31m\x1b]0;title\x07\r\n{FORGED}\x9b2J\x85{FORGED}"
    f"\N{RIGHT-TO-LEFT OVERRIDE}\N{LINE SEPARATOR}{FORGED}\N{PARAGRAPH SEPARATOR}\x7f\x00"
    "\N{LEFT-TO-RIGHT ISOLATE}\N{ZERO WIDTH SPACE}\U000e0041"
)


def is_tame(text: str, lines: int | None = None) -> bool:
    """Whether nothing in it steers a terminal, nor stands where a line of ours begins."""
    wild = {c for c in text if unicodedata.category(c) in {"Cc", "Cf", "Cs", "Co", "Zl", "Zp"}}
    wild -= {"\n", "\N{ZERO WIDTH JOINER}", "\N{ZERO WIDTH NON-JOINER}"}
    forged = any(one.startswith("12:00") for one in text.split("\n"))
    return not wild and not forged and (lines is None or text.count("\n") == lines)


@given(st.text())
def test_any_text_becomes_one_line_that_steers_nothing(text):
    assert is_tame(one_line(text).replace("12:00", ""), lines=0)
    assert printable_in_colour(text) == one_line(text) or "\x1b[" in text
    assert printable(text).count("\n") == text.count("\n")


def test_words_of_all_languages_stay_as_they_are():
    for text in ("La cuisine\N{NO-BREAK SPACE}?", "क्\N{ZERO WIDTH JOINER}ष", "停止", "Ёлка", "🤖"):
        assert one_line(text) == text


def test_half_a_character_is_a_code_too():
    assert one_line("\ud800") == "\\ud800"


def events(text: str):
    """Every event that a terminal or the log tells, with this text wherever a text may be."""
    why = Reason(text, "code", {"name": text})
    yield Transcribed(text, 1)
    yield TokenGenerated(text, 1)
    yield SentenceReady(text, 1)
    yield Responded(text, 1, detail=text)
    yield WakeWordHeard(text)
    yield HandedOver(text, text, 1)
    yield ToolCalled(text, {text: text, "deep": {text: [text]}}, text, 1)
    yield GoalRejected(text, text, why, text, 1)
    for status in (GoalStatus.RUNNING, GoalStatus.FAILED):
        yield GoalChanged("7", text, {text: text}, status, 1, {"progress": 0.5}, None, why)


def test_whatever_the_bus_tells_a_terminal_shows_tame():
    bus, shown = Bus(), []
    view = View(bus, shown.append)
    for event in events(HOSTILE):
        bus.publish(event)
        assert is_tame(view.status, lines=0)
    assert len(shown) > 3
    assert all(is_tame(one, lines=0) for one in shown)


def test_the_full_screen_gets_tame_lines():
    bus = Bus()
    updates = UpdateBuffer(bus, Controls(bus, language="en", voices=lambda _: ()))
    for event in events(HOSTILE):
        bus.publish(event)
    updates.write(HOSTILE)
    updates.log(f"\x1b[31mred\x1b[0m {HOSTILE}")
    news = updates.take()
    assert news.lines
    assert all(is_tame(one, lines=0) for one in (*news.lines, news.status))
    (logged,) = news.log_lines
    assert logged.startswith("\x1b[31mred\x1b[0m ")
    assert is_tame(logged.removeprefix("\x1b[31mred\x1b[0m ").replace("\x1b[31m", ""), lines=0)


@pytest.mark.parametrize("form", ["json", "console"])
def test_whatever_is_logged_is_tame(form):
    bus = Bus()
    with logging_to_memory(log_format=form, log_speech=True, log_level="debug") as logged:
        watching = BusLog(bus, lambda *_: True)
        for event in events(HOSTILE):
            bus.publish(event)
        watching.close()
        log.warning("odd", text=Said(HOSTILE), list=[HOSTILE], deep={HOSTILE: [{HOSTILE: 1}]})
        logging.getLogger("library").warning("%s", HOSTILE)
        logging.getLogger("library").warning("kept %r", {HOSTILE: HOSTILE})
        try:
            raise ValueError(HOSTILE)
        except ValueError:
            log.exception("broke", what=HOSTILE)
    text = logged.text
    if form == "console":
        text = "\n".join(map(one_line_but_colours, text.split("\n")))
    assert text.count("\n") > 5
    assert is_tame(text)


def one_line_but_colours(text: str) -> str:
    return re.sub(r"\x1b\[[0-9;]*m", "", text)


def test_json_gives_back_what_was_sent_though_its_text_is_tame():
    with logging_to_memory() as logged:
        log.warning("odd", what=HOSTILE)
    (told,) = logged.lines
    assert told["what"] == HOSTILE
    assert is_tame(logged.text)


def test_an_error_is_one_tame_line_whatever_it_names(capsys):
    error = InvalidValue(HOSTILE, HOSTILE, HOSTILE)
    assert is_tame(str(error), lines=0)
    show(f"edgevox-agent: {error}", error=True)
    assert is_tame(capsys.readouterr().err, lines=1)


def test_the_commands_print_tame_lines(tmp_path, capsys):
    sessions = Sessions(tmp_path)
    sessions.begin(Role.OPERATOR, HOSTILE, HOSTILE)
    assert console_command(["--console-folder", str(tmp_path), "list"]) == 0
    assert is_tame(capsys.readouterr().out, lines=1)

    verdict = CheckVerdict(Level.ERROR, HOSTILE, HOSTILE)
    print_table([CheckAnswer(HOSTILE, verdict)])
    assert is_tame(capsys.readouterr().out)

    outcome = StepResult(1, SayStep(say=HOSTILE), False, 0.0, 0.0, (HOSTILE,))
    assert is_tame(line(outcome), lines=1)

    shown = []
    view = ListenView(shown.append, live=False)
    view.command(Heard(HOSTILE, 0.0))
    view.woken(WakeWordHeard(HOSTILE))
    assert all(is_tame(one, lines=1) for one in shown)
