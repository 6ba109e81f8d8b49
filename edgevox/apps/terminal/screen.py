"""The full-screen terminal, in Textual, run on the main thread.

It shows the transcript, the current speech or action, an input line, and a side panel of a fixed
width.
"""

import asyncio
import math
import os
import sys
import threading
from collections import deque
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any, ClassVar

from rich.text import Text
from textual.app import App, ComposeResult
from textual.binding import Binding, BindingType
from textual.containers import Horizontal, Vertical
from textual.message import Message
from textual.widgets import Footer, Input, RichLog, Static
from textual.worker import Worker

from edgevox.apps.agent.parts import AgentParts
from edgevox.apps.run_program import ShutdownSignals
from edgevox.apps.terminal.prompt import DoubleInterrupt
from edgevox.apps.terminal.slash_commands import Leave, SlashContext, is_stop, run_command
from edgevox.apps.terminal.view import ScreenUpdate, UpdateBuffer
from edgevox.core.clock import Clock, SystemClock
from edgevox.core.commands import Command, Interrupt, SetMuted, TextInput, Way
from edgevox.core.errors import InvalidValue
from edgevox.core.events import Cause, State, TurnMeasured
from edgevox.core.files.text import one_line

WIDTH = 26
MOST_UNREAD = 1000
_FLOOR_DB = -60.0
_COLORS = {
    State.LISTENING: "green",
    State.TRANSCRIBING: "yellow",
    State.THINKING: "magenta",
    State.SPEAKING: "cyan",
    State.INTERRUPTED: "red",
}


def state_text(state: State, *, muted: bool) -> Text:
    """The state in its colour, and whether the microphone is off."""
    text = Text(f"● {state}", style=f"bold {_COLORS[state]}")
    return text.append("  muted", style="bold red") if muted else text


def meter(level: float, *, width: int = WIDTH) -> Text:
    """A bar from -60 dB to full scale; `level` is a root mean square, 0 to 1."""
    decibel = 20.0 * math.log10(level) if level > 0.0 else _FLOOR_DB
    share = min(max(1.0 - decibel / _FLOOR_DB, 0.0), 1.0)
    filled = round(share * width)
    return Text("▮" * filled, style="green").append("▯" * (width - filled), style="dim")


def latencies(turns: Sequence[TurnMeasured]) -> Text:
    """The last turns, the newest first: seconds of each stage."""
    if not turns:
        return Text("no turns yet", style="dim")
    lines = ["  stt  llm  tts ttfs total"]
    lines += [
        f"{t.stt:5.2f}{t.llm:5.2f}{t.tts:5.2f}{t.ttfs:5.2f}{t.total:6.1f}" for t in reversed(turns)
    ]
    return Text("\n".join(lines))


def unread(count: int) -> Text:
    """Return the number of unseen lines of the log, and the key that shows them."""
    if not count:
        return Text("")
    return Text(f"log: {count} new, F3" if count < MOST_UNREAD else "log: many new, F3", "yellow")


def machine(models: Mapping[str, Any], hardware: Mapping[str, Any]) -> Text:
    """Return the loaded models and the hardware, from `model_info` and `hardware_info`."""
    stt, llm, tts = models["stt"], models["llm"], models["tts"]
    gpu = hardware.get("gpu_name") or "none"
    rows = {
        "stt": _join(stt.get("backend"), stt.get("model_size")),
        "llm": Path(llm["model_path"]).stem if llm.get("model_path") else "none",
        "tts": _join(tts.get("backend"), tts.get("voice")),
        "gpu": gpu,
        "ram": f"{hardware['ram_gb']:.0f} GB" if hardware.get("ram_gb") else "?",
    }
    return Text("\n".join(one_line(f"{name} {value}")[:WIDTH] for name, value in rows.items()))


def _join(*words: str | None) -> str:
    return " ".join(word for word in words if word) or "none"


Queries = Mapping[str, Callable[[], Mapping[str, Any]]]


class Changed(Message):
    """A message that there is news."""


