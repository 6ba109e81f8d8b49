"""The view of the bus on a terminal: answers as they come, and the running skill's progress."""

import threading
from collections import Counter
from collections.abc import Callable

from edgevox.core.agent_events import AgentEvent, GoalCancelled, GoalChanged, GoalStatus, HandedOver
from edgevox.core.bus import Bus
from edgevox.core.events import (
    Responded,
    SentenceReady,
    TokenGenerated,
    Transcribed,
)
from edgevox.core.files.text import clean, one_line

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
