"""What the full-screen terminal shows beside the conversation, as text: robot, state, latencies.

Colours are names of the theme (`$text-success`), so that they are legible on dark and on light.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from textual.content import Content

from edgevox.core.events import State, TurnMeasured
from edgevox.core.files.text import one_line, printable
from edgevox.robots.capabilities import Body, HasBattery, HasMap, HasPlaces, HasPose

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
    lines += [
        f"{t.stt:5.2f}{t.llm:5.2f}{t.tts:5.2f}{t.ttfs:5.2f}{t.total:6.1f}" for t in reversed(turns)
    ]
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
        body.battery() if isinstance(body, HasBattery) else None,
        printable(body.draw_map(map_columns)) if map_columns and isinstance(body, HasMap) else "",
    )


def _place(body: HasPose) -> str:
    pose = body.pose()
    at = f"{pose.x_m:.1f}, {pose.y_m:.1f} m"
    place = body.place_at(pose.x_m, pose.y_m) if isinstance(body, HasPlaces) else None
    return one_line(f"{place.replace('_', ' ')} {at}" if place else at)
