"""The full-screen terminal's widgets: lines that wrap anew, the input line, help, and keys."""

from collections import deque
from collections.abc import Callable, Iterable, Sequence
from typing import ClassVar

from rich.console import RenderableType
from rich.padding import Padding
from rich.text import Text
from textual import on
from textual.app import ComposeResult
from textual.binding import Binding, BindingType
from textual.containers import VerticalScroll
from textual.content import Content
from textual.events import Resize
from textual.screen import ModalScreen
from textual.suggester import Suggester
from textual.widgets import Footer, Input, RichLog, Static

MOST_LINES = 2000
"""Lines of the conversation, or of the log, that are kept."""
MOST_TYPED = 200
"""Typed lines that the arrow keys bring back."""
SHORTEST = 2
"""Letters of a name after which it is completed."""


class Lines(RichLog):
    """Lines that wrap anew when their width changes; the end stays in sight."""

    def __init__(self, name: str) -> None:
        super().__init__(id=name, wrap=True, markup=False, max_lines=5000, min_width=1)
        self._kept: deque[Text] = deque(maxlen=MOST_LINES)
        self._width = 0

    def on_mount(self) -> None:
        """Keep the end in sight, until somebody scrolls away from it."""
        self.anchor()

    def add(self, line: Text) -> None:
        """Show one more line."""
        self._kept.append(line)
        if self._width:
            self.write(_hanging(line), width=self._width)

    @on(Resize)
    def _wrap(self) -> None:
        """Wrap all lines anew."""
        width, self._width = self._width, self.scrollable_content_region.width
        if width == self._width:
            return
        self.clear()
        for line in self._kept:
            self.write(_hanging(line), width=self._width)


def _hanging(line: Text) -> RenderableType:
    """A line whose further rows are indented as the first is."""
    indent = len(line.plain) - len(line.plain.lstrip(" "))
    return Padding(line[indent:], (0, 0, 0, indent)) if indent else line


class LineSuggester(Suggester):
    """Completes a slash command, a line that was typed before, or the name that is begun."""

    def __init__(
        self,
        commands: Sequence[str],
        typed: Iterable[str],
        names: Callable[[], Iterable[str]],
    ) -> None:
        super().__init__(use_cache=False, case_sensitive=True)
        self._commands, self._typed, self._names = commands, typed, names

    async def get_suggestion(self, value: str) -> str | None:
        """The whole line that is suggested; None for none."""
        if value.startswith("/"):
            return _first_longer(value, (f"/{name}" for name in self._commands))
        before, gap, begun = value.rpartition(" ")
        if whole := _first_longer(value, self._typed):
            return whole
        if len(begun) < SHORTEST:
            return None
        name = _first_longer(begun, self._names())
        return f"{before}{gap}{name}" if name else None


def _first_longer(begun: str, whole: Iterable[str]) -> str | None:
    """The first that begins so, with the letters that are there kept as they are."""
    for one in whole:
        if len(one) > len(begun) and one.casefold().startswith(begun.casefold()):
            return begun + one[len(begun) :]
    return None


class CommandLine(Input):
    """The input line: Up and Down bring back what was typed, Tab takes what is suggested."""

    BINDINGS: ClassVar[list[BindingType]] = [
        Binding("up", "earlier", "Earlier line", show=False),
        Binding("down", "later", "Later line", show=False),
        Binding("tab", "complete", "Complete", show=False),
    ]

    def __init__(self, commands: Sequence[str], names: Callable[[], Iterable[str]]) -> None:
        self._typed: deque[str] = deque(maxlen=MOST_TYPED)  # the newest first
        super().__init__(
            placeholder="Type a message, or /help",
            id="line",
            suggester=LineSuggester(commands, self._typed, names),
            compact=False,
        )
        self._back = -1
        self._draft = ""

    def take(self) -> str:
        """The line that was typed; empties it and keeps it for the arrow keys."""
        line = self.value.strip()
        self.clear()
        self._back, self._draft = -1, ""
        if line and (not self._typed or self._typed[0] != line):
            self._typed.appendleft(line)
        return line

    def action_earlier(self) -> None:
        """Bring back an earlier line."""
        if self._back < 0:
            self._draft = self.value
        self._show(min(self._back + 1, len(self._typed) - 1))

    def action_later(self) -> None:
        """Go towards what is typed now."""
        self._show(max(self._back - 1, -1))

    def action_complete(self) -> None:
        """Take the suggestion; without one, go to the next part of the screen."""
        before = self.value
        self.action_end()
        self.action_cursor_right()
        if self.value == before:
            self.screen.focus_next()

    def _show(self, back: int) -> None:
        self._back = back
        self.value = self._draft if back < 0 else self._typed[back]
        self.action_end()


class Keys(Footer):
    """The keys at the foot; on a narrow screen only the ones that `first` names."""

    def __init__(self, first: Sequence[str], narrow_below: int) -> None:
        super().__init__(compact=True, show_command_palette=False)
        self._first, self._narrow_below = first, narrow_below

    def compose(self) -> ComposeResult:
        """The keys that have room."""
        narrow = self.app.size.width < self._narrow_below
        for one in super().compose():
            if not narrow or getattr(one, "action", "") in self._first:
                yield one

    @on(Resize)
    def _fit(self) -> None:
        """Show as many as fit."""
        self.refresh(recompose=True)


class Sheet(ModalScreen[None]):
    """A text over the conversation, until a key closes it. Stop works meanwhile."""

    CSS = """
    Sheet { align: center middle; }
    Sheet > VerticalScroll {
        width: auto; max-width: 100%; height: auto; max-height: 100%;
        padding: 1 2; background: $surface; border: round $primary;
    }
    Sheet Static { width: auto; max-width: 100%; }
    Sheet.-narrow > VerticalScroll, Sheet.-short > VerticalScroll { padding: 0; }
    """
    BINDINGS: ClassVar[list[BindingType]] = [
        Binding("ctrl+c", "app.interrupt", "Stop", priority=True),
        Binding("ctrl+q", "app.quit", "Exit", priority=True),
        Binding("escape,f1,enter,q,space", "dismiss", "Close", priority=True),
    ]

    def __init__(self, content: Content | str) -> None:
        super().__init__()
        self._content = content

    def compose(self) -> ComposeResult:
        """The text, which scrolls if it is too long."""
        with VerticalScroll():
            yield Static(self._content, id="sheet", markup=False)

    def on_mount(self) -> None:
        """Let the arrow keys scroll it."""
        self.query_one(VerticalScroll).focus()
