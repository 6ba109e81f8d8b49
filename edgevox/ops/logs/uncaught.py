"""What nobody caught becomes a line, too: of threads, of the main thread, of finalisers."""

import sys
import threading
from collections.abc import Callable
from types import TracebackType
from typing import Any

from edgevox.core.log import get_logger

log = get_logger(__name__)


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
