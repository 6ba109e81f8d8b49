"""The full-screen terminal, in Textual, run on the main thread.

It shows the transcript, the current speech or action, an input line, and a side panel with the
robot. A software stop in force stands above everything.
"""

import asyncio
import os
import sys
import threading
from collections import deque
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from functools import partial
from typing import Any, ClassVar

from rich.text import Text
from textual import on
from textual.app import App, ComposeResult, SystemCommand
from textual.binding import Binding, BindingType
from textual.containers import Horizontal, Vertical, VerticalScroll
from textual.content import Content
from textual.events import Resize
from textual.message import Message
from textual.screen import Screen
from textual.widgets import Input, Static
from textual.worker import Worker

from edgevox.agent.phrases.load import phrasebook
from edgevox.apps.agent.parts import AgentParts
from edgevox.apps.run_program import ShutdownSignals
from edgevox.apps.terminal.hints import first_hint, help_text, key_rows
from edgevox.apps.terminal.slash_commands import (
    COMMANDS,
    Leave,
    SlashContext,
    command_rows,
    is_sheet,
    is_stop,
    run_command,
)
from edgevox.apps.terminal.view import ASIDE, ScreenUpdate, UpdateBuffer, stop_line
from edgevox.apps.terminal.widgets import (
    DARK,
    LIGHT,
    LIGHT_THEME,
    LOG_ON_DARK,
    LOG_ON_LIGHT,
    MOST_UNREAD,
    SHEET_FRAME,
    WIDE_WIDTH,
    WIDTH,
    CommandLine,
    Keys,
    Lines,
    RobotNow,
    Sheet,
    has_light_background,
    latencies,
    look_at,
    machine,
    meter,
    state_text,
    unread,
)
from edgevox.core.commands import Command, Interrupt, SetMuted, TextInput, Way
from edgevox.core.errors import EdgeVoxError
from edgevox.core.events import Cause

PANEL_FROM = 70
"""Columns from which the panel is shown, unless F2 says otherwise."""
LOOK_S = 0.5
"""Seconds between looks at the robot."""
DIM = "\x1b[2m"
"""What makes the time of a log line too pale to read on some screens."""
FIRST_KEYS = ("interrupt", "help", "quit")
"""Actions whose keys a narrow screen shows."""

Queries = Mapping[str, Callable[[], Mapping[str, Any]]]


class Changed(Message):
    """A message that there is news."""


class Seen(Message):
    """A message from a thread that looked at the robot, or asked what is loaded."""

    def __init__(self, robot: RobotNow | None = None, machine: Content | None = None) -> None:
        super().__init__()
        self.robot, self.machine = robot, machine