class Face(App[None]):
    """Shows an `UpdateBuffer`, and takes lines and keys."""

    TITLE = "EdgeVox"
    ENABLE_COMMAND_PALETTE = False
    CSS = f"""
    #side {{ width: {WIDTH + 4}; border-left: solid $panel; padding: 0 1; }}
    #side Static {{ margin-bottom: 1; }}
    #transcript {{ height: 1fr; scrollbar-size-vertical: 1; }}
    #log {{ height: 2fr; display: none; border-top: solid $panel; }}
    #status {{ height: auto; max-height: 5; color: $text-muted; }}
    #line {{ border: tall $panel; }}
    """
    BINDINGS: ClassVar[list[BindingType]] = [
        Binding("ctrl+c", "interrupt", "Stop (twice: exit)", priority=True),
        Binding("ctrl+t", "mute", "Mute", priority=True),
        Binding("f1", "help", "Help", priority=True),
        Binding("f2", "panel", "Panel", priority=True),
        Binding("f3", "log", "Log", priority=True),
        Binding("ctrl+q", "quit", "Exit", priority=True),
    ]

    def __init__(
        self,
        updates: UpdateBuffer,
        context: SlashContext,
        queries: Queries,
        submit: Callable[[Command], None],
        clock: Clock,
        *,
        typed: Sequence[str] = (),
    ) -> None:
        super().__init__()
        self._typed = typed
        self._updates, self._slash_context, self._queries = updates, context, queries
        self._submit = submit
        self._ctrl_c = DoubleInterrupt(clock)
        self._asked_after: tuple[object, ...] = ()
        self._muted = False
        self._unread: deque[str] = deque(maxlen=MOST_UNREAD)
        self._running_loop: asyncio.AbstractEventLoop | None = None

    def compose(self) -> ComposeResult:
        """The widgets."""
        with Horizontal():
            with Vertical():
                yield RichLog(id="transcript", wrap=True, markup=False, max_lines=5000, min_width=1)
                yield Static(id="status", markup=False)
                yield RichLog(id="log", wrap=True, markup=False, max_lines=1000, min_width=1)
            with Vertical(id="side"):
                yield Static(id="state")
                yield Static(meter(0.0), id="level")
                yield Static(id="voice", markup=False)
                yield Static(latencies(()), id="turns")
                yield Static(id="machine")
                yield Static(id="unread")
        yield Input(placeholder="Type a message, or /help", id="line")
        yield Footer()

    def on_mount(self) -> None:
        """Listen to the bus from now on."""
        self._running_loop = asyncio.get_running_loop()
        self.query_one("#line").focus()
        self._updates.changed = lambda: self.post_message(Changed())
        self.on_changed()
        for line in self._typed:
            self._take(line.strip())

    def leave_soon(self) -> bool:
        """End, from a signal handler; False if it does not run yet."""
        if self._running_loop is None:
            return False
        self._running_loop.call_soon_threadsafe(self.exit)
        return True

    def on_changed(self) -> None:
        """Draw what is new."""
        news = self._updates.take()
        transcript = self.query_one("#transcript", RichLog)
        for line in news.lines:
            transcript.write(_styled(line))
        self._show_log(news.log_lines)
        self._static("status", news.status)
        self._static("state", state_text(news.state, muted=news.muted))
        self._static("level", meter(0.0 if news.muted else news.level))
        self._static("turns", latencies(news.turns))
        self._show_voice(news)

    def on_input_submitted(self, event: Input.Submitted) -> None:
        """A line was typed."""
        line = event.value.strip()
        event.input.clear()
        self._take(line)

    def _take(self, line: str) -> None:
        """Begin what a line says. A stop does not wait for a thread: slow commands may have all."""
        if line.startswith("/") and is_stop(line, self._slash_context):
            self._updates.write(run_command(line, self._slash_context))
        elif line.startswith("/"):
            self.run_worker(lambda: self._command(line), thread=True)
        elif line:
            self._updates.expect(line)
            self._updates.write(f"> {line}")
            self._submit(TextInput(line, Way.TYPED))

    def action_interrupt(self) -> None:
        """Stop talking and moving; the second time, leave."""
        if self._ctrl_c.pressed():
            self.exit()
            return
        self._submit(Interrupt("Ctrl-C", cause=Cause.TERMINAL))

    def action_mute(self) -> None:
        """Stop or start hearing."""
        self._submit(SetMuted(not self._muted))

    def action_help(self) -> None:
        """Show what can be typed."""
        self.run_worker(lambda: self._command("/help"), thread=True)

    def action_panel(self) -> None:
        """Show or hide the side panel."""
        side = self.query_one("#side")
        side.display = not side.display

    def action_log(self) -> None:
        """Show or hide the log; what is shown is read."""
        log = self.query_one("#log")
        log.display = not log.display
        self._show_log(())

    def _command(self, line: str) -> None:
        """A slash command, off the event loop: it may take long."""
        try:
            answer = run_command(line, self._slash_context)
        except Leave:
            self.call_from_thread(self.exit)
            return
        except InvalidValue as error:
            answer = str(error)
        for one in answer.splitlines():
            self._updates.write(one)

    def _show_log(self, lines: Sequence[str]) -> None:
        """Show lines of the log; while it is hidden, keep a limited number.

        A widget would keep all.
        """
        log = self.query_one("#log", RichLog)
        self._unread.extend(lines)
        while log.display and self._unread:
            log.write(Text.from_ansi(self._unread.popleft()))
        self._static("unread", unread(len(self._unread)))

    def _show_voice(self, news: ScreenUpdate) -> None:
        self._muted = news.muted
        self._static("voice", f"language {news.language}\nvoice {news.voice or 'best'}")
        # What is loaded may be loaded, or replaced, while it runs: a turn shows what it needed.
        now = (news.language, news.voice, news.turns)
        if self._asked_after != now:
            self._asked_after = now
            self._ask_machine()

    def _ask_machine(self) -> Worker[None]:
        def ask() -> None:
            answer = machine(self._queries["model_info"](), self._queries["hardware_info"]())
            self.call_from_thread(lambda: self._static("machine", answer))

        return self.run_worker(ask, thread=True, exclusive=True, group="machine")

    def _static(self, name: str, content: str | Text) -> None:
        self.query_one(f"#{name}", Static).update(content)


