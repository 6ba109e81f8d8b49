"""Lines from a pipe or a file, one after another, each done before the next; a stop at once."""

from collections.abc import Callable

from edgevox.apps.terminal.lines import InputLines
from edgevox.apps.terminal.slash_commands import Leave, SlashContext, is_stop, run_command
from edgevox.apps.terminal.view import View
from edgevox.core.bus import Bus
from edgevox.core.commands import TextInput
from edgevox.core.ways import Way


def run_script(fd: int, bus: Bus, context: SlashContext, write: Callable[[str], None]) -> int:
    """Submit every line and wait until it is answered and done. How many lines there were.

    A line that stops does so when it is read, and the lines that wait before it are not done.
    """
    view = View(bus, write)

    def begin(line: str) -> None:
        if not line.startswith("/"):
            context.conversation.submit(TextInput(line, Way.TYPED))

    def run_slash(line: str) -> None:
        if line.startswith("/"):
            answer = run_command(line, context)
            write(f"> {line}\n{answer}")

    def stop(line: str, dropped: int) -> None:
        begin(line)
        run_slash(line)
        if dropped:
            write(f"  [lines before it that are not done: {dropped}]")

    lines = InputLines(fd, is_stop=lambda line: is_stop(line, context), on_stop=stop)
    lines.start()
    try:
        while (line := lines.take(begin)) is not None:
            run_slash(line)
            context.conversation.wait_idle()
        context.conversation.wait_idle()  # for the answer to a stop that was the last line
    except Leave:
        pass
    finally:
        lines.close()
        view.close()
    return lines.count
