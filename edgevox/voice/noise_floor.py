"""The noise floor while nobody speaks, how far a voice stands out of it, and other measurements.

`HearingMeter` measures what a microphone hears: level, noise floor, signal to noise, clipping,
voice.
"""

import math
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from edgevox.voice.audio import FRAME_S, FRAME_SAMPLES, Samples, rms
from edgevox.voice.utterance_end import VOICED
from edgevox.voice.vad import VoiceDetector

SILENT_DB = -96.0
"""The quietest level that 16 bits can hold."""
WINDOW_S = 10.0
"""The floor is that of the last seconds."""
NO_VOICE = 0.3
"""Below this probability of a voice a frame tells of the floor."""
FLOOR_SHARE = 0.75
"""Share of the quiet frames that lie below the floor: knocks and beeps also count as noise."""
LEAST_FRAMES = 8
"""Fewest frames without a voice that give a floor: where many people talk at once there are
none."""
LOUD_S, LOUD_SHARE = 1.0, 0.9
"""Speech is as loud as the level below which this share of the last second's frames lies."""


class NoiseFloor:
    """Tracks the floor from frames of sound, and how far the latest speech stands out of it."""

    def __init__(self) -> None:
        self._quiet: deque[float | None] = deque(maxlen=round(WINDOW_S / FRAME_S))
        self._levels: deque[float] = deque(maxlen=round(LOUD_S / FRAME_S))

    def push(self, samples: Samples, probability: float) -> float:
        """Take the next frame, and how likely it holds a voice; its level, in dB of full scale."""
        level_db = decibels(rms(samples))
        self._levels.append(level_db)
        self._quiet.append(level_db if probability < NO_VOICE else None)
        return level_db

    def reset(self) -> None:
        """Forget the sound so far: the next frame does not follow on it."""
        self._quiet.clear()
        self._levels.clear()

    @property
    def floor_db(self) -> float | None:
        """The floor in dB of full scale; None until enough sound without a voice was heard."""
        quiet = [level_db for level_db in self._quiet if level_db is not None]
        return float(np.quantile(quiet, FLOOR_SHARE)) if len(quiet) >= LEAST_FRAMES else None

    @property
    def stands_out_db(self) -> float | None:
        """Decibels by which the latest speech exceeds the floor; None while that is unknown."""
        floor_db = self.floor_db
        if floor_db is None:
            return None
        return float(np.quantile(self._levels, LOUD_SHARE)) - floor_db


def decibels(level: float) -> float:
    """Convert a root mean square, 0 to 1, to decibels of full scale."""
    return max(SILENT_DB, 20 * math.log10(level)) if level > 0.0 else SILENT_DB


def speech_db(samples: Samples) -> float:
    """The mean level of the louder half of an utterance, in dB of full scale.

    Its pauses do not count, and neither does how exactly its beginning and end were found. Of two
    microphones, the nearer one has more of it; their loudest moments differ less.
    """
    frames = max(2, samples.size // FRAME_SAMPLES)
    levels = sorted(rms(piece) for piece in np.array_split(samples, frames))
    louder = levels[len(levels) // 2 :]
    return decibels(math.sqrt(sum(level**2 for level in louder) / len(louder)))


CLIPPED_FROM = 32_700
"""A sample this large is at the end of what 16 bits can hold."""


@dataclass(frozen=True, slots=True)
class HearingReading:
    """Levels of the last `WINDOW_S`, in decibels of full scale."""

    heard_s: float
    """Seconds of sound so far."""
    level_db: float
    floor_db: float | None
    """The noise floor; None without frames of silence."""
    signal_to_noise_db: float | None
    """None without a noise floor or without speech."""
    clipped_share: float
    """The share of samples at full scale, 0 to 1."""
    voice: float
    """The highest probability of a voice since the last reading."""


class HearingMeter:
    """A `VoiceDetector` around another one that measures all the sound that passes.

    `show` is called with the meter after each frame, on the thread that gave the frame.
    """

    def __init__(
        self, vad: VoiceDetector, show: Callable[["HearingMeter"], object] = lambda _: None
    ) -> None:
        self._vad = vad
        self._show = show
        frames = round(WINDOW_S / FRAME_S)
        self._noise = NoiseFloor()
        self._levels: deque[float] = deque(maxlen=frames)
        self._voices: deque[float] = deque(maxlen=frames)
        self._clipped: deque[float] = deque(maxlen=frames)
        self._frames = 0
        self._voice = 0.0

    @property
    def heard_s(self) -> float:
        """Seconds of sound that passed."""
        return self._frames * FRAME_S

    @property
    def any_voice(self) -> float:
        """See `VoiceDetector`."""
        return self._vad.any_voice

    def probability(self, samples: Samples) -> float:
        """See `VoiceDetector.probability`."""
        voice = self._vad.probability(samples)
        wide = samples.astype(np.int32)
        self._levels.append(self._noise.push(samples, voice))
        self._voices.append(voice)
        self._voice = max(self._voice, voice)
        self._clipped.append(float(np.mean(np.abs(wide) >= CLIPPED_FROM)))
        self._frames += 1
        self._show(self)
        return voice

    def reset(self) -> None:
        """See `VoiceDetector.reset`; what was measured stays."""
        self._vad.reset()

    def another(self) -> VoiceDetector:
        """See `VoiceDetector`; nothing is measured of what it hears."""
        return self._vad.another()

    def reading(self) -> HearingReading:
        """Return the current measurements. Call it from the thread that gives the frames."""
        if not self._levels:
            return HearingReading(0.0, SILENT_DB, None, None, 0.0, 0.0)
        voice, self._voice = self._voice, 0.0
        levels, floor_db = np.array(self._levels), self._noise.floor_db
        spoken = levels[np.array(self._voices) >= VOICED]
        return HearingReading(
            heard_s=self.heard_s,
            level_db=float(levels[-1]),
            floor_db=floor_db,
            signal_to_noise_db=(
                None if floor_db is None or not spoken.size else float(np.median(spoken)) - floor_db
            ),
            clipped_share=float(np.mean(self._clipped)),
            voice=voice,
        )