def _styled(line: str) -> Text:
    """Return the line; a question of the user is bold."""
    return Text(line, style="bold" if line.startswith(">") else "")


@contextmanager
def stderr_as_lines(write: Callable[[str], None]) -> Iterator[None]:
    """While entered, lines that are written to stderr go to `write`, on a thread of its own.

    Textual draws on ``sys.__stderr__``, which stays the terminal.
    """
    terminal, original = os.dup(2), sys.__stderr__
    reading, writing = os.pipe()
    os.dup2(writing, 2)
    os.close(writing)
    sys.__stderr__ = os.fdopen(os.dup(terminal), "w", encoding="utf-8")  # type: ignore[misc]

    def carry() -> None:
        with os.fdopen(reading, encoding="utf-8", errors="replace") as lines:
            for line in lines:
                write(line.rstrip())

    thread = threading.Thread(target=carry, name="edgevox-stderr")
    thread.start()
    try:
        yield
    finally:
        os.dup2(terminal, 2)  # the last way into the pipe is gone with this
        os.close(terminal)
        thread.join()
        sys.__stderr__.close()
        sys.__stderr__ = original  # type: ignore[misc]


COLUMNS = 46
"""The width of a map beside the panel on a screen of 80 columns."""


def run_tui(parts: AgentParts, shutdown: ShutdownSignals, typed: Sequence[str] = ()) -> None:
    """Serve the person at the terminal until they leave, or a signal says so.

    What was `typed` before it was drawn is done first.
    """
    updates = UpdateBuffer(parts.bus, parts.controls)
    for note in parts.notes:
        updates.write(note)
    context = SlashContext(parts.conversation, parts.body, columns=COLUMNS, skills=parts.skills)
    face = Face(
        updates, context, parts.queries, parts.command_router.submit, SystemClock(), typed=typed
    )
    shutdown.gently = face.leave_soon
    try:
        with stderr_as_lines(updates.log):
            face.run()
    finally:
        shutdown.gently = None
        updates.changed = lambda: None
        updates.close()
