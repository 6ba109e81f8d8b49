"""The echo gate: keeps the robot from hearing its own voice as speech.

`EchoGate` is half duplex with a measured threshold: while the robot speaks, a frame counts only if
it is louder, by a margin, than the echo of what plays now. The gate learns the coupling (the share
of the played sound that comes back: from about -6 dB for a loudspeaker beside the microphone to -30
dB across a room) as the robot speaks; its first guess is the loudest. So a person near the
microphone, or with a raised voice, interrupts the robot, and the robot never answers itself. A
quieter person needs a canceller (`canceller.py`); behind it, the same gate learns how much echo the
canceller leaves.

`EchoLoss` measures by how much a canceller weakens the echo: the echo return loss enhancement
(ERLE).
"""

import math
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from edgevox.core.log import get_logger
from edgevox.voice.audio import FRAME_S, Frame, Samples, rms

log = get_logger(__name__)


OVER_S = 4.0
"""The measure follows with this time constant, of sound that is played."""
LATELY_S = 1.0
"""The same time constant, for the measure that decides whether to use the canceller."""
JUDGED_AFTER_S = 1.0
"""Seconds of the robot's voice before the canceller is judged for the first time."""
ENOUGH_DB = 10.0
"""The canceller is used once its ERLE reaches this."""
TOO_LITTLE_DB = 6.0
"""Below this ERLE, the canceller's reference is not the played sound, and it is used no more."""
LINEAR_DB = 2.0
"""The linear filter must reach this ERLE, too, before the canceller is used. A canceller that
knows nothing yet drops nearly all that it hears, even a person with a headset. A filter removes
echo or nothing: nothing where there is none, 2 dB within 2 to 6 s in the rooms of the benchmark
`duplex`."""
AUDIBLE = 0.01
"""Only sound that plays at least this loud, and is heard above the room's noise (`HEARD`), is
measured."""
HEARD = 0.003


class EchoLoss:
    """Measures a canceller and a linear filter beside it, by their input and output."""

    def __init__(self) -> None:
        self._long, self._lately = _Measure(OVER_S), _Measure(LATELY_S)
        self._linear = _Measure(LATELY_S)
        self._measured_s = 0.0
        self.enough = False
        """Whether the canceller removes enough echo; False until that is measured."""

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


TAIL_S = 0.25
"""Seconds of echo after the sound: the delay of sound card and room."""
MARGIN = 2.5
"""8 dB by which a voice must exceed the expected echo. With 6 dB the robot interrupted itself 6
times in 18 simulated rooms, with 8 dB never."""
LOUDEST = 0.5
"""-6 dB: the coupling that is assumed before it has been heard."""
WEAKEST = 0.02
"""-34 dB: the least coupling that is believed; below it the room's own noise is measured."""
LEARNS_FROM = 0.7
"""Only what plays at least so loud, relative to the loudest of late, tells the coupling: where it
plays quietly, the echo of the louder sound before and the room's noise are heard."""
FALLS_S = 1.0
RISES_S = 0.2
"""Time constants of learning: for a weaker coupling (`FALLS_S`) and for a stronger one."""
RISES_THROUGH_S = 1.0
"""The same for sound that passes the gate: it is probably a person's."""
LOUD_S = 5.0
"""The loudest of late is forgotten with this time constant."""
OPEN_S = 0.13
"""After a frame that passed, the next ones pass too: a voice dips between syllables."""


@dataclass(frozen=True, slots=True)
class Unechoed:
    """A frame without the robot's own voice, in one form for each listener."""

    clean: Samples
    """For a word spotter, which knows its words through residual echo."""
    voice: Samples
    """For a voice detector, which would take residual echo for a voice: as little of it as
    possible."""
    words: Samples
    """For speech to text, which would take residual echo for words."""
    cancelled: bool = False
    """True if some of the robot's own voice may be left in all three forms."""
    somebody: bool = False
    """With `cancelled`: whether a voice in `words` is a person's and not the robot's."""
    suppressed: Samples | None = None
    """With `cancelled`: what the canceller leaves that suppresses most, which holds some of every
    person's voice."""


class EchoFilter(Protocol):
    """Keeps the robot's own voice out of what is heard."""

    @property
    def playing(self) -> bool:
        """Whether the robot, or its echo, may be audible."""

    def hear(self, frame: Frame) -> Unechoed:
        """The next frame, without the robot's own voice."""


class EchoGate:
    """Decides for each frame whether it may hold a person's voice.

    Args:
        audible: How loud the robot plays now, root mean square, 0 to 1.
        shut: False lets every frame pass.
        tail_s: How long the echo lasts after the sound, in seconds.
        margin: By how many times a voice must exceed the expected echo.
    """

    def __init__(
        self,
        audible: Callable[[], float],
        *,
        shut: bool = True,
        tail_s: float = TAIL_S,
        margin: float = MARGIN,
    ) -> None:
        self._audible = audible
        self._shut = shut
        self._margin = margin
        self._played: deque[float] = deque(maxlen=round(tail_s / FRAME_S))
        self._loudest = 0.0
        self._open = 0
        self.coupling = LOUDEST
        self.excess = 0.0
        """How many times louder the last frame was than its echo is expected to be, 0 without."""

    @property
    def playing(self) -> bool:
        """Whether the robot, or its echo, may be audible."""
        return any(self._played)

    def hear(self, frame: Frame) -> Unechoed:
        """The frame as it is if it `passes`."""
        gated = frame.samples if self.passes(frame.samples) else np.zeros_like(frame.samples)
        return Unechoed(frame.samples, gated, gated)

    def passes(self, samples: Samples) -> bool:
        """Take the next frame; False if it may be echo."""
        self._played.append(self._audible())
        played = max(self._played)
        self._open = max(0, self._open - 1)
        if not played or not self._shut:
            self.excess = 0.0
            return True
        heard = rms(samples)
        self.excess = heard / (self.coupling * played)
        through = self.excess > self._margin
        self._loudest = max(played, self._loudest * (1 - FRAME_S / LOUD_S))
        if played >= LEARNS_FROM * self._loudest:
            self._learn(min(heard / played, 1.0), through)
        if through:
            self._open = round(OPEN_S / FRAME_S)
        return through or self._open > 0

    def _learn(self, ratio: float, through: bool) -> None:
        rises_s = RISES_THROUGH_S if through else RISES_S
        constant_s = FALLS_S if ratio < self.coupling else rises_s
        learnt = self.coupling + FRAME_S / constant_s * (ratio - self.coupling)
        self.coupling = max(WEAKEST, learnt)
