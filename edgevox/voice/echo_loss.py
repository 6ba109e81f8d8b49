"""By how much a canceller weakens the echo, measured: the echo return loss enhancement (ERLE)."""

import math

from edgevox.core.log import get_logger
from edgevox.voice.audio import FRAME_S, Samples
from edgevox.voice.level import rms

log = get_logger(__name__)

OVER_S = 4.0
"""The measure follows with this time constant, of sound that is played."""
LATELY_S = 1.0
"""The same, for what is to be seen before the canceller is used."""
JUDGED_AFTER_S = 1.0
"""So much of the robot's voice is heard before the canceller is judged for the first time."""
ENOUGH_DB = 10.0
"""From here on the canceller is used."""
TOO_LITTLE_DB = 6.0
"""A canceller that takes out less does not have what is played, and is used no more."""
LINEAR_DB = 2.0
"""So much a linear filter must take out before the canceller is used, too. One that knows nothing
yet drops nearly all that it hears, a person with a headset too; a filter takes out echo or nothing:
nothing where there is none, 2 dB within 2 to 6 s in the rooms of the benchmark `duplex`."""
AUDIBLE = 0.01
"""Only what is played at least so loud, and heard above the room's noise, is measured."""
HEARD = 0.003


class EchoLoss:
    """Watches what goes into a canceller and what comes out, and out of a linear filter beside."""

    def __init__(self) -> None:
        self._long, self._lately = _Measure(OVER_S), _Measure(LATELY_S)
        self._linear = _Measure(LATELY_S)
        self._measured_s = 0.0
        self.enough = False
        """Whether the canceller takes out enough; not before that is measured."""

    @property
    def decibels(self) -> float:
        """The ERLE of the last seconds, 0 before anything was measured."""
        return self._long.decibels

    def push(self, heard: Samples, left: Samples, filtered: Samples, played: Samples) -> None:
        """A frame before and after, by both; `played` meanwhile."""
        if rms(played) < AUDIBLE or rms(heard) < HEARD:
            return
        for measure, after in (
            (self._long, left),
            (self._lately, left),
            (self._linear, filtered),
        ):
            measure.push(rms(heard) ** 2, rms(after) ** 2)
        self._measured_s += FRAME_S
        if self._measured_s >= JUDGED_AFTER_S:
            self._judge()

    def _judge(self) -> None:
        enough = self.decibels >= TOO_LITTLE_DB if self.enough else self._works()
        if enough != self.enough:
            self.enough = enough
            if enough:
                log.info("echo_cancelled", erle_db=round(self.decibels))
            else:
                log.warning("echo_not_cancelled", erle_db=round(self.decibels))

    def _works(self) -> bool:
        weakens = min(self.decibels, self._lately.decibels) >= ENOUGH_DB
        return weakens and self._linear.decibels >= LINEAR_DB


class _Measure:
    """The mean powers before and after, each forgotten with a time constant."""

    def __init__(self, over_s: float) -> None:
        self._part = FRAME_S / over_s
        self._heard = self._left = 0.0

    @property
    def decibels(self) -> float:
        if self._heard <= 0.0:
            return 0.0
        return 10 * math.log10(self._heard / max(self._left, 1e-12))

    def push(self, heard: float, left: float) -> None:
        self._heard += self._part * (heard - self._heard)
        self._left += self._part * (left - self._left)
