"""The lines of one turn or goal, for whoever may watch: without speech, traces and floods."""

import logging
from collections.abc import Callable, Mapping
from typing import Any

from edgevox.core.files.text import one_line
from edgevox.core.log import ROOT, LogLine
from edgevox.ops.logs.limit import RateLimit
from edgevox.ops.logs.line_formatter import IDS, plain

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
