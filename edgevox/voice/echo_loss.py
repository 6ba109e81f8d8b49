"""By how much a canceller weakens the echo, measured: the echo return loss enhancement (ERLE)."""

import math

from edgevox.core.log import get_logger
from edgevox.voice.audio import FRAME_S, Samples
from edgevox.voice.level import rms

log = get_logger(__name__)

OVER_S = 4.0
"""The measure follows with this time constant, of sound that is played."""
JUDGED_AFTER_S = 1.0
"""So much of the robot's voice is heard before the canceller is judged for the first time."""
ENOUGH_DB = 10.0
"""From here on the canceller is used."""
TOO_LITTLE_DB = 6.0
"""A canceller that takes out less does not have what is played, and is used no more."""
AUDIBLE = 0.01
"""Only what is played at least so loud, and heard above the room's noise, is measured."""
HEARD = 0.003


class EchoLoss:
    """Watches what goes into a canceller and what comes out."""

    def __init__(self) -> None:
        self._heard = self._left = 0.0
        self._measured_s = 0.0
        self.enough = False
        """Whether the canceller takes out enough; not before that is measured."""

    @property
    def decibels(self) -> float:
        """The ERLE of the last seconds, 0 before anything was measured."""
        if self._heard <= 0.0:
            return 0.0
        return 10 * math.log10(self._heard / max(self._left, 1e-12))

    def push(self, heard: Samples, left: Samples, played: Samples) -> None:
        """A frame before and after; `played` meanwhile."""
        if rms(played) < AUDIBLE or rms(heard) < HEARD:
            return
        part = FRAME_S / OVER_S
        self._heard += part * (rms(heard) ** 2 - self._heard)
        self._left += part * (rms(left) ** 2 - self._left)
        self._measured_s += FRAME_S
        if self._measured_s >= JUDGED_AFTER_S:
            self._judge()

    def _judge(self) -> None:
        wanted = TOO_LITTLE_DB if self.enough else ENOUGH_DB
        enough = self.decibels >= wanted
        if enough != self.enough:
            self.enough = enough
            tell = log.info if enough else log.warning
            tell("echo_cancelled" if enough else "echo_not_cancelled", erle_db=round(self.decibels))
