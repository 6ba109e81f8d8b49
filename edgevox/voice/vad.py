"""Voice activity: Silero's detector, and the test that a voice is that of a person nearby.

A plain voice detector finds a voice in every frame of a canteen, so that no utterance there ever
ends. `ForegroundVad` counts a voice only if it is louder than the voices behind it.
"""

import functools
from collections import deque
from importlib import util
from pathlib import Path
from typing import Any, Protocol

import numpy as np

from edgevox.core.errors import EdgeVoxError, install_extra
from edgevox.voice.audio import FRAME_S, FRAME_SAMPLES, FULL_SCALE, Samples

_CONTEXT = 64  # samples of the frame before, which the network sees again
_STATE = (1, 1, 128)


class VoiceDetector(Protocol):
    """Judges one frame after the other.

    `any_voice` is the probability, 0 to 1, that the last frame held a voice, near or far;
    `probability` may leave out voices that do not speak to the robot.
    """

    @property
    def any_voice(self) -> float: ...

    def probability(self, samples: Samples) -> float:
        """Return the probability that the frame holds a voice, 0 to 1."""

    def reset(self) -> None:
        """Forget the frames before: the next one does not follow on them."""

    def another(self) -> "VoiceDetector":
        """Return a fresh detector of the same kind, for other sound."""


class SileroVad:
    """Silero VAD v6 on one thread, which sleeps between frames; 0.1 ms a frame.

    `path` is the ONNX file; by default the one that comes with faster-whisper.
    """

    def __init__(self, path: Path | None = None) -> None:
        self._path = path or bundled_vad()
        self._session = _network(self._path)
        self._input = np.zeros((1, _CONTEXT + FRAME_SAMPLES), np.float32)
        self._h = self._c = np.zeros(_STATE, np.float32)
        self.any_voice = 0.0

    def probability(self, samples: Samples) -> float:
        self._input[0, :_CONTEXT] = self._input[0, -_CONTEXT:]
        self._input[0, _CONTEXT:] = samples / np.float32(FULL_SCALE)
        found, self._h, self._c = self._session.run(
            None, {"input": self._input, "h": self._h, "c": self._c}
        )
        self.any_voice = float(found[0])
        return self.any_voice

    def reset(self) -> None:
        self._h = self._c = np.zeros(_STATE, np.float32)
        self._input[:] = 0

    def another(self) -> "SileroVad":
        return SileroVad(self._path)


@functools.cache
def _network(path: Path) -> Any:
    """Load one network for all listeners; it may be used from any thread."""
    import onnxruntime

    options = onnxruntime.SessionOptions()
    options.intra_op_num_threads = options.inter_op_num_threads = 1
    options.add_session_config_entry("session.intra_op.allow_spinning", "0")
    return onnxruntime.InferenceSession(str(path), options, providers=["CPUExecutionProvider"])


def bundled_vad() -> Path:
    """Silero's file in faster-whisper, found without importing that."""
    spec = util.find_spec("faster_whisper")
    for folder in (spec.submodule_search_locations or ()) if spec else ():
        for path in sorted(Path(folder, "assets").glob("silero_vad*.onnx")):
            return path
    raise EdgeVoxError(f"voice activity: no silero_vad.onnx; {install_extra('voice')} brings it")


ABOVE_DB = 4.5
"""Decibels by which the speaker must exceed the voices behind. Chosen with the voices, rooms and
babble to train with (`training/acoustics`): at 5 dB, 92 of 100 commands begin and end where they
do; with 4 dB some do not end, with 6 dB a fourth is lost."""
SMOOTHED_FRAMES = 8
"""Loudness is that of 0.25 s: many voices together rise and fall quickly."""
REMEMBERED_FRAMES = round(8.0 / FRAME_S)
LEAST_FRAMES = round(1.0 / FRAME_S)
"""Fewest frames of background (1 s) that set its level."""
QUIETEST = 8
"""The quietest eighth of the remembered frames is the background: a single speaker pauses for
more."""
VOICES = 0.5
"""The background holds voices from this probability in its quietest frames on; noise and quiet
change nothing."""
_ABOVE = 10 ** (ABOVE_DB / 10)


class ForegroundVad:
    """The detector's probability, but 0 for voices that do not stand out of those behind them."""

    def __init__(self, vad: VoiceDetector) -> None:
        self._vad = vad
        self.reset()

    @property
    def any_voice(self) -> float:
        """The probability that the last frame holds a voice, of any person."""
        return self._vad.any_voice

    def probability(self, samples: Samples) -> float:
        """Return the probability that the frame holds the voice of a person nearby, 0 to 1."""
        found = self._vad.probability(samples)
        self._powers.append(float(np.mean(np.square(samples, dtype=np.float32))))
        power = sum(self._powers) / len(self._powers)
        at = self._seen % REMEMBERED_FRAMES
        self._remembered[:, at] = power, found
        self._seen += 1
        behind = self._behind()
        return 0.0 if behind is not None and power < _ABOVE * behind else found

    def reset(self) -> None:
        """Forget the frames before: the next one does not follow on them."""
        self._vad.reset()
        self._seen = 0
        self._powers: deque[float] = deque(maxlen=SMOOTHED_FRAMES)
        self._remembered = np.zeros((2, REMEMBERED_FRAMES))

    def another(self) -> "ForegroundVad":
        """See `VoiceDetector`."""
        return ForegroundVad(self._vad.another())

    def _behind(self) -> float | None:
        """The power of the voices that are always there; None where there are none."""
        known = min(self._seen, REMEMBERED_FRAMES)
        if known < LEAST_FRAMES:
            return None
        powers, voices = self._remembered[:, :known]
        quietest = np.argpartition(powers, known // QUIETEST)[: known // QUIETEST]
        return float(np.median(powers[quietest])) if voices[quietest].mean() >= VOICES else None


def open_vad() -> VoiceDetector:
    """Open the robot's voice detector: Silero's, behind the foreground test."""
    return ForegroundVad(SileroVad())
