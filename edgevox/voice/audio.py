"""Sound as EdgeVox carries it: mono, 16 bit; input at 16 kHz in frames of 32 ms.

Also here: the loudness of sound, a framer for pieces of any size, which gives each frame the time
at which it was heard, and the level meter that a person sees while the robot hears.
"""

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from edgevox.core.cancel import CancelToken
from edgevox.core.errors import EdgeVoxError
from edgevox.core.events import AudioLevel

RATE_HZ = 16_000
"""The rate of everything that is heard."""
FRAME_SAMPLES = 512
FRAME_S = FRAME_SAMPLES / RATE_HZ

Samples = NDArray[np.int16]
"""Mono sound, shape (n,)."""


class EndOfSound(EdgeVoxError):
    """A source has no more: the file is over."""


class UtteranceOver(EdgeVoxError):
    """The speaker has let go of a source; the sound that comes next does not follow on the last.

    If `abandoned`, the speaker is gone and the unfinished utterance does not count.
    """

    def __init__(self, source: str, *, abandoned: bool) -> None:
        self.abandoned = abandoned
        super().__init__(f"{source}: {'nobody is there' if abandoned else 'released'}")


@dataclass(frozen=True, slots=True)
class Frame:
    """`FRAME_SAMPLES` samples at `RATE_HZ`."""

    samples: Samples
    end_s: float
    """The clock's time of the last sample, in seconds."""
    addressed: bool = False
    """True while the speaker holds a talk button: the speech needs no wake word."""


@dataclass(frozen=True, slots=True)
class Chunk:
    """A piece of speech as a synthesiser makes it."""

    samples: Samples
    rate_hz: int


class AudioSource(Protocol):
    """A microphone, or what stands for one."""

    name: str

    def start(self) -> None:
        """Begin to capture. A device that is not there is said and tried again, not raised."""

    def read(self, timeout_s: float) -> Frame | None:
        """The next frame; None if none came in time.

        Raises `EndOfSound`, and `UtteranceOver`, after which there may be more.
        """

    def close(self) -> None: ...


class AudioSink(Protocol):
    """A loudspeaker, or what stands for one. Used from one thread, but for `stop` and `audible`."""

    name: str

    def play(self, chunk: Chunk, token: CancelToken) -> float:
        """Play after what is playing; blocks while more than 0.1 s is still to be played.

        The clock's time at which its first sample is audible. Returns early if cancelled.
        """

    def drain(self, token: CancelToken) -> None:
        """Block until all is played or the token is cancelled."""

    def stop(self) -> float:
        """Silence within 0.1 s, whatever was still to be played; seconds that were not played."""

    def audible(self) -> float:
        """The root mean square of the sound that plays at this moment, 0 (silent) to 1."""

    def close(self) -> None: ...


FULL_SCALE = 32768.0


def rms(samples: Samples) -> float:
    """Root mean square, 0 (silent, or no samples) to 1 (a full-scale square wave)."""
    if not samples.size:
        return 0.0
    wide = samples.astype(np.float64)
    return float(np.sqrt(np.dot(wide, wide) / wide.size) / FULL_SCALE)


LOUDEST_SAMPLES = RATE_HZ // 5
SILENT_DB = -120.0


def loudness_db(samples: Samples) -> float:
    """The level of its loudest 0.2 s, in decibels below full scale; -120 for silence.

    Pauses do not count, so that a short word and a long sentence of one person are alike.
    """
    pieces = np.array_split(samples, max(1, samples.size // LOUDEST_SAMPLES))
    return 20.0 * math.log10(max(10 ** (SILENT_DB / 20), *map(rms, pieces), 0.0))


class Framer:
    """Collects mono samples at 16 kHz and gives them back in whole frames."""

    def __init__(self) -> None:
        self._left = np.empty(0, np.int16)

    def push(self, samples: Samples, end_s: float) -> Iterator[Frame]:
        """The frames that are whole now; `end_s` is the clock's time of the last sample given."""
        held = np.concatenate([self._left, samples])
        whole = held.size // FRAME_SAMPLES * FRAME_SAMPLES
        self._left = held[whole:]
        for start in range(0, whole, FRAME_SAMPLES):
            end = start + FRAME_SAMPLES
            yield Frame(held[start:end], end_s - (held.size - end) / RATE_HZ)

    def reset(self) -> None:
        """Forget what is not a whole frame yet: the next samples do not follow on it."""
        self._left = np.empty(0, np.int16)


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
