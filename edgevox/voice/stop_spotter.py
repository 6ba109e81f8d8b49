"""Hears "stop", "halt" and "freeze" in running sound, without waiting for the end of what is said.

English stop words count whatever language is spoken. It stops wherever one of them is said, as in
"do not stop" too: when in doubt, it stops. What the network was trained on and how well it hears is
in docs/stop-spotter.md.
"""

import functools
from collections import deque
from pathlib import Path

import numpy as np

from edgevox.voice.audio import Samples
from edgevox.voice.once_per_word import OncePerWord
from edgevox.voice.stop_encoder import SAMPLES, Floats, StopEncoder
from edgevox.voice.stop_network import StopWeights, likelihoods, read_weights
from edgevox.voice.wake_sleep import WakeSleep

LOOKS_EVERY = 2
"""Frames of sound from one look to the next, 64 ms."""
SMOOTHED_LOOKS = 3
"""The mean of so many looks counts: no single one stops a robot."""
REST_S = 0.6
"""After a word none counts for so long, so that one word is one stop."""


class StopJudge:
    """Decides, from what the network says at every look, when a word has been said.

    `likelihood` is how likely one was at the last look, 0 to 1; `word` the one that was said last.
    """

    def __init__(self, weights: StopWeights, threshold: float | None = None) -> None:
        self.threshold = weights.threshold if threshold is None else threshold
        self.likelihood = 0.0
        self.word = ""
        self._words = weights.words
        self._recent: deque[float] = deque(maxlen=SMOOTHED_LOOKS)
        self._once = OncePerWord(REST_S)

    def said(self, look: Floats | None) -> bool:
        """Whether one has just been said: the likelihoods of the words, or None between looks."""
        found = False
        if look is not None:
            self._recent.append(1 - float(look[0]))
            self.likelihood = sum(self._recent) / SMOOTHED_LOOKS
            if found := self.likelihood >= self.threshold:
                self.word = self._words[1 + int(np.argmax(look[1:]))]
        return self._once.counts(found)

    def rest(self) -> None:
        """Nobody speaks: what was looked at before does not count any more."""
        self._recent.clear()
        self.likelihood = 0.0
        self._once.counts(False)

    def forget(self) -> None:
        """What comes next does not follow on what was before."""
        self.rest()
        self._once.forget()


class StopSpotter:
    """Told every frame of what is heard, it says when a stop word has just been said.

    Used from one thread.
    """

    def __init__(
        self, encoder: StopEncoder, weights: StopWeights, threshold: float | None = None
    ) -> None:
        self._encoder = encoder
        self._weights = weights
        self._judge = StopJudge(weights, threshold)
        self._sleep = WakeSleep()
        self._sound = np.zeros(SAMPLES, np.int16)
        self._frames = 0

    @property
    def likelihood(self) -> float:
        """How likely a word was at the end of the last frame, 0 to 1."""
        return self._judge.likelihood

    @property
    def word(self) -> str:
        """The stop word that it heard last."""
        return self._judge.word

    def heard(self, samples: Samples, probability: float) -> bool:
        """Whether a stop word has just been said; 512 samples of int16 at 16 kHz, in order, and
        how likely they hold a voice: it sleeps a second after the last.
        """
        awake = self._sleep.push(samples, probability)
        if not awake:
            self._judge.rest()
            return False
        self._sound = np.concatenate([self._sound, *awake])[-SAMPLES:]
        self._frames += 1
        return self._judge.said(self._look() if self._frames % LOOKS_EVERY == 0 else None)

    def warm_up(self) -> None:
        """Load what it needs, so that the first who says a word does not wait for it."""
        self._look()

    def forget(self) -> None:
        """What comes next does not follow on what was before."""
        self._sleep.reset()
        self._sound[:] = 0
        self._frames = 0
        self._judge.forget()

    def _look(self) -> Floats:
        (look,) = likelihoods(self._weights, self._encoder.of([self._sound]))
        return np.asarray(look)


def open_stop_spotter(encoder: Path) -> StopSpotter:
    """The one that this package brings, which is English, with its encoder's folder."""
    return StopSpotter(*_shared(encoder))


@functools.cache
def _shared(encoder: Path) -> tuple[StopEncoder, StopWeights]:
    """One for all who listen; it may be asked from any thread."""
    weights = read_weights()
    return StopEncoder(encoder, weights.added), weights
