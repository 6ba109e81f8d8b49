"""Where programs are kept: each is put there once, taken once, and told of on the bus."""

import threading
from collections.abc import Callable, Sequence
from typing import Protocol

from edgevox.agent.programs.kept import Kept
from edgevox.agent.programs.program import After, Program
from edgevox.agent.programs.program_limits import MAX_PROGRAMS
from edgevox.agent.reasons import because
from edgevox.agent.skills import SkillFailed
from edgevox.core.agent_events import ProgramChanged, ProgramStatus
from edgevox.core.bus import Bus
from edgevox.core.cancel import CancelToken
from edgevox.core.clock import Clock
from edgevox.core.reason import Reason

_TENTHS = 1


class Timer(Protocol):
    """Does things later, on one thread that else sleeps: `Deadlines` is one."""

    def start(self) -> None: ...

    def close(self) -> None: ...

    def set(self, seconds: float, action: Callable[[], None]) -> Callable[[], None]:
        """Do it after so many seconds. Returns a way to call it off."""


class ProgramStore:
    """The programs that wait and run, in the order of their orders. Any thread may ask.

    `describe` says a program in words.
    """

    def __init__(
        self, bus: Bus, clock: Clock, timer: Timer, describe: Callable[[Program], str]
    ) -> None:
        self._bus = bus
        self._clock = clock
        self._timer = timer
        self._describe = describe
        self._lock = threading.Lock()
        self._telling = threading.RLock()
        self._kept: dict[str, Kept] = {}

    @property
    def all(self) -> Sequence[Kept]:
        """Those that wait and run."""
        with self._lock:
            return tuple(self._kept.values())

    def has(self, kept: Kept) -> bool:
        """Whether it was not taken yet."""
        with self._lock:
            return kept.id in self._kept

    def put(self, kept: Kept, asked: CancelToken) -> bool:
        """Keep it, unless who asked was stopped; raises `SkillFailed` where there is no room."""
        with self._lock:
            if asked.cancelled:
                return False
            if len(self._kept) >= MAX_PROGRAMS:
                raise SkillFailed(because("programs_full", count=str(MAX_PROGRAMS)))
            self._kept[kept.id] = kept
            return True

    def take(self, kept: Kept) -> bool:
        """Keep it no longer; False if it was taken before."""
        with self._lock:
            taken = self._kept.pop(kept.id, None) is not None
            if taken:
                kept.call_off()
            return taken

    def later(self, kept: Kept, seconds: float, action: Callable[[], None]) -> None:
        """Do this after so many seconds if it is kept then, instead of what was to be done."""
        with self._lock:
            if kept.id in self._kept:
                kept.call_off()
                kept.call_off = self._timer.set(seconds, action)

    def text(self, kept: Kept) -> str:
        """What it will do from now on, as a person is told."""
        left = kept.program
        if isinstance(left, After) and kept.due_s is not None:
            left = After(max(0.0, kept.due_s - self._clock.now()), left.program)
        return self._describe(left)

    def event(
        self, kept: Kept, status: ProgramStatus | None = None, reason: Reason | None = None
    ) -> ProgramChanged:
        """How it is, as an event."""
        due_in_s = None
        if kept.due_s is not None and status is None:
            due_in_s = round(max(0.0, kept.due_s - self._clock.now()), _TENTHS)
        now = status or kept.status
        return ProgramChanged(
            kept.id, self.text(kept), now, kept.turn, due_in_s, kept.round, reason
        )

    def tell(
        self, kept: Kept, end: ProgramStatus | None = None, reason: Reason | None = None
    ) -> None:
        """Say on the bus how it is, or how it ended, which is the last that is told of it."""
        with self._telling:
            if end is not None or self.has(kept):
                self._bus.publish(self.event(kept, end, reason))
