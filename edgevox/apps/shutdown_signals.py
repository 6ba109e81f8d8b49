"""Turns SIGTERM and SIGHUP into an orderly end of the main thread."""

import logging
import os
import signal
import sys
import threading
from collections.abc import Callable
from types import FrameType, TracebackType

from edgevox.core.log import get_logger

log = get_logger(__name__)

_SIGNALS = (signal.SIGTERM, signal.SIGHUP)
STUCK = 70
"""EX_SOFTWARE of sysexits.h: asked to end, and something would not let go."""


class Terminated(BaseException):
    """A signal said that it is time to leave: unwind."""


class ShutdownSignals:
    """While entered, the first of these signals ends what the main thread does; more are ignored.

    `gently`, if set, is asked to end it and says whether it will; else `Terminated` is raised,
    which an event loop would not let through. Whatever hangs then, the process is gone after
    `leave_s` (the setting), with the exit code `STUCK`.
    """

    def __init__(self, leave_s: float) -> None:
        self._leave_s = leave_s
        self.gently: Callable[[], bool] | None = None
        self.signal = ""
        """The signal that arrived, such as SIGTERM; empty if none did."""

    def __enter__(self) -> "ShutdownSignals":
        for one in _SIGNALS:
            signal.signal(one, self._arrived)
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._ignore()
        if isinstance(error, KeyboardInterrupt):
            _leave_within(self._leave_s)

    def _arrived(self, number: int, _frame: FrameType | None) -> None:
        self._ignore()
        _leave_within(self._leave_s)
        self.signal = signal.Signals(number).name
        if self.gently is None or not self.gently():
            raise Terminated

    def _ignore(self) -> None:
        for one in (*_SIGNALS, signal.SIGINT):  # `ros2 launch` and people repeat their Ctrl-C
            signal.signal(one, signal.SIG_IGN)


def _leave_within(leave_s: float) -> None:
    """End the process if it does not end by itself; a daemon, so it keeps nobody."""
    late = threading.Timer(leave_s, _give_up, (leave_s,))
    late.daemon = True
    late.start()


def _give_up(waited_s: float) -> None:
    held = sorted(one.name for one in threading.enumerate() if not one.daemon)
    if logging.getLogger().handlers:
        log.critical("leaving_late", waited_s=waited_s, threads=held)
    else:  # the program itself is over, and its log with it
        print(f"leaving without what does not end: {', '.join(held)}", file=sys.stderr)
    sys.stdout.flush()
    sys.stderr.flush()
    os._exit(STUCK)
