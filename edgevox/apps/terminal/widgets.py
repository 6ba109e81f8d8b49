"""The full-screen terminal's widgets: lines that wrap again, the input line, help, and keys.

Beside the conversation stand robot, state and latencies, as text in colours of the theme
(`$text-success`). Every text has a contrast of at least 4.5 to its background, on dark and on light
(F4 changes); Textual's own light theme has less.
"""

import math
from collections import deque
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, ClassVar

from rich.padding import Padding
from rich.terminal_theme import TerminalTheme
from rich.text import Text
from textual import on
from textual.app import ComposeResult
from textual.binding import Binding, BindingType
from textual.containers import VerticalScroll
from textual.content import Content
from textual.events import Resize
from textual.screen import ModalScreen
from textual.suggester import Suggester
from textual.theme import BUILTIN_THEMES
from textual.widgets import Footer, Input, RichLog, Static

from edgevox.core.events import State, TurnMeasured
from edgevox.core.files.text import MAX_CHARACTERS, one_line, printable
from edgevox.robots.capabilities import Body, HasMap, HasPlaces, HasPose, charge_of

MOST_LINES = 2000
"""Lines of the conversation, or of the log, that are kept."""
MOST_TYPED = 200
"""Typed lines that the arrow keys bring back."""
TRACEBACK = "Traceback (most recent call last):"
SHORTEST = 2
"""Letters of a name after which it is completed."""


class Lines(RichLog):
    """Lines that wrap again when their width changes; the end stays in sight.

    A `folded` traceback is its first line and its last, which names the error.
    """

    def __init__(self, name: str, *, folded: bool = False) -> None:
        super().__init__(id=name, wrap=True, markup=False, max_lines=5000, min_width=1)
        self._folded = folded
        self._hides_from = math.inf  # columns of indentation
        self._kept: deque[Text] = deque(maxlen=MOST_LINES)
        self._width = 0

    def on_mount(self) -> None:
        """Keep the end in sight, until somebody scrolls away from it."""
        self.anchor()

    def add(self, line: Text) -> None:
        """Show one more line."""
        self._kept.append(line)
        if self._width:
            self._draw(line)

    def fold(self) -> None:
        """Fold tracebacks, or show them whole."""
        self._folded = not self._folded
        self._draw_all()

    @on(Resize)
    def _wrap(self) -> None:
        """Wrap all lines again, at the width of now."""
        width, self._width = self._width, self.scrollable_content_region.width
        if width != self._width:
            self._draw_all()

    def _draw_all(self) -> None:
        self.clear()
        self._hides_from = math.inf
        for line in self._kept:
            self._draw(line)

    def _draw(self, line: Text) -> None:
        """Draw a line; its further rows are indented as the first is."""
        indent = len(line.plain) - len(line.plain.lstrip(" "))
        if indent >= self._hides_from:
            return
        folds = self._folded and line.plain[indent:] == TRACEBACK
        self._hides_from = indent + 1 if folds else math.inf
        shown = Text.assemble(line[indent:], " F5 unfolds it") if folds else line[indent:]
        self.write(Padding(shown, (0, 0, 0, indent)), width=self._width)


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
        """The line that was typed; empties it and keeps it for the arrow keys if it is not endless.

        The robot does not take a longer one either.
        """
        line = self.value.strip()
        self.clear()
        self._back, self._draft = -1, ""
        if 0 < len(line) <= MAX_CHARACTERS and [line] != list(self._typed)[:1]:
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


SHEET_FRAME = 8
"""Columns that a sheet's border, padding and scroll bar take."""


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
        Binding("escape,enter,q,space", "dismiss", "Close", priority=True),
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


WIDTH = 26
"""Columns of the panel's text."""
WIDE_WIDTH = 44
"""The same on a wide screen."""
MOST_UNREAD = 1000
"""Lines of the log that are kept while it is hidden."""
LOW_BATTERY = 0.2
_FLOOR_DB = -60.0
_STYLES = {
    State.LISTENING: "bold $text-success",
    State.TRANSCRIBING: "bold $text-warning",
    State.THINKING: "bold $text-accent",
    State.SPEAKING: "bold $text-primary",
    State.INTERRUPTED: "bold $text-error",
}


def state_text(state: State, *, muted: bool) -> Content:
    """The state in its colour, and whether the microphone is off."""
    text = Content.styled(f"● {state}", _STYLES[state])
    return text + Content.styled("  muted", "bold $text-error") if muted else text


def meter(level: float, *, width: int = WIDTH) -> Content:
    """A bar from -60 dB to full scale; `level` is a root mean square, 0 to 1."""
    decibel = 20.0 * math.log10(level) if level > 0.0 else _FLOOR_DB
    share = min(max(1.0 - decibel / _FLOOR_DB, 0.0), 1.0)
    filled = round(share * width)
    return Content.styled("▮" * filled, "$text-success") + Content.styled(
        "▯" * (width - filled), "$text-muted"
    )


