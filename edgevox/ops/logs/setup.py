"""Puts all lines of a program into one stream, and takes that back.

The handler that writes lines, and waits for nobody: a robot must not stop for its logs.

It is our own, because behind a `logging.handlers.QueueHandler` the listener's thread would wait for
a reader that has stopped: lines would pile up or vanish uncounted, the program's end would wait for
that thread, and the last lines before a crash would still be in the queue.

Uncaught errors become lines of the log: of threads, the main thread and finalisers.

A logger is called after its module: `edgevox` is all of EdgeVox, `edgevox.voice` speech in and out;
a library has its own name. The empty name is above all, and begins with the setting `log_level`.
Levels have the names that ROS 2 uses, and may change while all runs; a level of 0 means: as the
logger above.

`RateLimit` holds back the lines of a fault that repeats: a robot that fails all night fills no
disk.

`TurnLines` gives the lines of one turn or goal to whoever may watch: without speech, traces and
floods.
"""

import contextlib
import faulthandler
import json
import logging
import os
import re
import sys
import threading
from collections import OrderedDict
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from io import UnsupportedOperation
from types import TracebackType
from typing import Any, TextIO

from edgevox.core.clock import Clock, SystemClock
from edgevox.core.errors import Refusal
from edgevox.core.files.text import one_line
from edgevox.core.log import ROOT, LogLine, get_logger
from edgevox.core.process import OutputReader
from edgevox.core.settings import Settings
from edgevox.ops.logs.line_formatter import IDS, console_lines, json_lines, plain

log = get_logger(__name__)

MOST_LINES = 5
WINDOW_S = 60.0
MOST_EVENTS = 256
"""So many events are counted at once; of more, the one that was silent longest is forgotten."""
HELD_BACK = "lines_held_back"
_VERDICT = "_edgevox_passes"
_NUMBERS = re.compile(r"\d+")

Key = tuple[str, str]


@dataclass(slots=True)
class _Window:
    since_s: float
    level: int
    passed: int = 0
    held: int = 0


class RateLimit(logging.Filter):
    """Lets the first lines of an event pass in each window, and tells how many it held back.

    Only warnings and worse are counted, each event of each logger for itself, and each reason of a
    refusal. That lines were held back is told when the window is over, with the next line of
    whatever event. Several handlers may have one each: the first that sees a record decides.
    """

    def __init__(
        self,
        clock: Clock | None = None,
        most: int = MOST_LINES,
        window_s: float = WINDOW_S,
    ) -> None:
        super().__init__()
        self._clock = clock or SystemClock()
        self._most, self._window_s = most, window_s
        self._lock = threading.Lock()
        self._windows: OrderedDict[Key, _Window] = OrderedDict()

    def filter(self, record: logging.LogRecord) -> bool:
        """Whether this line may pass."""
        verdict = getattr(record, _VERDICT, None)
        if verdict is None:
            verdict = self._judge(record)
            setattr(record, _VERDICT, verdict)
        return bool(verdict)

    def tell(self, *, all_windows: bool = True) -> None:
        """Say what was held back; with `all_windows` also where the window is not over yet."""
        for key, window in self._over(all_windows=all_windows):
            _tell(key, window, self._window_s)

    def _judge(self, record: logging.LogRecord) -> bool:
        if record.levelno < logging.WARNING:
            self.tell(all_windows=False)
            return True
        key = _key(record)
        if key[1] == HELD_BACK:
            return True
        self.tell(all_windows=False)
        with self._lock:
            window = self._windows.get(key)
            if window is None:
                window = self._windows[key] = _Window(self._clock.now(), record.levelno)
                forgotten = self._windows.popitem(last=False) if self._full else None
            else:
                self._windows.move_to_end(key)
                forgotten = None
            passes = window.passed < self._most
            window.passed += passes
            window.held += not passes
        if forgotten and forgotten[1].held:
            _tell(*forgotten, self._window_s)
        return passes

    @property
    def _full(self) -> bool:
        return len(self._windows) > MOST_EVENTS

    def _over(self, *, all_windows: bool) -> list[tuple[Key, _Window]]:
        """Take out the windows that are over; those in which something was held back."""
        if not self._windows:
            return []
        until_s = self._clock.now() - self._window_s
        with self._lock:
            over = [k for k, w in self._windows.items() if all_windows or w.since_s <= until_s]
            taken = [(key, self._windows.pop(key)) for key in over]
        return [(key, window) for key, window in taken if window.held]


