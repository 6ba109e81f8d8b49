"""Hears "stop", "halt" and "freeze" in running sound, without waiting for the end of what is said.

It stops wherever one of them is said, as in "do not stop" too: when in doubt, it stops. What the
network was trained on and how well it hears is in docs/stop-spotter.md.
"""

from collections import deque

import numpy as np

from edgevox.voice.audio import Samples
from edgevox.voice.once_per_word import OncePerWord
from edgevox.voice.stop_features import Floats, StopFeatures
from edgevox.voice.stop_network import StopNetwork, StopWeights, read_weights

SMOOTHED_STEPS = 3
"""The mean of so many steps of 16 ms counts: no single one stops a robot."""
LANGUAGES = frozenset({"en"})
"""The languages whose stop words it knows, by ISO 639-1 code."""
REST_S = 0.6
"""After a word none counts for so long, so that one word is one stop."""


class StopJudge:
    """Decides, from what the network says of every frame, when a word has been said.

    `likelihood` is how likely one was at the end of the last frame, 0 to 1; `word` the one that it
    was most like.
    """

    def __init__(self, weights: StopWeights, threshold: float | None = None) -> None:
        self.threshold = weights.threshold if threshold is None else threshold
        self.likelihood = 0.0
        self.word = ""
        self._words = weights.words
        self._recent: deque[float] = deque(maxlen=SMOOTHED_STEPS)
        self._once = OncePerWord(REST_S)

    def said(self, steps: Floats) -> bool:
        """Whether one has just been said, by the steps of one more frame, shape (steps, words)."""
        self.likelihood = 0.0
        for step in steps:
            self._recent.append(1 - float(step[0]))
            mean = sum(self._recent) / SMOOTHED_STEPS
            if mean >= self.likelihood:
                self.likelihood, self.word = mean, self._words[1 + int(np.argmax(step[1:]))]
        return self._once.counts(self.likelihood >= self.threshold)

    def forget(self) -> None:
        """What comes next does not follow on what was before."""
        self._recent.clear()
        self._once.forget()
        self.likelihood = 0.0


class StopSpotter:
    """Told every frame of what is heard, it says when a stop word has just been said.

    Used from one thread.
    """

    languages = LANGUAGES

    def __init__(self, weights: StopWeights, threshold: float | None = None) -> None:
        self._features = StopFeatures()
        self._network = StopNetwork(weights)
        self._judge = StopJudge(weights, threshold)

    @property
    def likelihood(self) -> float:
        """How likely a word was at the end of the last frame, 0 to 1."""
        return self._judge.likelihood

    @property
    def word(self) -> str:
        """The stop word that what was last heard was most like."""
        return self._judge.word

    def heard(self, samples: Samples) -> bool:
        """Whether a stop word has just been said; 512 samples of int16 at 16 kHz, in order."""
        return self._judge.said(self._network.push(self._features.push(samples)))

    def forget(self) -> None:
        """What comes next does not follow on what was before."""
        self._features.forget()
        self._network.forget()
        self._judge.forget()


def open_stop_spotter() -> StopSpotter:
    """The one that this package brings: English."""
    return StopSpotter(read_weights())
