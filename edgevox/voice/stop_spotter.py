"""Hears "stop", "halt" and "freeze" in running sound, without waiting for the end of what is said.

What it is sure of stops the robot at once; where it is not, it asks Whisper what was just said.
English stop words count whatever language is spoken. It stops wherever one of them is said, as in
"do not stop" too: when in doubt, it stops. What the network was trained on and how well it hears is
in docs/stop-spotter.md.
"""

import functools
from collections import deque
from collections.abc import Callable
from pathlib import Path

import numpy as np

from edgevox.core.log import get_logger, worth_a_line
from edgevox.voice.audio import Samples
from edgevox.voice.once_per_word import OncePerWord
from edgevox.voice.stop_encoder import SAMPLES, Floats, StopEncoder
from edgevox.voice.stop_network import StopWeights, likelihoods, read_weights
from edgevox.voice.stop_second_look import LOOKED_AT, SecondLook
from edgevox.voice.wake_sleep import WakeSleep

log = get_logger(__name__)

LOOKS_EVERY = 2
"""Frames of sound from one look to the next, 64 ms."""
SMOOTHED_LOOKS = 3
"""The mean of so many looks counts: no single one stops a robot."""
REST_S = 0.6
"""After a word none counts for so long, so that one word is one stop."""
DOUBTED, MOST_ASKED = 0.3, 4
"""From this likelihood up to the threshold it asks for a second look, so many times at most for
what may be one word."""

Confirm = Callable[[Samples], bool]
"""Whether there is a stop word in the last `LOOKED_AT` samples, which the network doubts."""


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
        self._asked = 0
        self._once = OncePerWord(REST_S)

    def said(self, look: Floats | None, confirmed: Callable[[], bool] = lambda: False) -> bool:
        """Whether one has just been said: the likelihoods of the words, or None between looks.

        `confirmed` is asked where they leave a doubt.
        """
        found = False
        if look is not None:
            self._recent.append(1 - float(look[0]))
            self.likelihood = sum(self._recent) / SMOOTHED_LOOKS
            if found := self.likelihood >= self.threshold or self._is(confirmed):
                self.word = self._words[1 + int(np.argmax(look[1:]))]
        return self._once.counts(found)

    def _is(self, confirmed: Callable[[], bool]) -> bool:
        if self.likelihood < DOUBTED:
            self._asked = 0
            return False
        self._asked += 1
        return self._asked <= MOST_ASKED and not self._once.resting and confirmed()

    def rest(self) -> None:
        """Nobody speaks: what was looked at before does not count any more."""
        self._recent.clear()
        self.likelihood, self._asked = 0.0, 0
        self._once.counts(False)

    def forget(self) -> None:
        """What comes next does not follow on what was before."""
        self.rest()
        self._once.forget()


class StopSpotter:
    """Told every frame of what is heard, it says when a stop word has just been said.

    `confirm` is asked where it doubts, if there is one. Used from one thread.
    """

    def __init__(
        self,
        encoder: StopEncoder,
        weights: StopWeights,
        threshold: float | None = None,
        confirm: Confirm = lambda _: False,
    ) -> None:
        self._encoder = encoder
        self._weights = weights
        self._confirm = confirm
        self._judge = StopJudge(weights, threshold)
        self._sleep = WakeSleep()
        self._sound = np.zeros(LOOKED_AT, np.int16)
        self._frames = 0
        self.failed = 0
        """Second looks that failed."""

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
        self._sound = np.concatenate([self._sound, *awake])[-LOOKED_AT:]
        self._frames += 1
        look = self._look() if self._frames % LOOKS_EVERY == 0 else None
        return self._judge.said(look, self._is_confirmed)

    def warm_up(self) -> None:
        """Load what it needs, so that the first who says a word does not wait for it."""
        self._look()
        self._is_confirmed()

    def forget(self) -> None:
        """What comes next does not follow on what was before."""
        self._sleep.reset()
        self._sound[:] = 0
        self._frames = 0
        self._judge.forget()

    def _look(self) -> Floats:
        (look,) = likelihoods(self._weights, self._encoder.of([self._sound[-SAMPLES:]]))
        return np.asarray(look)

    def _is_confirmed(self) -> bool:
        """Where that fails, what the network is sure of stops the robot all the same."""
        try:
            return self._confirm(self._sound)
        except Exception:
            self.failed += 1
            if worth_a_line(self.failed):
                log.exception("stop_second_look_failed", failed=self.failed)
            return False


def open_stop_spotter(encoder: Path) -> StopSpotter:
    """The one that this package brings, which is English, with its encoder's folder."""
    network, weights, second = _shared(encoder)
    return StopSpotter(network, weights, confirm=second.has_stop_word)


@functools.cache
def _shared(encoder: Path) -> tuple[StopEncoder, StopWeights, SecondLook]:
    """One for all who listen; it may be asked from any thread."""
    weights = read_weights()
    return StopEncoder(encoder, weights.added), weights, SecondLook(encoder)
