"""How a component is. It says so once; health, /metrics and /diagnostics show it.

The doctor looks at a machine on which no agent may run, so it has checks of its own. What is judged
in more than one place, such as when something stalls, is judged here.

A fault: what something that keeps trying says while it cannot do its work.

Whether a count has grown of late: a fault that is over must not be shown for ever.
"""

from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from enum import IntEnum, StrEnum
from typing import Protocol, Self, runtime_checkable

from edgevox.core.clock import Clock, SystemClock
from edgevox.core.log import get_logger, worth_a_line

log = get_logger(__name__)


@runtime_checkable
class ReportsFault(Protocol):
    """Knows why it cannot do its work now. It goes on trying by itself."""

    @property
    def fault(self) -> str:
        """The reason in a few words; empty if all is well. From any thread."""


def fault_of(thing: object) -> str:
    """What it says is wrong; empty for what cannot say it."""
    return thing.fault if isinstance(thing, ReportsFault) else ""


LATELY_S = 10.0
"""For so long something that happened is shown as a fault; its count stays."""


class RecentIncrease:
    """Watches a counter that only grows. Asked from any thread."""

    def __init__(self, clock: Clock | None = None, window_s: float = LATELY_S) -> None:
        self._clock = clock or SystemClock()
        self._window_s = window_s
        self._seen = 0
        self._grew_s = float("-inf")

    def grew(self, count: int) -> bool:
        """Whether it has grown within the last seconds; `count` is what it is now."""
        now_s = self._clock.now()
        if count > self._seen:
            self._grew_s = now_s
        self._seen = max(self._seen, count)
        return now_s - self._grew_s < self._window_s


LATE_S = 1.0
"""What should move and has not for this long is worth a word."""
STALL_S = 6.0
"""What should move and has not for this long is frozen."""

Value = bool | int | float | str | None
"""None is what is not known yet. Its name ends in its unit (``last_s``, ``free_mib``), if any."""


class ComponentName(StrEnum):
    """What every agent lists, in this order."""

    AUDIO = "audio"
    STT = "stt"
    LLM = "llm"
    TTS = "tts"
    SIM = "sim"
    EXECUTOR = "executor"
    PRESENCE = "presence"
    INTERLOCK = "interlock"
    CONSOLE = "console"
    POLICY = "policy"
    DISK = "disk"
    PROCESS = "process"


class Level(IntEnum):
    """How well something is, in the words and numbers of `diagnostic_msgs`.

    Stale is what nobody has looked at.
    """

    OK = 0
    WARN = 1
    ERROR = 2
    STALE = 3


@dataclass(frozen=True, slots=True)
class Finding:
    """Something that is not as it should be."""

    level: Level
    text: str


@dataclass(frozen=True, slots=True)
class Status:
    """One component's word: how it is, why in a few words, and what can be read off it."""

    name: str
    level: Level
    message: str
    values: Mapping[str, Value] = field(default_factory=dict)

    @classmethod
    def judged(
        cls, name: str, findings: Sequence[Finding] = (), *, well: str = "works", **values: Value
    ) -> Self:
        """With what was found, the worst first and its level for all; `well` if that is nothing."""
        worst_first = sorted(findings, key=lambda finding: -finding.level)
        level = worst_first[0].level if worst_first else Level.OK
        return cls(name, level, "; ".join(one.text for one in worst_first) or well, values)

    @property
    def texts(self) -> Mapping[str, str]:
        """The values for people, without those that nobody knows yet."""
        return {name: _text(value) for name, value in self.values.items() if value is not None}


@dataclass(frozen=True, slots=True)
class HealthCheck:
    """What health asks of a component: `look` says what is wrong, empty if nothing is.

    Without a `vital` one the process cannot do its work and should be started again; without
    another it is not ready, and a new start would not help. It stands apart from the status since
    a probe must be answered whatever hangs: it looks at this only, and waits for nothing.
    """

    name: str
    look: Callable[[], str]
    vital: bool = True

    def said(self) -> str:
        """What is wrong; one that breaks is a finding like any other."""
        try:
            return self.look()
        except Exception as error:  # noqa: BLE001 - whoever is asked may raise what he likes
            return f"the check failed: {error!r}"


class Component(Protocol):
    """Says how it is. Both may be asked from any thread."""

    @property
    def name(self) -> str: ...

    @property
    def checks(self) -> Sequence[HealthCheck]:
        """What health asks of it."""

    def status(self) -> Status:
        """How it is now. Quick."""


@dataclass(frozen=True, slots=True)
class Off:
    """A component that was not asked for, which is well; `level` is worse where it was."""

    name: str
    why: str
    checks: tuple[HealthCheck, ...] = ()
    level: Level = Level.OK

    def status(self) -> Status:
        """That it is off."""
        return Status(self.name, self.level, f"off: {self.why}")


class Components:
    """Components by name, added as parts start and listed in that order."""

    def __init__(self, *components: Component) -> None:
        self._by_name = {one.name: one for one in components}
        self._broke: Counter[str] = Counter()

    @property
    def failures(self) -> int:
        """How often one of them was asked and could not say how it is."""
        return self._broke.total()

    def add(self, *components: Component) -> None:
        """List these from now on, each in place of one of the same name."""
        self._by_name = {**self._by_name, **{one.name: one for one in components}}

    @property
    def checks(self) -> Iterable[HealthCheck]:
        """What health asks of them."""
        return (check for one in self._by_name.values() for check in one.checks)

    def statuses(self, names: Iterable[str] | None = None) -> list[Status]:
        """What all, or those of them that are named, say now.

        One that cannot even be asked is an error, with its reason; it is counted and logged.
        """
        asked = self._by_name if names is None else [one for one in self._by_name if one in names]
        return [self._ask(name) for name in asked]

    def _ask(self, name: str) -> Status:
        try:
            return self._by_name[name].status()
        except Exception as error:  # noqa: BLE001 - one that breaks is a finding like any other
            self._broke[name] += 1
            if worth_a_line(self._broke[name]):
                log.warning("component_unreadable", component=name, error=repr(error))
            return Status(name, Level.ERROR, f"cannot be looked at: {error!r}")


def moves(stalled_s: Callable[[], float]) -> Callable[[], str]:
    """A look at something that says for how long it has stalled."""

    def look() -> str:
        seconds = stalled_s()
        return f"has {_still(seconds)}" if seconds > STALL_S else ""

    return look


def lives(alive: Callable[[], bool]) -> Callable[[], str]:
    """A look at something with threads."""
    return lambda: "" if alive() else "its thread has ended"


def stall(seconds: float, what: str) -> list[Finding]:
    """What has not moved for so long is late, and then frozen."""
    if seconds <= LATE_S:
        return []
    level = Level.ERROR if seconds > STALL_S else Level.WARN
    return [Finding(level, f"{what} {_still(seconds)}")]


def _still(seconds: float) -> str:
    return f"not moved for {seconds:.1f} s"


def _text(value: Value) -> str:
    if isinstance(value, bool):
        return str(value).lower()
    return f"{value:.4g}" if isinstance(value, float) else str(value)
