"""What detectors of words share: one detection per word, and sleep while nobody speaks.

A network finds a word in every window that holds it; `OncePerWord` counts it once.

A sleeping network misses nothing: the last two seconds of sound, as much as it looks at, are kept
and given to it as soon as there may be a voice. It runs on for a moment after the voice.
"""

from collections import deque
from collections.abc import Sequence
from typing import Protocol

from edgevox.voice.audio import FRAME_S, Samples

AWAKE = 0.1
"""The networks wake from this probability of a voice on."""
AWAKE_S = 1.0
"""Seconds that the networks stay awake after the last frame that may hold a voice."""
KEPT_S = 2.0
"""Seconds of earlier sound that the networks get when they wake."""
QUIET_S = 2.0
"""Seconds in which a wake word counts once: each window that holds it reports it."""


class WakeDetector(Protocol):
    """Hears one phrase."""

    phrase: str

    @property
    def likelihood(self) -> float:
        """The likelihood at the networks' last look that the phrase had just ended, 0 to 1."""

    def heard(self, samples: Samples, probability: float) -> bool:
        """Take the next frame, with its probability of voice; True once for each time it is said.

        That is within 0.15 s of its end.
        """

    def reset(self) -> None:
        """Forget what was heard: the next frame does not follow on it."""

    def close(self) -> None:
        """Free what it holds."""


class WakeSleep:
    """Says which frames the networks are to hear now."""

    def __init__(self, *, always_awake: bool = False) -> None:
        self._always_awake = always_awake
        self._before: deque[Samples] = deque(maxlen=round(KEPT_S / FRAME_S))
        self._awake = 0  # frames left

    def push(self, samples: Samples, probability: float) -> Sequence[Samples]:
        """Take the next frame, with its probability of voice; none while they sleep."""
        if probability >= AWAKE or self._always_awake:
            self._awake = round(AWAKE_S / FRAME_S)
        if not self._awake:
            self._before.append(samples)
            return ()
        self._awake -= 1
        heard = [*self._before, samples]
        self._before.clear()
        return heard

    def reset(self) -> None:
        """Forget what was heard, and sleep."""
        self._before.clear()
        self._awake = 0


class OncePerWord:
    """After a word that counts none does for `rest_s`. Told every frame."""

    def __init__(self, rest_s: float) -> None:
        self._rest_frames = round(rest_s / FRAME_S)
        self._left = 0

    @property
    def resting(self) -> bool:
        """Whether a word in the next frame would not count."""
        return self._left > 0

    def counts(self, found: bool) -> bool:
        """Take the next frame; whether the word that was `found` in it is a new one."""
        if self._left:
            self._left -= 1
            return False
        if found:
            self._left = self._rest_frames
        return found

    def forget(self) -> None:
        """Forget the word: the next sound does not follow on it."""
        self._left = 0
