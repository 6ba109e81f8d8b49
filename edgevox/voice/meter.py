"""The level that a person sees while the robot hears."""

from collections.abc import Callable

import numpy as np

from edgevox.core.events import AudioLevel
from edgevox.voice.audio import Samples
from edgevox.voice.level import rms

FRAMES = 3
"""About ten levels a second."""


class LevelMeter:
    """Publishes the loudness of every three frames."""

    def __init__(self, publish: Callable[[AudioLevel], None]) -> None:
        self._publish = publish
        self._frames: list[Samples] = []

    def push(self, samples: Samples) -> None:
        self._frames.append(samples)
        if len(self._frames) == FRAMES:
            self._publish(AudioLevel(round(rms(np.concatenate(self._frames)), 4)))
            self._frames.clear()

    def reset(self) -> None:
        self._frames.clear()