def _key(record: logging.LogRecord) -> Key:
    if isinstance(record.msg, LogLine):
        event, reason = str(record.msg.get("event")), record.msg.get("reason")
        return record.name, f"{event} {reason}" if isinstance(reason, Refusal) else event
    return record.name, _NUMBERS.sub("#", str(record.msg)[:200])


def _tell(key: Key, window: _Window, window_s: float) -> None:
    name, event = key
    logger = logging.getLogger(name)
    if logger.isEnabledFor(window.level):
        line = LogLine(event=HELD_BACK, of=event, lines=window.held, window_s=window_s)
        logger.log(window.level, line)


LEVELS: Mapping[str, int] = {
    "unset": logging.NOTSET,
    "debug": logging.DEBUG,
    "info": logging.INFO,
    "warn": logging.WARNING,
    "warning": logging.WARNING,
    "error": logging.ERROR,
    "fatal": logging.CRITICAL,
}
"""The numbers are the same for Python and for ROS 2."""


def level_of(name: str) -> int:
    """The level that was set for this logger; 0 if none was. Makes no logger."""
    logger = logging.getLogger() if not name else logging.Logger.manager.loggerDict.get(name)
    return logger.level if isinstance(logger, logging.Logger) else logging.NOTSET


def set_level(name: str, level: int) -> None:
    """Show this logger's lines of that level and above, and those of the loggers below it."""
    logging.getLogger(name or None).setLevel(level)


class LineStream(logging.Handler):
    """Writes to `stream`. Where that is a pipe whose reader has stopped, lines are dropped.

    They are counted, and the count is written when the reader goes on.
    """

    def __init__(self, stream: TextIO) -> None:
        super().__init__()
        self._stream = stream
        self._reader = _reader_of(stream)
        self.lost = 0

    def in_colour(self) -> bool:
        """Whether it is a terminal at this moment; the full screen puts a pipe in its place."""
        return _is_terminal(self._stream) and "NO_COLOR" not in os.environ

    def emit(self, record: logging.LogRecord) -> None:
        """Write one line, or lose it."""
        try:
            text = self.format(record)
            if self._reader and not self._reader.awake():
                self.lost += 1
                return
            if self.lost:
                lost, self.lost = self.lost, 0
                self._write(self.format(_lost(lost)))
            self._write(text)
        except Exception:  # noqa: BLE001 - told by handleError, as logging does
            self.handleError(record)

    def handleError(self, record: logging.LogRecord) -> None:  # noqa: N802 - logging's name
        """A line that cannot be written must not stop who wrote it; try to say which it was."""
        at = f"{record.name}:{record.lineno}"
        told = {"level": "error", "logger": __name__, "event": "log_line_broken", "at": at}
        with contextlib.suppress(Exception):
            self._write(json.dumps(told))

    def _write(self, text: str) -> None:
        self._stream.write(text + "\n")
        self._stream.flush()


def _reader_of(stream: TextIO) -> OutputReader | None:
    """Who reads the stream; None where there is no file behind it."""
    try:
        return OutputReader(stream.fileno())
    except (OSError, ValueError, UnsupportedOperation):
        return None


def _is_terminal(stream: TextIO) -> bool:
    try:
        return os.isatty(stream.fileno())
    except (OSError, ValueError, UnsupportedOperation):
        return False


def _lost(lines: int) -> logging.LogRecord:
    about = {"name": __name__, "levelno": logging.WARNING, "levelname": "WARNING"}
    line = LogLine(event="log_lines_lost", lines=lines)
    return logging.makeLogRecord({**about, "msg": line})


def catch_uncaught() -> Callable[[], None]:
    """Log them from now on. Returns a way to undo it."""
    before = sys.excepthook, threading.excepthook, sys.unraisablehook
    sys.excepthook, threading.excepthook = _of_program, _of_thread
    sys.unraisablehook = _of_finaliser

    def undo() -> None:
        sys.excepthook, threading.excepthook, sys.unraisablehook = before

    return undo


def _of_program(
    kind: type[BaseException], error: BaseException, where: TracebackType | None
) -> None:
    if issubclass(kind, KeyboardInterrupt):
        sys.__excepthook__(kind, error, where)
        return
    log.critical("program_broke", exc_info=(kind, error, where))


def _of_thread(told: threading.ExceptHookArgs) -> None:
    if told.exc_type is SystemExit:
        return
    name = told.thread.name if told.thread else "?"
    error = told.exc_value or told.exc_type()
    log.critical("thread_broke", thread=name, exc_info=(told.exc_type, error, told.exc_traceback))


def _of_finaliser(told: Any) -> None:
    error = told.exc_value or told.exc_type()
    where = told.err_msg or f"in {told.object!r}"
    log.error("finaliser_broke", where=where, exc_info=(told.exc_type, error, told.exc_traceback))


