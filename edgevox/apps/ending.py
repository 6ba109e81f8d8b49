"""Turns SIGTERM and SIGHUP into an orderly end of the main thread."""

import signal
from collections.abc import Callable
from types import FrameType, TracebackType

_SIGNALS = (signal.SIGTERM, signal.SIGHUP)


class Terminated(BaseException):
    """A signal said that it is time to leave: unwind."""


class Ending:
    """While entered, the first of these signals ends what the main thread does; more are ignored.

    `gently`, if set, is asked to end it and says whether it will; else `Terminated` is raised,
    which an event loop would not let through.
    """

    def __init__(self) -> None:
        self.gently: Callable[[], bool] | None = None

    def __enter__(self) -> "Ending":
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

    def _arrived(self, _number: int, _frame: FrameType | None) -> None:
        self._ignore()
        if self.gently is None or not self.gently():
            raise Terminated

    def _ignore(self) -> None:
        for one in (*_SIGNALS, signal.SIGINT):  # `ros2 launch` and people repeat their Ctrl-C
            signal.signal(one, signal.SIG_IGN)
