"""The noise floor while nobody speaks, and how far a voice stands out of it."""

import math
from collections import deque

import numpy as np

from edgevox.voice.audio import FRAME_S, Samples, rms

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
