"""The status of components, reported once and shown by health, /metrics and /diagnostics.

Judgements for several components, such as when something stalls, are here too. The doctor has its
own checks, because it looks at a machine on which no agent may run.

`Gauges` are readings that components take from the bus: of loudness, and of the last turns.
"""

from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from enum import IntEnum, StrEnum
from typing import Protocol, Self, runtime_checkable

from edgevox.core.bus import Bus
from edgevox.core.clock import Clock, SystemClock
from edgevox.core.events import AudioLevel, Outcome, TokenGenerated, TurnEnded, TurnMeasured
from edgevox.core.log import get_logger, worth_a_line

log = get_logger(__name__)


@runtime_checkable
class ReportsFault(Protocol):
    """A part that keeps trying, and knows why it cannot do its work now."""

    @property
    def fault(self) -> str:
        """The reason in a few words; empty if all is well. From any thread."""


def fault_of(thing: object) -> str:
    """The fault of a thing; empty if it reports none or cannot."""
    return thing.fault if isinstance(thing, ReportsFault) else ""


@runtime_checkable
class ReportsDoubts(Protocol):
    """A part that does its work, and knows what is not as it should be."""

    @property
    def doubts(self) -> Sequence[str]:
        """Each in a few words. From any thread."""


LATELY_S = 10.0
"""Seconds for which an event is shown as a fault; its count stays."""


class RecentIncrease:
    """Watches a counter that only grows, so that an old fault is not shown forever."""

    def __init__(self, clock: Clock | None = None, window_s: float = LATELY_S) -> None:
        self._clock = clock or SystemClock()
        self._window_s = window_s
        self._seen = 0
        self._grew_s = float("-inf")

    def grew(self, count: int) -> bool:
        """True if the counter has grown within the window; `count` is its value now."""
        now_s = self._clock.now()
        if count > self._seen:
            self._grew_s = now_s
        self._seen = max(self._seen, count)
        return now_s - self._grew_s < self._window_s


LATE_S = 1.0
"""Seconds without a move from which on a moving part is a warning."""
STALL_S = 6.0
"""Seconds without a move from which on a moving part counts as frozen."""

Value = bool | int | float | str | None
"""A reading; None if not known yet. Its name ends in its unit, if any: ``last_s``, ``free_mib``."""


class ComponentName(StrEnum):
    """The components that every agent lists, in this order."""

    AUDIO = "audio"
    STT = "stt"
    LLM = "llm"
    TTS = "tts"
    SIM = "sim"
    EXECUTOR = "executor"
    PRESENCE = "presence"
    INTERLOCK = "interlock"
    CONSOLE = "console"
    RECORDINGS = "recordings"
    RECORDER = "recorder"
    POLICY = "policy"
    DISK = "disk"
    CLOCK = "clock"
    PROCESS = "process"


class Level(IntEnum):
    """Levels of a status, named and numbered as in `diagnostic_msgs`; `STALE` was not looked at."""

    OK = 0
    WARN = 1
    ERROR = 2
    STALE = 3


@dataclass(frozen=True, slots=True)
class Finding:
    """A problem with its level."""

    level: Level
    text: str


@dataclass(frozen=True, slots=True)
class Status:
    """The status of one component."""

    name: str
    """The component's name."""
    level: Level
    """The worst level of its findings."""
    message: str
    """The findings in a few words."""
    values: Mapping[str, Value] = field(default_factory=dict)
    """Readings by name."""

    @classmethod
    def judged(
        cls, name: str, findings: Sequence[Finding] = (), *, well: str = "works", **values: Value
    ) -> Self:
        """A status with the findings, the worst first; its message is `well` without any."""
        worst_first = sorted(findings, key=lambda finding: -finding.level)
        level = worst_first[0].level if worst_first else Level.OK
        return cls(name, level, "; ".join(one.text for one in worst_first) or well, values)

    @property
    def texts(self) -> Mapping[str, str]:
        """The values as texts for people, without unknown ones."""
        return {name: _text(value) for name, value in self.values.items() if value is not None}


@dataclass(frozen=True, slots=True)
class HealthCheck:
    """A check of a component for health probes.

    It is separate from the status, because a probe must be answered whatever hangs: it runs only
    these checks and waits for nothing.
    """

    name: str
    """The check's name."""
    look: Callable[[], str]
    """Returns the problem; empty if there is none."""
    vital: bool = True
    """True if a failure means that the process must be restarted. False if it only means that the
    process is not ready, which a restart would not change."""

    def said(self) -> str:
        """The problem; a check that raises is a problem as well."""
        try:
            return self.look()
        except Exception as error:  # noqa: BLE001 - a component may raise anything
            return f"the check failed: {error!r}"


