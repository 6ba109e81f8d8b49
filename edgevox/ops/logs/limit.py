"""Holds back the lines of a fault that repeats: a robot that fails all night fills no disk."""

import logging
import re
import threading
from collections import OrderedDict
from dataclasses import dataclass

from edgevox.core.clock import Clock, SystemClock
from edgevox.core.errors import Refusal
from edgevox.core.log import LogLine

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
