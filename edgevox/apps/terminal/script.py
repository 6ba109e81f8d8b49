"""Lines from a pipe or a file, one after another, each done before the next; a stop at once."""

from collections.abc import Callable

from edgevox.agent.skills import STOP
from edgevox.apps.terminal.lines import InputLines
from edgevox.apps.terminal.slash_commands import Leave, SlashContext, is_stop, run_command
from edgevox.apps.terminal.view import View
from edgevox.core.agent_events import GoalChanged
from edgevox.core.bus import Bus
from edgevox.core.commands import TextInput
from edgevox.core.interlock import Interlock
from edgevox.core.ways import Way


def run_script(
    fd: int, bus: Bus, context: SlashContext, write: Callable[[str], None], interlock: Interlock
) -> int:
    """Submit every line and wait until it is answered and done. How many lines there were.

    A line that stops does so when it is read, and the lines that wait before it are not done; nor
    are those that wait when somebody else stops the robot.
    """
    view = View(bus, write)

    def begin(line: str, mark: int) -> None:
        if line.startswith("/"):
            return
        if interlock.outdated(mark):
            write(f"  [not done, as a stop came first: {line}]")
        context.conversation.submit(TextInput(line, Way.TYPED), mark)

    def run_slash(line: str) -> None:
        if line.startswith("/"):
            answer = run_command(line, context)
            write(f"> {line}\n{answer}")

    def stop(line: str, dropped: int) -> None:
        begin(line, interlock.mark)
        run_slash(line)
        if dropped:
            write(f"  [lines before it that are not done: {dropped}]")

    def keep(event: GoalChanged) -> None:
        """What was written behind a line that calls the skill `stop` in words comes after it."""
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
