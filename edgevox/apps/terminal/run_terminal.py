"""The choice of the terminal's mode: a prompt, a script from a pipe, or none."""

import os
import stat
import sys
import time
from collections.abc import Callable

from edgevox.agent.skills import STOP
from edgevox.apps.agent.parts import AgentParts
from edgevox.apps.run_program import ShutdownSignals
from edgevox.apps.streams import show
from edgevox.apps.terminal.lines import InputLines, typed_ahead
from edgevox.apps.terminal.slash_commands import Leave, SlashContext, is_stop, run_command
from edgevox.apps.terminal.view import View
from edgevox.core.agent_events import GoalChanged
from edgevox.core.bus import Bus
from edgevox.core.commands import TextInput, Way
from edgevox.core.motion.interlock import Interlock
from edgevox.voice.sources.open_source import WavFiles


def run_script(
    fd: int, bus: Bus, context: SlashContext, write: Callable[[str], None], interlock: Interlock
) -> int:
    """Submit every line and wait until it is answered and done. Return the number of lines.

    A stop line acts when it is read, and the lines that wait before it are dropped; so are lines
    that wait when another source stops the robot.
    """
    view = View(bus, write)

    def begin(line: str, mark: int) -> None:
        if line.startswith("/"):
            return
        if interlock.outdated(mark):
            write(f"  [not done, the robot was stopped: {line}]")
        context.conversation.submit(TextInput(line, Way.TYPED), mark)

    def run_slash(line: str) -> None:
        if line.startswith("/"):
            answer = run_command(line, context)
            write(f"> {line}\n{answer}")

    def stop(line: str, dropped: int) -> None:
        begin(line, interlock.mark)
        run_slash(line)
        if dropped:
            write(f"  [cancelled lines before this stop: {dropped}]")

    def keep(event: GoalChanged) -> None:
        """Keep the lines behind one that calls the skill `stop` in words: they come after it."""
        if event.skill == STOP and event.turn:
            lines.keep()

    lines = InputLines(
        fd, is_stop=lambda line: is_stop(line, context), on_stop=stop, interlock=interlock
    )
    forget = bus.subscribe(GoalChanged, keep)
    lines.start()
    try:
        while (line := lines.take(begin)) is not None:
            run_slash(line)
            context.conversation.wait_idle()
        context.conversation.wait_idle()  # for the answer to a stop that was the last line
    except Leave:
        pass
    finally:
        forget()
        lines.close()
        view.close()
    return lines.count


_LOOK_S = 1.0
"""The longest sleep of the main thread: a signal that comes just before the sleep, after
Python's check, is seen at the wake-up."""


def run_terminal(parts: AgentParts, shutdown: ShutdownSignals) -> None:
    """Serve whoever is at stdin, on the main thread, until they leave.

    A terminal gets the whole screen, or a prompt if `simple_ui` is set. A pipe or a file is a
    script: it ends the program when its last line is done. An empty stdin, or none, is nobody: the
    program runs until its WAV files are over, if it hears those, or a signal tells it to end.
    """
    context = SlashContext(
        parts.conversation,
        parts.body,
        skills=parts.skills,
        software_stop=parts.software_stop,
        settings=parts.settings,
    )
    if _is_terminal():
        typed = typed_ahead(sys.stdin.fileno(), lambda line: is_stop(line.strip(), context))
        if parts.settings.simple_ui:
            from edgevox.apps.terminal.prompt import Prompt

            Prompt(parts.bus, context).run(shutdown, typed)
            return
        from edgevox.apps.terminal.screen import run_tui

        run_tui(parts, shutdown, typed)
    elif not (
        _has_input() and run_script(sys.stdin.fileno(), parts.bus, context, _write, parts.interlock)
    ):
        _run_alone(parts)


def _run_alone(parts: AgentParts) -> None:
    """Run without a terminal; show the conversation, unless the log is for programs.

    Returns at the end of a sound file; with any other source it runs until a signal.
    """
    told = parts.settings.log_format != "json"
    view = View(parts.bus, _write if told else lambda _line: None)
    try:
        if parts.listener and parts.voice and isinstance(parts.voice.source, WavFiles):
            parts.listener.wait_over()
            parts.conversation.wait_idle()
        else:
            while True:
                time.sleep(_LOOK_S)
    finally:
        view.close()


def _is_terminal() -> bool:
    return sys.stdin is not None and sys.stdin.isatty() and sys.stdout.isatty()


def _has_input() -> bool:
    if sys.stdin is None or sys.stdin.closed:
        return False
    try:
        mode = os.fstat(sys.stdin.fileno()).st_mode
    except OSError:
        return False
    return stat.S_ISFIFO(mode) or stat.S_ISREG(mode) or stat.S_ISSOCK(mode)


def _write(line: str) -> None:
    show(line)