_UNREAD = ("logThreads", "logProcesses", "logMultiprocessing")
"""What logging finds out for every record, unless told not to, and no line of ours shows."""


class ProgramLog(LineStream):
    """The one handler of a program's root logger, with all that `tear_down` has to undo."""

    def __init__(self, settings: Settings, stream: TextIO) -> None:
        super().__init__(stream)
        self.json = settings.log_format == "json"
        speech, colours = settings.log_speech, settings.log_format == "console"
        self.setFormatter(
            json_lines(speech=speech)
            if self.json
            else console_lines(speech=speech, in_colour=_always if colours else self.in_colour)
        )
        self.limit = RateLimit()
        self.addFilter(self.limit)
        self._level_before = logging.getLogger().level
        self._kept_before = {name: getattr(logging, name) for name in _UNREAD}
        self._undo: Callable[[], None] = lambda: None

    def open(self, level: str) -> None:
        """From now on, everything goes here."""
        root = logging.getLogger()
        root.addHandler(self)
        root.setLevel(level.upper())
        for name in _UNREAD:
            setattr(logging, name, False)
        self._undo = catch_uncaught()
        logging.captureWarnings(capture=True)

    def close(self) -> None:
        """As it was before."""
        root = logging.getLogger()
        if self in root.handlers:
            self.limit.tell()
            logging.captureWarnings(capture=False)
            self._undo()
            root.removeHandler(self)
            root.setLevel(self._level_before)
            for name, kept in self._kept_before.items():
                setattr(logging, name, kept)
        super().close()


def set_up(settings: Settings, stream: TextIO | None = None) -> None:
    """All lines of this program to stderr, as the settings say; called again, it changes that."""
    tear_down()
    ProgramLog(settings, stream or sys.stderr).open(settings.log_level)
    if stream is None and not faulthandler.is_enabled():
        _show_crashes()


def tear_down() -> None:
    """Log as a library does: it is for others to say where to."""
    for handler in _open():
        handler.close()


def is_set_up() -> bool:
    """Whether a program's lines go to one stream."""
    return bool(_open())


def writes_json() -> bool:
    """Whether it is for programs to read."""
    return any(one.json for one in _open())


def _open() -> list[ProgramLog]:
    return [one for one in logging.getLogger().handlers if isinstance(one, ProgramLog)]


def _show_crashes() -> None:
    """Where an engine in C kills the process, say which threads did what."""
    try:
        faulthandler.enable()
    except (OSError, ValueError, AttributeError):  # no stderr, or one without a file
        return


def _always() -> bool:
    return True


MOST_CHARACTERS = 400
"""Of the fields of one line; the rest is in the log itself."""

Tell = Callable[[Mapping[str, Any]], object]


class TurnLines(logging.Handler):
    """Gives EdgeVox's own lines that belong to a turn or a goal to `tell`, from `open` to `close`.

    Each is a mapping of `level`, `event`, `turn` (0 without one) and `text`, its other fields. What
    somebody said is told as its length, whatever `log_speech` says; an exception as its kind. Lines
    of libraries, which mark nothing, are not told. `tell` is called on any thread.
    """

    def __init__(self, tell: Tell) -> None:
        super().__init__(logging.INFO)
        self._tell = tell
        self.addFilter(RateLimit())

    def open(self) -> None:
        """From now on. The program's own log decides first what is held back."""
        logging.getLogger().addHandler(self)

    def close(self) -> None:
        """No more."""
        logging.getLogger().removeHandler(self)
        super().close()

    def emit(self, record: logging.LogRecord) -> None:
        """Tell one line, if it is one of a turn or a goal."""
        line = record.msg
        ours = f"{record.name}.".startswith(f"{ROOT}.")
        if ours and isinstance(line, LogLine) and any(line.get(name) for name in IDS):
            try:
                self._tell(_told(record, line))
            except Exception:  # noqa: BLE001 - told by handleError, as logging does
                self.handleError(record)


def _told(record: logging.LogRecord, line: LogLine) -> dict[str, Any]:
    fields = {
        name: plain(value, speech=False)
        for name, value in line.items()
        if name not in (*IDS, "event")
    }
    if record.exc_info and record.exc_info[0]:
        fields["exception"] = record.exc_info[0].__name__
    text = one_line(" ".join(f"{name}={value}" for name, value in fields.items()))
    return {
        "level": record.levelname.lower(),
        "event": str(line.get("event", "")),
        "turn": line.get("turn", 0),
        "text": text[:MOST_CHARACTERS],
    }
