"""Hearing a person through the robot's own voice: what is played is taken out of what is heard.

Two cancellers side by side. WebRTC's AEC3 leaves nearly nothing of the echo and suppresses parts of
a person's words with it. An `AdaptiveFilter` takes out what it knows of the echo and leaves a
person's words as they are: that is for speech to text. Whether somebody speaks is told by what AEC3
gives, and, where both find a person, by what the filter leaves: it is louder than a gate has learnt
to expect of it, and AEC3 has not suppressed it. One frame of that is looked at by itself; where
several are found, a voice in all that the filter leaves is somebody's (`voice_over_echo`). Until
AEC3 is measured to take the echo out, and where it does not (the reference is not what is played,
the delay is longer than it can follow), the gate decides, on the sound as it came.
"""

from collections import deque
from collections.abc import Callable

import numpy as np

from edgevox.core.log import get_logger
from edgevox.core.settings import Echo
from edgevox.voice.adaptive_filter import AdaptiveFilter, Sound
from edgevox.voice.aec3 import CancellingEngine, FrameCanceller, open_engine
from edgevox.voice.audio import FRAME_S, FRAME_SAMPLES, Frame, Samples
from edgevox.voice.capture_position import CapturePosition
from edgevox.voice.echo import EchoFilter, EchoGate, Unechoed
from edgevox.voice.echo_loss import EchoLoss
from edgevox.voice.level import FULL_SCALE, rms
from edgevox.voice.played_sound import PlayedSound

log = get_logger(__name__)

AFTER_S = 1.0
"""So long after the last sound that was played, nothing is to be taken out any more."""

TAIL_S = 0.5
"""What is cancelled may come from another computer, later than the echo of a card; until it is
measured to be cancelled, the gate must know of that."""

PERSON_LOUDER, PERSON_SUPPRESSED = 2.0, 0.2
PERSON_FRAMES, PERSON_AMONG, PERSON_GOES_ON = 3, 5, 4
"""By so much and so little three of five frames are a person, whose voice is believed until none of
four was: of 60 people in rooms to tune with (the benchmark `duplex` has others) 58 are noticed,
and nobody in 56 minutes of the robot's own voice."""

LOUDER, SUPPRESSED = 1.5, 0.25
"""So much louder than the echo that the filter mostly leaves, and not suppressed by AEC3 to so much
of that, is a person: of 8,418 frames of nothing but the robot's own voice, half a percent, never
three in a row; of a person's 5 dB below the loudspeaker, more than four of ten."""


def open_echo(
    echo: Echo,
    audible: Callable[[], float],
    played: PlayedSound | None,
    *,
    engine: Callable[[], CancellingEngine] = open_engine,
) -> EchoFilter:
    """What keeps the robot's own voice out, by the setting `echo`.

    The gate stands in for a canceller that is not installed, which is logged, and where nobody
    knows what is `played`.
    """
    if echo == "cancel" and played is not None:
        try:
            return EchoCanceller(audible, played, engine())
        except ImportError as error:
            log.warning("echo_canceller_missing", reason=str(error), instead="gate")
    return EchoGate(audible, shut=echo != "none")


class EchoCanceller:
    """Cleans frames while something is played, or was just now; others it leaves as they are."""

    def __init__(
        self, audible: Callable[[], float], played: PlayedSound, engine: CancellingEngine
    ) -> None:
        self._played = played
        self._position = CapturePosition()
        self._filter = AdaptiveFilter()
        self._suppressor = FrameCanceller(engine)
        self._gate = EchoGate(audible, tail_s=TAIL_S)
        self._gate_behind = EchoGate(audible, tail_s=TAIL_S, margin=LOUDER)
        self._person = _Persistence()
        self._silent_s = AFTER_S
        self.loss = EchoLoss()

    @property
    def playing(self) -> bool:
        """Whether the robot, or its echo, may be audible."""
        return self._gate.playing

    def hear(self, frame: Frame) -> Unechoed:
        """The next frame, without the robot's own voice."""
        start = self._position.take(frame.end_s, quiet=self._silent_s >= AFTER_S)
        played = self._played.between(start, FRAME_SAMPLES)
        self._silent_s = 0.0 if played.any() else self._silent_s + FRAME_S
        as_it_came = self._gate.hear(frame)
        if self._silent_s >= AFTER_S:
            self._suppressor.begin_after(frame.samples)
            return as_it_came
        words = _samples(self._filter.push(_sound(frame.samples), _sound(played)))
        voice = self._suppressor.push(frame.samples, played)
        self.loss.push(frame.samples, voice, words, played)
        is_louder = self._gate_behind.passes(words)
        left, whole = rms(voice), rms(words)
        is_surely_louder = self._gate_behind.excess > PERSON_LOUDER
        goes_on = self._person.push(is_surely_louder and left > PERSON_SUPPRESSED * whole)
        if not self.loss.enough:
            return as_it_came
        is_person = is_louder and left > SUPPRESSED * whole
        somebody = goes_on or not self._gate_behind.playing
        return Unechoed(words, words if is_person else voice, words, True, somebody)


class _Persistence:
    """What is found in `PERSON_FRAMES` of `PERSON_AMONG` frames goes on until it was in none of
    `PERSON_GOES_ON`.
    """

    def __init__(self) -> None:
        self._found: deque[bool] = deque(maxlen=PERSON_AMONG)
        self._goes_on = False

    def push(self, found: bool) -> bool:
        self._found.append(found)
        lately = [*self._found][-PERSON_GOES_ON:]
        self._goes_on = sum(self._found) >= PERSON_FRAMES or (self._goes_on and any(lately))
        return self._goes_on


def _sound(samples: Samples) -> Sound:
    return samples / np.float32(FULL_SCALE)


def _samples(sound: Sound) -> Samples:
    rounded = np.clip(np.rint(sound * FULL_SCALE), -FULL_SCALE, FULL_SCALE - 1)
    return np.asarray(rounded, np.int16)
