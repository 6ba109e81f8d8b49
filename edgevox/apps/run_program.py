"""The common frame of all programs: their logs, their end, and their exit codes.

SIGTERM and SIGHUP become an orderly end, once the robot stands.
"""

import logging
import os
import signal
import sys
import threading
from collections.abc import Callable
from types import FrameType, TracebackType

from edgevox import __version__
from edgevox.apps.streams import show
from edgevox.core.errors import EdgeVoxError, InvalidValue
from edgevox.core.log import get_logger
from edgevox.core.motion.drain import Drain
from edgevox.core.settings import Settings
from edgevox.models import ModelMissing
from edgevox.ops.logs import set_up, tear_down, writes_json
from edgevox.ops.machine import return_memory
from edgevox.security.startup import secure_process

log = get_logger(__name__)

_SIGNALS = (signal.SIGTERM, signal.SIGHUP)
STUCK = 70
"""EX_SOFTWARE of sysexits.h: asked to end, and something would not let go."""
LAST_HALT_S = 0.5
"""Seconds for the body's last halt, if everything else hangs."""


class Terminated(BaseException):
    """A signal said that it is time to leave: unwind."""


class ShutdownSignals:
    """While entered, the first of these signals ends the main thread's work; more are ignored.

    With a `drain`, SIGTERM begins it, and ends the program after it; a second signal ends the
    program at once. SIGHUP and Ctrl-C do not wait: the person at the terminal has gone, or wants an
    end now.

    `gently`, if set, is asked to end the work and returns whether it will; else `Terminated` is
    raised, which an event loop would not let through. If something hangs then, the process ends
    after `leave_s` (the setting), with the exit code `STUCK`, after a halt of the body.
    """

    def __init__(self, leave_s: float, drain: Drain | None = None) -> None:
        self._leave_s = leave_s
        self._drain = drain
        self._draining = False
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
            self._leave_within(self._leave_s)

    def _arrived(self, number: int, _frame: FrameType | None) -> None:
        self.signal = self.signal or signal.Signals(number).name
        if self._drain and number == signal.SIGTERM and not self._draining:
            self._draining = True
            self._begin(self._drain)
            return
        self._ignore()
        self._leave_within(self._leave_s)
        if self.gently is None or not self.gently():
            raise Terminated

    def _begin(self, drain: Drain) -> None:
        """Drain on another thread: this one may hold any lock, in the middle of anything."""
        threading.Thread(
            target=self._drain_then_end, args=(drain,), name="edgevox-leaving", daemon=True
        ).start()

    def _drain_then_end(self, drain: Drain) -> None:
        drain.until_over(self.signal)
        self._leave_within(self._leave_s)  # also where the main thread takes no signal any more
        if main := threading.main_thread().ident:
            signal.pthread_kill(main, signal.SIGTERM)  # to that thread, so that it wakes

    def _ignore(self) -> None:
        for one in (*_SIGNALS, signal.SIGINT):  # `ros2 launch` and people repeat their Ctrl-C
            signal.signal(one, signal.SIG_IGN)

    def _leave_within(self, leave_s: float) -> None:
        """End the process if it does not end by itself; a daemon, so it keeps nobody."""
        late = threading.Timer(leave_s, self._give_up, (leave_s,))
        late.daemon = True
        late.start()

    def _give_up(self, waited_s: float) -> None:
        self._halt()
        held = sorted(one.name for one in threading.enumerate() if not one.daemon)
        if logging.getLogger().handlers:
            log.critical("leaving_late", waited_s=waited_s, threads=held)
        else:  # the program itself is over, and its log with it
            show(f"leaving without what does not end: {', '.join(held)}", error=True)
        sys.stdout.flush()
        sys.stderr.flush()
        os._exit(STUCK)

    def _halt(self) -> None:
        """Halt the body when nothing else would end its motion, even if the body hangs."""
        if self._drain:
            last = threading.Thread(target=self._drain.halt, name="edgevox-last-halt", daemon=True)
            last.start()
            last.join(LAST_HALT_S)


OK, FAILED, USAGE_ERROR = 0, 1, 2


def run_program(name: str, prepare: Callable[[], Callable[[], bool]]) -> int:
    """Prepare, then run what came of it; the process's exit code, with the reason on stderr."""
    return_memory()
    code = _run(name, prepare)
    log.info("program_ended", program=name, code=code)
    tear_down()  # what nobody caught leaves earlier: then the interpreter ends, and says so itself
    return code


def set_up_logs(name: str, settings: Settings) -> None:
    """Log to stderr as the settings say, beginning with who logs."""
    set_up(settings)
    given = settings.model_dump(mode="json", exclude_defaults=True)
    log.info("program_started", program=name, version=__version__, settings=given)


def secure_ros2(name: str, settings: Settings) -> None:
    """DDS security for nodes of this process, if it is asked for. Raises `InvalidValue`."""
    secure_process(
        name,
        settings.agent_namespace,
        lambda found: log.warning("security_warning", found=found),
    )


def _run(name: str, prepare: Callable[[], Callable[[], bool]]) -> int:
    try:
        run = prepare()
    except ModelMissing as error:
        return _fail(name, error, FAILED)
    except EdgeVoxError as error:
        return _fail(name, error, USAGE_ERROR)
    except KeyboardInterrupt:
        return OK
    try:
        return OK if run() else FAILED
    except InvalidValue as error:
        return _fail(name, error, USAGE_ERROR)
    except EdgeVoxError as error:
        return _fail(name, error, FAILED)
    except (Terminated, KeyboardInterrupt):
        return OK


def _fail(name: str, error: EdgeVoxError, code: int) -> int:
    """Say it to whoever reads: a person, or a program that takes only JSON."""
    for one in error.problems if isinstance(error, InvalidValue) else (error,):
        if writes_json():
            log.critical("program_failed", program=name, reason=str(one))
        else:
            show(f"{name}: {one}", error=True)
    return code
