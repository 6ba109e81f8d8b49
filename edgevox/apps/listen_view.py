"""The display of `edgevox listen`: one line that is redrawn on a terminal, else a line a second."""

import threading
from collections.abc import Callable, Mapping
from typing import Protocol

from edgevox.core.commands import Command, Heard, StopSpotted
from edgevox.core.events import WakeWordHeard
from edgevox.core.files.text import one_line
from edgevox.voice.audio import FRAME_S
from edgevox.voice.endpoint import VOICED
from edgevox.voice.noise_floor import SILENT_DB, HearingMeter, HearingReading

BAR = 24
REDRAWN_S, TOLD_S = 0.1, 1.0
_CLEAR = "\r\x1b[K"


class Detector(Protocol):
    """A detector of a word by its sound: a `StopDetector`, a `WakeDetector`."""

    @property
    def likelihood(self) -> float:
        """The likelihood that the word was just said, 0 to 1."""


class ListenView:
    """Writes readings as they come, and above them the transcripts. For any thread.

    `live` redraws the last reading. `detectors` are shown by these names.
    """

    def __init__(
        self,
        write: Callable[[str], object],
        *,
        live: bool,
        detectors: Mapping[str, Detector] | None = None,
    ) -> None:
        self._write = write
        self._live = live
        self._detectors = detectors or {}
        self._highest = dict.fromkeys(self._detectors, 0.0)
        self._every_s = REDRAWN_S if live else TOLD_S
        self._due_s = self._every_s
        self._lock = threading.Lock()

    def show(self, meter: HearingMeter) -> None:
        """Show what was measured, if it is time, and the most that each detector thought since."""
        for name, detector in self._detectors.items():
            self._highest[name] = max(self._highest[name], detector.likelihood)
        if meter.heard_s < self._due_s:
            return
        self._due_s = meter.heard_s + self._every_s - FRAME_S / 2
        reading = meter.reading()
        with self._lock:
            line = as_line(reading, self._highest)
            if self._live:
                self._write(f"{_CLEAR}{_bar(reading.level_db)} {line}")
            else:
                self._write(f"{reading.heard_s:7.1f} s  {line}\n")
        self._highest = dict.fromkeys(self._detectors, 0.0)

    def command(self, command: Command) -> None:
        """Tell what was understood, and the stop words that were known by their sound."""
        if isinstance(command, StopSpotted):
            self._tell(f'sounds like "{command.word}"')
        elif isinstance(command, Heard):
            self._tell(f'heard "{command.text}"' if command.text else "no words in what was heard")

    def woken(self, event: WakeWordHeard) -> None:
        """Tell that the wake word was heard."""
        self._tell(f'wake word "{event.phrase}"')

    def close(self) -> None:
        """Leave the line that is drawn anew."""
        if self._live:
            self._write("\n")

    def _tell(self, line: str) -> None:
        with self._lock:
            self._write(f"{_CLEAR if self._live else ''}  {one_line(line)}\n")


def as_line(reading: HearingReading, detectors: Mapping[str, float]) -> str:
    """A reading in words and figures, then what each detector thought at most."""
    noise, floor = reading.signal_to_noise_db, reading.floor_db
    return "  ".join(
        (
            f"level {reading.level_db:4.0f} dB",
            "floor    - " if floor is None else f"floor {floor:4.0f} dB",
            "signal/noise    - " if noise is None else f"signal/noise {noise:3.0f} dB",
            f"clipped {100 * reading.clipped_share:4.1f} %",
            f"voice {reading.voice:4.2f} " + ("speech" if reading.voice >= VOICED else "      "),
            *(f"{name} {likelihood:4.2f}" for name, likelihood in detectors.items()),
        )
    )


def _bar(level_db: float) -> str:
    full = round(BAR * (1 - level_db / SILENT_DB))
    return "[" + "#" * full + " " * (BAR - full) + "]"
