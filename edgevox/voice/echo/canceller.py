"""Hearing a person through the robot's own voice: what is played is taken out of what is heard.

Two cancellers side by side. WebRTC's AEC3 leaves nearly nothing of the echo and suppresses parts of
a person's words with it. An `AdaptiveFilter` takes out what it knows of the echo and leaves a
person's words as they are: that is for speech to text. Whether somebody speaks is told by what AEC3
gives, and, where both find a person, by what the filter leaves: it is louder than a gate has learnt
to expect of it, and AEC3 has not suppressed it. One frame of that is looked at by itself; where
several are found, a voice in all that the filter leaves is somebody's (`voice_over_echo`). Until
AEC3 is measured to take the echo out, and where it does not (the reference is not what is played,
the delay is longer than it can follow), the gate decides, on the sound as it came.

WebRTC's echo canceller AEC3, from the package `pywebrtc-audio`, for frames of ours.

Where in time a microphone's frames were captured, though each arrives late by another while.

Whether somebody speaks, where something of the robot's own voice may be left in what is heard.

Two detectors of voices: one hears as little as possible of the robot and loses parts of a person;
the other hears all of a person and some of the robot, and counts while it is known by other means
that somebody speaks.
"""

from collections import deque
from collections.abc import Callable
from typing import NamedTuple, Protocol

import numpy as np

from edgevox.core.log import get_logger
from edgevox.core.settings import Echo
from edgevox.voice.audio import FRAME_S, FRAME_SAMPLES, FULL_SCALE, RATE_HZ, Frame, Samples, rms
from edgevox.voice.echo.filter import AdaptiveFilter, Sound
from edgevox.voice.echo.gate import EchoFilter, EchoGate, EchoLoss, Unechoed
from edgevox.voice.echo.played import PlayedSound
from edgevox.voice.endpoint import VOICED
from edgevox.voice.vad import VoiceDetector

log = get_logger(__name__)


BLOCK_SAMPLES = 160
"""It works on 10 ms."""
DELAY_SAMPLES = 128
"""What frames may leave of a block at most; so much later comes all that it gives back."""


class CancellingEngine(Protocol):
    """An echo canceller for samples at 16 kHz."""

    def process(self, near: Samples, far: Samples) -> Samples:
        """What was heard, without what was played; whole blocks."""


def open_engine() -> CancellingEngine:
    """AEC3. Raises `ImportError` where the package is not installed."""
    import pywebrtc_audio

    engine: CancellingEngine = pywebrtc_audio.EchoCanceller(RATE_HZ)
    return engine


class FrameCanceller:
    """Gives frames to an engine in its own blocks, and back in ours."""

    def __init__(self, engine: CancellingEngine) -> None:
        self._engine = engine
        self.begin_after(np.zeros(FRAME_SAMPLES, np.int16))

    def begin_after(self, samples: Samples) -> None:
        """The next frame follows on these samples, which it was not given."""
        self._near = self._far = np.zeros(0, np.int16)
        self._out = samples[-DELAY_SAMPLES:]

    def push(self, near: Samples, far: Samples) -> Samples:
        """A frame without what was played, 8 ms late."""
        self._near = np.concatenate([self._near, near])
        self._far = np.concatenate([self._far, far])
        whole = self._near.size // BLOCK_SAMPLES * BLOCK_SAMPLES
        cleaned = self._engine.process(self._near[:whole], self._far[:whole])
        self._near, self._far = self._near[whole:], self._far[whole:]
        out = np.concatenate([self._out, cleaned])
        self._out = out[FRAME_SAMPLES:]
        return out[:FRAME_SAMPLES]


WINDOW_FRAMES = 64
"""2 s: the frame of these that came least late tells the time of all."""
LOST_S = 0.25
"""A frame that comes so much later than due does not follow on the one before."""
SLIP_SAMPLES = 16
"""1 ms: so far apart, the positions are set right while nothing is played."""
JUMP_SAMPLES = 320
"""20 ms: so far apart, they are set right at once, because sound was lost."""


class CapturePosition:
    """Gives each frame the position of its first sample in the clock's time, in samples.

    One frame follows on the other without a gap, since a canceller would have to learn anew after
    each; where the clocks drift apart or sound is lost, the position jumps, best in silence.
    """

    def __init__(self) -> None:
        self._late: deque[float] = deque(maxlen=WINDOW_FRAMES)
        self._count = 0
        self._next = 0

    def take(self, end_s: float, *, quiet: bool) -> int:
        """The position of the frame whose last sample arrived at `end_s`."""
        self._count += 1
        late_s = end_s - self._count * FRAME_S
        if self._late and late_s - min(self._late) > LOST_S:
            self._late.clear()
        begins = not self._late
        self._late.append(late_s)
        wanted = round((min(self._late) + (self._count - 1) * FRAME_S) * RATE_HZ)
        apart = abs(wanted - self._next)
        if begins or apart > JUMP_SAMPLES or (quiet and apart > SLIP_SAMPLES):
            self._next = wanted
        position, self._next = self._next, self._next + FRAME_SAMPLES
        return position


class FoundVoice(NamedTuple):
    """How likely a frame holds somebody's voice, 0 to 1, and whether it holds one that may be
    somebody's.
    """

    probability: float
    surmised: bool


class VoiceOverEcho:
    """Takes every frame in turn; of the detector it takes another one as soon as it needs it."""

    def __init__(self, vad: VoiceDetector) -> None:
        self._vad = vad
        self._beside: VoiceDetector | None = None
        self._goes_on = False

    @property
    def any_voice(self) -> float:
        """See `VoiceDetector`; of the first detector."""
        return self._vad.any_voice

    def of(self, sound: Unechoed) -> FoundVoice:
        """Of the next frame."""
        probability = self._vad.probability(sound.voice)
        if not sound.cancelled:
            self._goes_on = False
            return FoundVoice(probability, surmised=False)
        beside = self._beside = self._beside or self._vad.another()
        if not self._goes_on:
            beside.reset()
        self._goes_on = True
        surmised = beside.probability(sound.words)
        if sound.somebody:
            probability = max(probability, surmised)
        return FoundVoice(probability, surmised >= VOICED)

    def reset(self) -> None:
        """The next frame does not follow on those before."""
        self._vad.reset()
        self._goes_on = False


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
