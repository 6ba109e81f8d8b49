"""The voice detector for the person who speaks to the robot: louder than the voices behind.

A plain voice detector finds a voice in every frame of a canteen, so that no utterance there ever
ends. Here a voice counts only if it stands out of the voices behind it.
"""

from collections import deque

import numpy as np

from edgevox.voice.audio import FRAME_S, Samples
from edgevox.voice.vad import SileroVad, VoiceDetector

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