def latencies(turns: Sequence[TurnMeasured]) -> Content:
    """The last turns, the newest first: seconds of each stage."""
    if not turns:
        return Content.styled("no turns yet", "$text-muted")
    lines = ["  stt  llm  tts ttfs total"]
    for turn in reversed(turns):
        stages = (turn.stt, turn.llm, turn.tts, turn.ttfs)
        told = (f"{one:5.{2 if one < 9.995 else 1}f}" for one in stages)
        lines.append(f"{''.join(told)}{turn.total:6.1f}")
    return Content("\n".join(lines))


def unread(count: int) -> Content:
    """Return the number of unseen lines of the log, and the key that shows them."""
    if not count:
        return Content("")
    told = f"{count} new" if count < MOST_UNREAD else "many new"
    return Content.styled(f"log: {told}, F3", "$text-warning")


def machine(models: Mapping[str, Any], hardware: Mapping[str, Any]) -> Content:
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
    return Content("\n".join(one_line(f"{name} {value}") for name, value in rows.items()))


def _join(*words: str | None) -> str:
    return " ".join(word for word in words if word) or "none"


@dataclass(frozen=True, slots=True)
class RobotNow:
    """What the terminal shows of the robot: where it is, its charge, a map."""

    name: str
    place: str = ""
    """The place or room, and the position in metres; empty if unknown."""
    battery: float | None = None
    """Charge left, 0 to 1; None for a robot without a battery."""
    map: str = ""

    @property
    def text(self) -> Content:
        """Name, place and battery, in a line each."""
        lines = [Content.styled(self.name, "bold")]
        if self.place:
            lines.append(Content(self.place))
        if self.battery is not None:
            style = "bold $text-error" if self.battery < LOW_BATTERY else ""
            lines.append(Content.styled(f"battery {self.battery:.0%}", style))
        return Content("\n").join(lines)

    @property
    def line(self) -> str:
        """The same in one line, what may be cut off last."""
        charge = "" if self.battery is None else f"{self.battery:.0%}"
        return "  ".join(one for one in (charge, self.place, self.name) if one)


def look_at(body: Body | None, name: str, map_columns: int) -> RobotNow:
    """Look at the robot now; `map_columns` is the width of its map, 0 for none.

    Raises `SkillFailed` while it does not know where it is.
    """
    if body is None:
        return RobotNow(name)
    return RobotNow(
        one_line(name),
        _place(body) if isinstance(body, HasPose) else "",
        charge_of(body),
        printable(body.draw_map(map_columns)) if map_columns and isinstance(body, HasMap) else "",
    )


def _place(body: HasPose) -> str:
    pose = body.pose()
    at = f"{pose.x_m:.1f}, {pose.y_m:.1f} m"
    place = body.place_at(pose.x_m, pose.y_m) if isinstance(body, HasPlaces) else None
    return one_line(f"{place.replace('_', ' ')} {at}" if place else at)


DARK, LIGHT = "textual-dark", "edgevox-light"
LIGHT_THEME = replace(
    BUILTIN_THEMES["textual-light"],
    name=LIGHT,
    background="#ffffff",
    surface="#f7f7f7",
    panel="#e3e6ea",
    variables={
        **BUILTIN_THEMES["textual-light"].variables,
        "text-primary": "#00508c",
        "text-success": "#0b6630",
        "text-warning": "#7a4a00",
        "text-error": "#a31212",
        "text-accent": "#6a2a8c",
        "text-muted": "#555555",
        "footer-key-foreground": "#00508c",
    },
)

LOG_ON_DARK = TerminalTheme(
    (30, 30, 30),
    (224, 224, 224),
    [
        (160, 160, 160),
        (255, 120, 130),
        (140, 210, 90),
        (240, 180, 80),
        (140, 175, 255),
        (220, 150, 255),
        (100, 210, 230),
        (210, 210, 210),
    ],
)
"""The eight colours of a terminal, in which the log comes."""
LOG_ON_LIGHT = TerminalTheme(
    (255, 255, 255),
    (30, 30, 30),
    [
        (0, 0, 0),
        (163, 18, 18),
        (11, 102, 48),
        (122, 74, 0),
        (0, 80, 140),
        (106, 42, 140),
        (0, 95, 105),
        (85, 85, 85),
    ],
)


def has_light_background(colours: str) -> bool:
    """Whether a terminal's `COLORFGBG` ("0;15") names a light background."""
    last = colours.rpartition(";")[2]
    return last.isdecimal() and int(last) not in (*range(7), 8)