class Component(Protocol):
    """A part with a status. Any thread may ask for its checks and its status."""

    @property
    def name(self) -> str: ...

    @property
    def checks(self) -> Sequence[HealthCheck]:
        """The checks for health probes."""

    def status(self) -> Status:
        """The status now. Must be quick."""


@dataclass(frozen=True, slots=True)
class Off:
    """A component that is off; `level` is worse than OK if it was asked for."""

    name: str
    why: str
    checks: tuple[HealthCheck, ...] = ()
    level: Level = Level.OK

    def status(self) -> Status:
        """The status, with the reason why it is off."""
        return Status(self.name, self.level, f"off: {self.why}")


class Components:
    """Components by name, added as parts start and listed in that order."""

    def __init__(self, *components: Component) -> None:
        self._by_name = {one.name: one for one in components}
        self._broke: Counter[str] = Counter()

    @property
    def failures(self) -> int:
        """Number of times that a component could not tell its status."""
        return self._broke.total()

    def add(self, *components: Component) -> None:
        """Add components, each in place of one with the same name."""
        self._by_name = {**self._by_name, **{one.name: one for one in components}}

    @property
    def checks(self) -> Iterable[HealthCheck]:
        """The checks of all components."""
        return (check for one in self._by_name.values() for check in one.checks)

    def statuses(self, names: Iterable[str] | None = None) -> list[Status]:
        """The statuses of all components, or of the named ones.

        A component that raises gets an error with the reason; that is counted and logged.
        """
        asked = self._by_name if names is None else [one for one in self._by_name if one in names]
        return [self._ask(name) for name in asked]

    def _ask(self, name: str) -> Status:
        try:
            return self._by_name[name].status()
        except Exception as error:  # noqa: BLE001 - a component that raises has an error too
            self._broke[name] += 1
            if worth_a_line(self._broke[name]):
                log.warning("component_unreadable", component=name, error=repr(error))
            return Status(name, Level.ERROR, f"cannot be looked at: {error!r}")


def moves(stalled_s: Callable[[], float]) -> Callable[[], str]:
    """A check of a part that tells for how long it has stalled, in seconds."""

    def look() -> str:
        seconds = stalled_s()
        return f"has {_still(seconds)}" if seconds > STALL_S else ""

    return look


def lives(alive: Callable[[], bool]) -> Callable[[], str]:
    """A check of a part that tells whether its threads are alive."""
    return lambda: "" if alive() else "its thread has ended"


def stall(seconds: float, what: str) -> list[Finding]:
    """The findings about a part that has not moved for `seconds`: none, late or frozen."""
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


class Gauges:
    """The last value of each reading; None before the first. Any thread may read."""

    def __init__(self, bus: Bus) -> None:
        self.level: float | None = None
        """Loudness of the microphone, root mean square, 0 to 1."""
        self.synthesis_s: float | None = None
        """Seconds of speech synthesis for the last spoken answer."""
        self.first_audio_s: float | None = None
        """Seconds from the input to the first audible sample of that answer."""
        self.tokens_per_s: float | None = None
        """Tokens per second of the last answer by a model; reading the prompt counts as well."""
        self.model_failures = 0
        """Number of turns that failed after a language model had worked for them."""
        self._thought_s = 0.0
        self._tokens = 0
        self._forget = [
            bus.subscribe(AudioLevel, self._on_level),
            bus.subscribe(TokenGenerated, self._on_token),
            bus.subscribe(TurnMeasured, self._on_measured),
            bus.subscribe(TurnEnded, self._on_ended),
        ]

    def close(self) -> None:
        """Stop listening to the bus."""
        for forget in self._forget:
            forget()

    def _on_level(self, event: AudioLevel) -> None:
        self.level = event.level

    def _on_token(self, _: TokenGenerated) -> None:
        self._tokens += 1

    def _on_measured(self, event: TurnMeasured) -> None:
        self._thought_s = event.llm
        if event.tts:
            self.synthesis_s, self.first_audio_s = event.tts, event.ttfs

    def _on_ended(self, event: TurnEnded) -> None:
        thought_s, self._thought_s = self._thought_s, 0.0
        tokens, self._tokens = self._tokens, 0
        if thought_s and tokens:
            self.tokens_per_s = tokens / thought_s
        self.model_failures += bool(thought_s) and event.outcome is Outcome.FAILED
