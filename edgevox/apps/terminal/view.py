"""Views of the bus on a terminal: answers as they come, and the running skill's progress.

`View` makes lines; `UpdateBuffer` keeps events, from any thread, until the screen is drawn next.
"""

import threading
import time
from collections import Counter, deque
from collections.abc import Callable
from dataclasses import dataclass

from edgevox.core.agent_events import (
    AgentEvent,
    GoalCancelled,
    GoalChanged,
    GoalStatus,
    HandedOver,
    SoftwareStopChanged,
    UtteranceLeft,
)
from edgevox.core.bus import Bus
from edgevox.core.controls import Controls
from edgevox.core.events import (
    AudioLevel,
    ControlChanged,
    Decided,
    Outcome,
    Responded,
    SentenceReady,
    State,
    StateChanged,
    TokenGenerated,
    Transcribed,
    TurnEnded,
    TurnMeasured,
    WakeWordHeard,
)
from edgevox.core.files.text import clean, one_line, printable_in_colour
from edgevox.core.motion.software_stop import StopState

BAR_WIDTH = 20


class View:
    """Turns events into lines and one status line.

    `write` gets whole lines, free of terminal control codes. `status` is the answer or action in
    progress; `changed` is called whenever it may have changed.
    """

    def __init__(
        self, bus: Bus, write: Callable[[str], None], changed: Callable[[], None] = lambda: None
    ) -> None:
        self._write_line = write
        self._changed = changed
        self._lock = threading.Lock()
        self._typed: Counter[str] = Counter()
        self._partial = ""
        self._progress = ""
        self._forget = [
            bus.subscribe(Transcribed, self._on_transcribed),
            bus.subscribe(TokenGenerated, self._on_token),
            bus.subscribe(SentenceReady, self._on_sentence),
            bus.subscribe(Responded, self._on_response),
            bus.subscribe(AgentEvent, self._on_agent_event),
        ]

    def close(self) -> None:
        """Show nothing more."""
        for forget in self._forget:
            forget()

    @property
    def status(self) -> str:
        """A line: the answer as far as it is generated, or the running skill's progress."""
        with self._lock:
            return one_line(self._partial.strip() or self._progress)

    def _write(self, line: str) -> None:
        self._write_line(one_line(line))

    def expect(self, text: str) -> None:
        """Do not show this text again: it was typed here and stands on the screen already."""
        with self._lock:
            self._typed[clean(text)] += 1

    def _on_transcribed(self, event: Transcribed) -> None:
        with self._lock:
            if self._typed[event.text]:
                self._typed[event.text] -= 1
                return
        self._write(f"> {event.text}")

    def _on_token(self, event: TokenGenerated) -> None:
        with self._lock:
            self._partial += event.text
        self._changed()

    def _on_sentence(self, event: SentenceReady) -> None:
        with self._lock:
            self._partial = ""
        self._write(f"  {event.text}")
        self._changed()

    def _on_response(self, event: Responded) -> None:
        with self._lock:
            self._partial = ""
        if event.cut:
            self._write("  [interrupted]")
        if event.detail:
            self._write(f"  {event.detail}")
        self._changed()

    def _on_agent_event(self, event: AgentEvent) -> None:
        match event:
            case HandedOver(giver=giver, taker=taker):
                self._write(f"  [{giver} hands over to {taker}]")
            case SoftwareStopChanged(engaged=engaged, by=by):
                self._write(f"  [{'stopped' if engaged else 'resumed'} by {by}]")
            case UtteranceLeft(robot=robot):
                self._write(f"  [not me: {robot}]")
            case GoalChanged() | GoalCancelled():
                with self._lock:
                    self._progress = _progress(event)
        self._changed()


def _progress(goal: GoalChanged | GoalCancelled) -> str:
    if isinstance(goal, GoalCancelled) or goal.status is not GoalStatus.RUNNING:
        return ""
    call = " ".join([goal.skill, *(f"{k}={v}" for k, v in goal.arguments.items())])
    done = (goal.feedback or {}).get("progress")
    if done is None:
        return call
    filled = round(done * BAR_WIDTH)
    return f"{call}  {'█' * filled}{'░' * (BAR_WIDTH - filled)} {done:4.0%}"


def stop_line(stop: StopState) -> str:
    """The line about a software stop in force; empty while there is none."""
    if not stop.engaged:
        return ""
    at = time.strftime("%H:%M:%S", time.localtime(stop.since))
    return f"STOPPED by {one_line(stop.by)} {at}. Nothing moves. /resume lifts it."