class Face(App[None]):
    """Shows an `UpdateBuffer`, and takes lines and keys."""

    TITLE = "EdgeVox"
    CSS = f"""
    #stop {{
        display: none; height: auto; padding: 0 1; text-style: bold;
        background: #b01818; color: #ffffff;
    }}
    #bar {{
        height: 1; padding: 0 1; background: $panel; color: $text;
        text-wrap: nowrap; text-overflow: ellipsis;
    }}
    #side {{
        width: {WIDTH + 4}; border-left: solid $panel; padding: 0 1;
        scrollbar-size-vertical: 1;
    }}
    .-wide #side {{ width: {WIDE_WIDTH + 4}; }}
    #side Static {{ margin-bottom: 1; }}
    .-short #side Static, .-low #side Static {{ margin-bottom: 0; }}
    #map {{ display: none; max-height: 24; }}
    .-tall #map {{ display: block; }}
    #transcript {{ height: 1fr; scrollbar-size-vertical: 1; }}
    #middle {{ height: 1fr; }}
    #log {{
        height: 1fr; display: none; border-top: solid $panel; scrollbar-size-vertical: 1;
    }}
    #status {{ height: auto; max-height: 5; padding: 0 1; color: $text-muted; }}
    #line {{ border: tall $panel; }}
    .-low #line {{ border: none; height: 1; }}
    Input > .input--placeholder, Input > .input--suggestion {{ color: $text-muted; }}
    FooterKey .footer-key--key {{ color: $text; text-style: bold; }}
    """
    BINDINGS: ClassVar[list[BindingType]] = [
        Binding("ctrl+c", "interrupt", "Stop", priority=True),
        Binding("f1", "help", "Help", priority=True),
        Binding("ctrl+t", "mute", "Mute", priority=True),
        Binding("f2", "panel", "Panel", priority=True),
        Binding("f3", "log", "Log", priority=True),
        Binding("f4", "light", "Light/dark", priority=True),
        Binding("ctrl+q", "quit", "Exit", priority=True),
        Binding("ctrl+p", "command_palette", "Find a command", show=False, priority=True),
        Binding("f5", "fold", "Show or fold tracebacks of the log", show=False, priority=True),
        Binding("pageup", "page(-1)", "Scroll the conversation up", show=False),
        Binding("pagedown", "page(1)", "Scroll the conversation down", show=False),
    ]

    def __init__(
        self,
        updates: UpdateBuffer,
        context: SlashContext,
        queries: Queries,
        submit: Callable[[Command], None],
        *,
        name: str = "edgevox",
        typed: Sequence[str] = (),
    ) -> None:
        super().__init__()
        self.HORIZONTAL_BREAKPOINTS = [(0, "-narrow"), (120, "-wide")]
        self.VERTICAL_BREAKPOINTS = [(0, "-low"), (18, "-short"), (30, "-middle"), (44, "-tall")]
        self.register_theme(LIGHT_THEME)
        self.ansi_theme_dark, self.ansi_theme_light = LOG_ON_DARK, LOG_ON_LIGHT
        self.theme = LIGHT if has_light_background(os.environ.get("COLORFGBG", "")) else DARK
        self._typed = typed
        self._updates, self._slash_context, self._queries = updates, context, queries
        self._submit = submit
        self._robot = RobotNow(name)
        self._looking = False
        self._asked_after: tuple[object, ...] = ()
        self._news: ScreenUpdate | None = None
        self._panel: bool | None = None
        self._told_exit = False
        self._unread: deque[str] = deque(maxlen=MOST_UNREAD)
        self._running_loop: asyncio.AbstractEventLoop | None = None

    def compose(self) -> ComposeResult:
        """The widgets."""
        yield Static(id="stop", markup=False)
        yield Static(id="bar", markup=False)
        with Horizontal(id="middle"):
            with Vertical():
                yield Lines("transcript")
                yield Static(id="status", markup=False)
            with VerticalScroll(id="side", can_focus=False):
                yield Static(id="robot")
                yield Static(id="map", markup=False)
                yield Static(id="state")
                yield Static(meter(0.0), id="level")
                yield Static(id="voice", markup=False)
                yield Static(latencies(()), id="turns")
                yield Static(id="unread")
                yield Static(id="machine")
        yield Lines("log", folded=True)
        yield CommandLine(tuple(COMMANDS), self._names)
        yield Keys(FIRST_KEYS, PANEL_FROM)

    def on_mount(self) -> None:
        """Listen to the bus from now on."""
        self._running_loop = asyncio.get_running_loop()
        self.query_one("#line").focus()
        self._updates.changed = lambda: self.post_message(Changed())
        self.on_changed()
        self.set_interval(LOOK_S, self._look)
        self._look()
        for line in self._typed:
            self._take(line.strip())

    def on_resize(self, event: Resize) -> None:
        """Give the panel its place, or none."""
        self._arrange(event.size.width)

    def leave_soon(self) -> bool:
        """End, from a signal handler; False if it does not run yet."""
        if self._running_loop is None:
            return False
        self._running_loop.call_soon_threadsafe(self.exit)
        return True

    def on_changed(self) -> None:
        """Draw what is new."""
        if not self._stands:
            return
        news = self._news = self._updates.take()
        transcript = self._base.query_one("#transcript", Lines)
        for line in news.lines:
            transcript.add(_styled(line))
        self._show_log(news.log_lines)
        self._show_stop()
        self._static("status", news.status)
        self._base.query_one("#status").display = bool(news.status)
        self._static("state", state_text(news.state, muted=news.muted))
        self._static("level", meter(0.0 if news.muted else news.level))
        self._static("turns", latencies(news.turns))
        self._show_voice(news)
        self._show_robot()

    @on(Input.Submitted)
    def _submitted(self) -> None:
        """A line was typed."""
        self._take(self._base.query_one("#line", CommandLine).take())

    def _take(self, line: str) -> None:
        """Begin what a line says. A stop does not wait for a thread: slow commands may have all."""
        self._told_exit = False
        if line.startswith("/") and is_stop(line, self._slash_context):
            self._updates.write(run_command(line, self._slash_context))
        elif line.startswith("/"):
            self.run_worker(lambda: self._command(line), thread=True)
        elif line:
            self._updates.expect(line)
            self._updates.write(f"> {line}")
            self._submit(TextInput(line, Way.TYPED))

    def action_interrupt(self) -> None:
        """Stop talking and moving, however often it is pressed."""
        self._submit(Interrupt("Ctrl-C", cause=Cause.TERMINAL))
        if not self._told_exit:
            self._told_exit = True
            self._updates.write("  [stopped; Ctrl-Q exits]")

    def action_mute(self) -> None:
        """Stop or start hearing."""
        self._submit(SetMuted(not (self._news and self._news.muted)))

    def action_help(self) -> None:
        """Show what can be typed, and the keys; or close what is shown."""
        if isinstance(self.screen, Sheet):
            self.screen.dismiss()
        else:
            self.show_sheet(help_text(self.BINDINGS, self.size.width - SHEET_FRAME))

    def get_system_commands(self, _: Screen[Any]) -> Iterable[SystemCommand]:
        """What the palette finds: all slash commands, and what the keys do."""
        for typed, about in command_rows():
            yield SystemCommand(typed, about, partial(self._take, typed.partition(" ")[0]))
        for action, key, about in key_rows(self.BINDINGS):
            yield SystemCommand(about, key, partial(self.run_action, action))

    def show_sheet(self, content: Content | str) -> None:
        """Show a text over the conversation."""
        self.push_screen(Sheet(content))

    def action_panel(self) -> None:
        """Show or hide the side panel."""
        self._panel = not self._base.query_one("#side").display
        self._arrange(self.size.width)

    def action_page(self, pages: int) -> None:
        """Scroll the conversation by a screen, wherever the cursor is."""
        transcript = self._base.query_one("#transcript", Lines)
        transcript.scroll_relative(y=pages * transcript.size.height, animate=False)

    def action_light(self) -> None:
        """Change between light and dark."""
        self.theme = DARK if self.theme == LIGHT else LIGHT

    def action_log(self) -> None:
        """Show or hide the log; what is shown is read."""
        log = self._base.query_one("#log")
        log.display = not log.display
        self._show_log(())

    def action_fold(self) -> None:
        """Fold the tracebacks of the log, or show them whole."""
        self._base.query_one("#log", Lines).fold()

    @property
    def _base(self) -> Any:
        """The screen below a sheet."""
        return self.screen_stack[0]

    def _arrange(self, width: int) -> None:
        shown = width >= PANEL_FROM if self._panel is None else self._panel
        self._base.query_one("#side").display = shown
        self._base.query_one("#bar").display = not shown

    def _command(self, line: str) -> None:
        """A slash command, off the event loop: it may take long."""
        if line.strip().lower() == "/help":
            self.call_from_thread(self.action_help)
            return
        try:
            answer = run_command(line, self._slash_context)
        except Leave:
            self.call_from_thread(self.exit)
            return
        if is_sheet(line) and "\n" in answer:
            picture = Content.styled(answer, "#ffffff on #000000")
            self.call_from_thread(self.show_sheet, picture)
            return
        for one in answer.splitlines():
            self._updates.write(one)

    def _show_log(self, lines: Sequence[str]) -> None:
        """Show lines of the log; while it is hidden, keep a limited number.

        A widget would keep all.
        """
        log = self._base.query_one("#log", Lines)
        self._unread.extend(lines)
        while log.display and self._unread:
            log.add(Text.from_ansi(self._unread.popleft().replace(DIM, "")))
        self._static("unread", unread(len(self._unread)))

    def _show_stop(self) -> None:
        told = stop_line(self._slash_context.software_stop.state)
        self._static("stop", told)
        self._base.query_one("#stop").display = bool(told)

    def _show_voice(self, news: ScreenUpdate) -> None:
        self._static("voice", f"language {news.language}\nvoice {news.voice or 'best'}")
        # What is loaded may be loaded, or replaced, while it runs: a turn shows what it needed.
        now = (news.language, news.voice, news.turns)
        if self._asked_after != now:
            self._asked_after = now
            self._ask_machine()

    def _ask_machine(self) -> Worker[None]:
        def ask() -> None:
            answer = machine(self._queries["model_info"](), self._queries["hardware_info"]())
            self.post_message(Seen(machine=answer))

        return self.run_worker(ask, thread=True, exclusive=True, group="machine")

    def _look(self) -> None:
        """Look at the robot, off the event loop: it may answer late."""
        if self._looking or not self._stands:
            return
        self._looking = True
        shown = self._base.query_one("#map")
        columns = shown.size.width if shown.display and shown.size.width else 0
        body, name = self._slash_context.body, self._robot.name

        def look() -> None:
            try:
                robot = look_at(body, name, columns)
            except EdgeVoxError:  # it does not know where it is
                robot = RobotNow(name)
            self.post_message(Seen(robot))

        self.run_worker(look, thread=True, group="robot")

    def on_seen(self, seen: Seen) -> None:
        """Draw what a thread has found."""
        if not self._stands:
            return
        if seen.machine:
            self._static("machine", seen.machine)
        if seen.robot:
            self._looking = False
            self._robot = seen.robot
            self._show_robot()

    def _show_robot(self) -> None:
        self._static("robot", self._robot.text)
        self._static("map", self._robot.map)
        if self._news:
            state = state_text(self._news.state, muted=self._news.muted)
            self._static("bar", state + Content(f"  {self._robot.line}"))

    def _names(self) -> Sequence[str]:
        """The places and things that the robot knows, as its language calls them."""
        phrases = phrasebook(self._news.language if self._news else "en")
        choices = (one for skill in self._slash_context.skills for one in skill.choices.values())
        return [str(phrases.word(word)) for one in choices for word in one.words]

    @property
    def _stands(self) -> bool:
        """Whether its widgets are there: they are taken down one by one while it ends."""
        return bool(self.screen_stack) and len(self._base.query("#stop, #map, #machine, #log")) == 4

    def _static(self, name: str, content: str | Content) -> None:
        self._base.query_one(f"#{name}", Static).update(content)


def _styled(line: str) -> Text:
    """Return the line; a question of the user is bold, what is said about a turn is cursive."""
    style = "bold" if line.startswith(">") else "italic" if line.startswith(ASIDE) else ""
    return Text(line, style=style)


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
    for note in (*parts.notes, *first_hint(parts)):
        updates.write(note)
    context = SlashContext(
        parts.conversation,
        parts.body,
        columns=COLUMNS,
        skills=parts.skills,
        software_stop=parts.software_stop,
        settings=parts.settings,
    )
    face = Face(
        updates,
        context,
        parts.queries,
        parts.command_router.submit,
        name=parts.name,
        typed=typed,
    )
    shutdown.gently = face.leave_soon
    try:
        with stderr_as_lines(updates.log):
            face.run()
    finally:
        shutdown.gently = None
        updates.changed = lambda: None
        updates.close()
