"""A microphone's measurements: level, noise floor, signal to noise, clipping, voice."""

from collections import deque
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from edgevox.voice.audio import FRAME_S, Samples
from edgevox.voice.endpoint import VOICED
from edgevox.voice.noise_floor import SILENT_DB, WINDOW_S, NoiseFloor
from edgevox.voice.vad import VoiceDetector

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