ASIDE = "  · "
"""Begins a line about a turn: how it was understood, and its outcome."""


def turn_line(decided: Decided | None, outcome: Outcome) -> str:
    """How a turn was understood, how sure that is, and its outcome; empty for a plain answer."""
    ended = str(outcome).replace("_", " ")
    if decided is None:
        return "" if outcome is Outcome.ANSWERED else f"{ASIDE}{ended}"
    calls = ", ".join(
        f"{skill}({', '.join(f'{name}={value}' for name, value in arguments.items())})"
        for skill, arguments in decided.calls
    )
    by = f"{decided.stage}, {decided.confidence:.0%} sure"
    return f"{ASIDE}{ended}: {calls or 'no skill'} by {by}"


TURNS = 5
"""The number of latest turns that are remembered."""
MAX_LINES = 500
"""Lines that wait to be drawn; older ones are dropped."""


@dataclass(frozen=True, slots=True)
class ScreenUpdate:
    """The news and the current state."""

    lines: tuple[str, ...]
    """Of the conversation."""
    log_lines: tuple[str, ...]
    """Written by the program and its libraries."""
    status: str
    state: State
    level: float
    """The microphone's, 0 to 1."""
    language: str
    voice: str
    muted: bool
    turns: tuple[TurnMeasured, ...]


class UpdateBuffer:
    """Subscribes to the bus. `changed` is called once for all that comes before the next `take`."""

    def __init__(self, bus: Bus, controls: Controls) -> None:
        self._controls = controls
        self._lock = threading.Lock()
        self._lines: deque[str] = deque(maxlen=MAX_LINES)
        self._log_lines: deque[str] = deque(maxlen=MAX_LINES)
        self._state = State.LISTENING
        self._level = 0.0
        self._turns: deque[TurnMeasured] = deque(maxlen=TURNS)
        self._told = False
        self._decided: Decided | None = None
        self.changed: Callable[[], object] = lambda: None
        self._view = View(bus, self.write, self._tell)
        self._forget = [
            bus.subscribe(StateChanged, self._on_state),
            bus.subscribe(AudioLevel, self._on_level),
            bus.subscribe(TurnMeasured, self._on_turn),
            bus.subscribe(Decided, self._on_decided),
            bus.subscribe(TurnEnded, self._on_ended),
            bus.subscribe(WakeWordHeard, lambda event: self.write(f"  [{event.phrase}]")),
            bus.subscribe(ControlChanged, lambda _: self._tell()),
        ]

    def close(self) -> None:
        """Collect nothing more."""
        self._view.close()
        for forget in self._forget:
            forget()

    def expect(self, text: str) -> None:
        """Do not show this text again: it was typed here."""
        self._view.expect(text)

    def write(self, line: str) -> None:
        """Add a line to the transcript."""
        with self._lock:
            self._lines.append(one_line(line))
        self._tell()

    def log(self, line: str) -> None:
        """Add a line to the log, which may bring its own colours."""
        with self._lock:
            self._log_lines.append(printable_in_colour(line))
        self._tell()

    def take(self) -> ScreenUpdate:
        """Return the news since the last call."""
        with self._lock:
            self._told = False
            lines = tuple(self._lines)
            log_lines = tuple(self._log_lines)
            self._lines.clear()
            self._log_lines.clear()
            state, level, turns = self._state, self._level, tuple(self._turns)
        controls = self._controls
        return ScreenUpdate(
            lines,
            log_lines,
            self._view.status,
            state,
            level,
            controls.language,
            controls.voice,
            controls.muted,
            turns,
        )

    def _tell(self) -> None:
        with self._lock:
            told, self._told = self._told, True
        if not told:
            self.changed()

    def _on_state(self, event: StateChanged) -> None:
        with self._lock:
            self._state = event.state
        self._tell()

    def _on_level(self, event: AudioLevel) -> None:
        with self._lock:
            self._level = event.level
        self._tell()

    def _on_turn(self, event: TurnMeasured) -> None:
        with self._lock:
            self._turns.append(event)
        self._tell()

    def _on_decided(self, event: Decided) -> None:
        self._decided = event

    def _on_ended(self, event: TurnEnded) -> None:
        decided, self._decided = self._decided, None
        if event.outcome is None:
            return
        if decided and decided.turn != event.turn:
            decided = None
        if line := turn_line(decided, event.outcome):
            self.write(line)
