"""Echo cancellation: removes the robot's own voice from the microphone, so that a person is heard.

Two cancellers run side by side. WebRTC's AEC3 (package `pywebrtc-audio`) leaves nearly no echo, but
suppresses parts of a person's words with it; its output serves the voice detector. An
`AdaptiveFilter` removes the echo that it has learnt and leaves a person's words as they are; its
output serves speech to text.

A person is found in one of two ways: by a voice in AEC3's output, or, where both cancellers agree,
by what the filter leaves: it is louder than the gate expects of residual echo, and AEC3 did not
suppress it. Each frame is judged alone; after several such frames, any voice in the filter's output
is a person's (`VoiceOverEcho`).

The gate decides instead, on the unprocessed sound, until AEC3 is measured to remove the echo and
wherever it does not (the reference is not what is played, or the delay is longer than AEC3 can
follow).

`CapturePosition` finds when a microphone's frames were captured, though each arrives with its own
delay. `VoiceOverEcho` runs two voice detectors: one on AEC3's output, which loses parts of a
person, and one on the filter's output, which holds some of the robot and counts only while other
evidence says that a person speaks.
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
from edgevox.voice.utterance_end import VOICED
from edgevox.voice.vad import VoiceDetector

log = get_logger(__name__)


BLOCK_SAMPLES = 160
"""AEC3 works on blocks of 10 ms."""
DELAY_SAMPLES = 128
"""The most samples of a block that frames leave over; AEC3's output is delayed by this many."""


class CancellingEngine(Protocol):
    """An echo canceller for samples at 16 kHz."""

    def process(self, near: Samples, far: Samples) -> Samples:
        """Return `near` (heard) without the echo of `far` (played); both are whole blocks."""


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
        """Return a frame without the echo of the played sound, 8 ms late."""
        self._near = np.concatenate([self._near, near])
        self._far = np.concatenate([self._far, far])
        whole = self._near.size // BLOCK_SAMPLES * BLOCK_SAMPLES
        cleaned = self._engine.process(self._near[:whole], self._far[:whole])
        self._near, self._far = self._near[whole:], self._far[whole:]
        out = np.concatenate([self._out, cleaned])
        self._out = out[FRAME_SAMPLES:]
        return out[:FRAME_SAMPLES]


WINDOW_FRAMES = 64
"""2 s: the least late of these frames sets the time of all."""
LOST_S = 0.25
"""A frame that comes this much later than due does not follow on the one before."""
SLIP_SAMPLES = 16
"""1 ms: so far apart, the positions are set right while nothing is played."""
JUMP_SAMPLES = 320
"""20 ms: so far apart, they are set right at once, because sound was lost."""


class CapturePosition:
    """The position of each captured frame's first sample in the clock's time, in samples.

    Frames follow each other without a gap, because a canceller has to learn again after each gap.
    Where the clocks drift apart or sound is lost, the position jumps, in silence if it can wait.
    """

    def __init__(self) -> None:
        self._late: deque[float] = deque(maxlen=WINDOW_FRAMES)
        self._count = 0
        self._next = 0

    def take(self, end_s: float, *, quiet: bool) -> int:
        """Return the position of the frame whose last sample arrived at `end_s`."""
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
    """The voice that was found in a frame."""

    probability: float
    """The probability that the frame holds a person's voice, 0 to 1."""
    surmised: bool
    """Whether the frame holds a voice that may be a person's, or the robot's."""


HINT, HINTED_FRAMES = 0.1, 10
"""The least probability of a voice in AEC3's output, in one of so many frames, for a voice in the
others to count. A motor or a fan is louder than the echo, too, and what is left of the robot's
own voice beside it was taken for a person. Chosen with the voices and motors that tune: of 30
people none is lost."""


class VoiceOverEcho:
    """Takes every frame in turn; of the detector it takes others as soon as it needs them."""

    def __init__(self, vad: VoiceDetector) -> None:
        self._vad = vad
        self._beside: VoiceDetector | None = None
        self._suppressed: VoiceDetector | None = None
        self._hints: deque[float] = deque(maxlen=HINTED_FRAMES)
        self._goes_on = False

    @property
    def any_voice(self) -> float:
        """See `VoiceDetector`; of the first detector."""
        return self._vad.any_voice

    def of(self, sound: Unechoed) -> FoundVoice:
        """Judge the next frame."""
        probability = self._vad.probability(sound.voice)
        if not sound.cancelled:
            self._goes_on = False
            return FoundVoice(probability, surmised=False)
        beside = self._beside = self._beside or self._vad.another()
        suppressed = self._suppressed = self._suppressed or self._vad.another()
        if not self._goes_on:
            beside.reset()
            suppressed.reset()
            self._hints.clear()
        self._goes_on = True
        surmised = beside.probability(sound.words)
        if sound.somebody:
            probability = max(probability, surmised)
        if sound.suppressed is not None:
            self._hints.append(suppressed.probability(sound.suppressed))
            if max(self._hints) < HINT:
                probability = min(probability, self._hints[-1])
        return FoundVoice(probability, surmised >= VOICED)

    def reset(self) -> None:
        """The next frame does not follow on those before."""
        self._vad.reset()
        self._goes_on = False


AFTER_S = 1.0
"""Seconds after the last played sound when there is no more echo to remove."""

TAIL_S = 0.5
"""Sound that another computer plays comes back later than a card's echo; until AEC3 is measured
to cancel it, the gate must expect it for this long."""

PERSON_LOUDER, PERSON_SUPPRESSED = 2.0, 0.2
PERSON_FRAMES, PERSON_AMONG, PERSON_GOES_ON = 3, 5, 4
"""Of five frames, three must be a person's before the voice is believed; it is believed until
none of four was. Of 60 people in rooms to tune with (the benchmark `duplex` has others) 58 are
noticed, and no person is found in 56 minutes of the robot's own voice."""

LOUDER, SUPPRESSED = 1.5, 0.25
"""A frame is a person's if it is this many times louder than the echo that the filter usually
leaves, and AEC3 did not suppress it to below this share. Of 8,418 frames with only the robot's
own voice, half a percent pass, never three in a row; of a person's frames, 5 dB below the
loudspeaker, more than four of ten."""


def open_echo(
    echo: Echo,
    audible: Callable[[], float],
    played: PlayedSound | None,
    *,
    engine: Callable[[], CancellingEngine] = open_engine,
) -> EchoFilter:
    """Open the filter for the robot's own voice that the setting `echo` names.

    The gate is used instead, with a log line, if the canceller is not installed; and if there is no
    `played` sound to cancel.
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
        return Unechoed(words, words if is_person else voice, words, True, somebody, voice)


class _Persistence:
    """A finding in `PERSON_FRAMES` of `PERSON_AMONG` frames.

    It lasts until none of `PERSON_GOES_ON` has it.
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
