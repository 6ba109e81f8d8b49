"""The texts of the side panel, of a fixed width."""

import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from rich.text import Text

from edgevox.core.events import State, TurnMeasured
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
