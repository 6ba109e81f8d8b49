"""Hears "stop", "halt" and "freeze" in running sound, without waiting for the end of what is said,
and a few words of other languages where those are spoken.

Where it thinks of an English one, Whisper is asked what was just said: the odds of the first,
squared, times the likelihood that the second finds decide. In quiet they must be higher than in
noise, where fewer would be heard then. English stop words count whatever language is spoken. It
stops wherever one of them is said, as in "do not stop" too: when in doubt, it stops. What the
network was trained on and how well it hears is in training/spotter/README.md.

How likely Whisper finds it that a stop word was just said, where the spotter thinks of one.

The spotter's network looks at a second and knows three words; in noise, "Never step back" may be
one to it. Whisper looks at more and knows all words. It makes a few hypotheses of the last seconds,
as `whisper` does of an utterance, but is told of no commands: those it would hear everywhere.
"""

import functools
import math
import re
from collections import deque
from collections.abc import Callable, Mapping
from pathlib import Path

import numpy as np

from edgevox.core.log import get_logger, worth_a_line
from edgevox.voice.audio import RATE_HZ, Samples
from edgevox.voice.noise_floor import NoiseFloor
from edgevox.voice.stop.network import (
    SAMPLES,
    Floats,
    StopEncoder,
    StopWeights,
    likelihoods,
    read_language_weights,
    read_weights,
)
from edgevox.voice.stt.whisper import Whisper
from edgevox.voice.word_detection import OncePerWord, WakeSleep

log = get_logger(__name__)


LOOKED_AT = int(2.6 * RATE_HZ)
"""Samples: a stop word and what was said before it."""
_STOP_WORD = re.compile(r"\b(stop|stops|stopped|halt|freeze|frees)\b", re.IGNORECASE)


class SecondLook:
    """Whisper's smallest English model, from its folder, loaded when it is first asked.

    It is not the one that transcribes: who says "stop" does not wait for what was said before. It
    may be asked from any thread.
    """

    def __init__(self, folder: Path) -> None:
        self._whisper = Whisper(lambda _: folder, threads=1)

    def likelihood(self, sound: Samples) -> float:
        """Of all that may have been said in the last `LOOKED_AT` samples, what of the likelihood
        has a stop word, 0 to 1; mostly little, as much may be said. Takes some 45 ms of a core.

        Raises `EdgeVoxError` where the model cannot be loaded.
        """
        found = self._whisper.hypotheses(sound, "en")
        return sum(math.exp(one.whole) for one in found if _STOP_WORD.search(one.text))


ENGLISH = "en"
LOOKS_EVERY = 2
"""Frames of sound from one look to the next, 64 ms."""
SMOOTHED_LOOKS = 3
"""The mean of so many looks counts: no single one stops a robot."""
REST_S = 0.6
"""After a word none counts for so long, so that one word is one stop."""
ASKS_FROM, MOST_ASKED = 0.3, 8
"""From this likelihood on it asks for a second look, so many times for what may be one word; and
whenever the network is sure, as of who shouts "stop" again and again."""
LEAST_ODDS = 0.14
"""The odds of the network, as 3 for 0.75, squared, times the likelihood of the second look: from
here on a word counts. Squared, as Whisper finds words in voices that talk at once, too. By it is
chosen how much is heard, and how often it stops for nothing: see training/spotter/README.md."""
NOISY_DB, QUIET_DB, QUIET_TIMES = 15.0, 25.0, 30.0
"""Where what is said stands out by so much and less from what is around they are those; they rise
from there, and are so many times as high where it stands out by so much and more."""
_UNSURE, _UNHEARD = 1e-3, 1e-4
"""How sure at most the network is believed to be, and how little the second look may find."""

SecondLikelihood = Callable[[Samples], float]
"""How likely a stop word is in the last `LOOKED_AT` samples, 0 to 1."""


class StopJudge:
    """Decides, from what the network says at every look, when a word has been said.

    From its `threshold` on where nobody looks a second time, else by the odds of both. What is
    left of a word that has counted is none, unless the network is sure.
    `likelihood` is how likely one was at the last look, 0 to 1; `word` the one that was said last.
    """

    def __init__(
        self,
        weights: StopWeights,
        threshold: float | None = None,
        least_odds: float = LEAST_ODDS,
    ) -> None:
        self.threshold = weights.threshold if threshold is None else threshold
        self._least_odds = least_odds
        self.likelihood = 0.0
        self.word = ""
        self._words = weights.words
        self._recent: deque[float] = deque(maxlen=SMOOTHED_LOOKS)
        self._asked = 0
        self._left_over = False
        self._once = OncePerWord(REST_S)

    def said(
        self,
        look: Floats | None,
        second: Callable[[], float | None] | None = None,
        stands_out: Callable[[], float | None] = lambda: None,
    ) -> bool:
        """Whether one has just been said: the likelihoods of the words, or None between looks.

        `second` says how likely one is at a second look; None where that failed. `stands_out` says
        by how many dB what is said is louder than what is around; None where nobody knows.
        """
        found = False
        if look is not None:
            self._recent.append(1 - float(look[0]))
            self.likelihood = sum(self._recent) / SMOOTHED_LOOKS
            if found := self._is_one(second, stands_out):
                self.word = self._words[1 + int(np.argmax(look[1:]))]
        counts = self._once.counts(found)
        self._left_over |= counts
        return counts

    @property
    def resting(self) -> bool:
        """Whether one was said so recently that none counts now."""
        return self._once.resting

    def _is_one(
        self, second: Callable[[], float | None] | None, stands_out: Callable[[], float | None]
    ) -> bool:
        if second is None:
            return self.likelihood >= self.threshold
        if self.likelihood < ASKS_FROM:
            self._asked, self._left_over = 0, False
            return False
        self._asked += 1
        sure = self.likelihood >= self.threshold
        doubted = self._left_over or self._asked > MOST_ASKED
        if self._once.resting or (doubted and not sure):
            return False
        found = second()
        if found is None:
            return sure
        odds = (self.likelihood + _UNSURE) / (1 - self.likelihood + _UNSURE)
        return odds**2 * (found + _UNHEARD) >= self._least_odds * _times(stands_out())

    def rest(self) -> None:
        """Nobody speaks: what was looked at before does not count any more."""
        self._recent.clear()
        self.likelihood, self._asked, self._left_over = 0.0, 0, False
        self._once.counts(False)

    def forget(self) -> None:
        """What comes next does not follow on what was before."""
        self.rest()
        self._once.forget()


def _times(stands_out_db: float | None) -> float:
    """How many times as high the odds must be as in noise."""
    if stands_out_db is None:
        return 1.0
    quiet = (stands_out_db - NOISY_DB) / (QUIET_DB - NOISY_DB)
    return float(QUIET_TIMES ** min(1.0, max(0.0, quiet)))


class StopSpotter:
    """Told every frame of what is heard, it says when a stop word has just been said.

    `weights` are English, `others` those of other languages by their codes. `second` is asked where
    it thinks of an English word, if there is one. Used from one thread.
    """

    def __init__(
        self,
        encoder: StopEncoder,
        weights: StopWeights,
        threshold: float | None = None,
        second: SecondLikelihood | None = None,
        others: Mapping[str, StopWeights] | None = None,
    ) -> None:
        self._encoder = encoder
        self._weights = {ENGLISH: weights, **(others or {})}
        self._judges = {code: StopJudge(one, threshold) for code, one in self._weights.items()}
        self._second = second
        self._sleep = WakeSleep()
        self._noise = NoiseFloor()
        self._sound = np.zeros(LOOKED_AT, np.int16)
        self._frames = 0
        self.word = ""
        """The stop word that it heard last."""
        self.failed = 0
        """Second looks that failed."""

    @property
    def likelihood(self) -> float:
        """See `StopDetector`: by the network alone, before the second look."""
        return max(judge.likelihood for judge in self._judges.values())

    def heard(
        self,
        samples: Samples,
        probability: float,
        language: str = ENGLISH,
        *,
        playing: bool = False,
    ) -> bool:
        """See `StopDetector`. It sleeps a second after the last frame that may hold a voice."""
        if playing:  # what is left of its own voice comes and goes: nothing is quiet
            self._noise.reset()
        else:
            self._noise.push(samples, probability)
        awake = self._sleep.push(samples, 1.0 if playing else probability)
        if not awake:
            for judge in self._judges.values():
                judge.rest()
            return False
        self._sound = np.concatenate([self._sound, *awake])[-LOOKED_AT:]
        self._frames += 1
        looks = self._looks(language) if self._frames % LOOKS_EVERY == 0 else {}
        known = self._known(language)
        for code in self._judges.keys() - known:  # what was heard in it is no part of this
            self._judges[code].forget()
        resting = any(self._judges[code].resting for code in known)
        found = [code for code in known if self._said(code, looks.get(code))]
        if not found or resting:
            return False
        self.word = self._judges[found[0]].word
        return True

    def warm_up(self) -> None:
        """Load what it needs, so that the first who says a word does not wait for it."""
        self._looks(ENGLISH)
        self._looked_again()

    def forget(self) -> None:
        """What comes next does not follow on what was before."""
        self._sleep.reset()
        self._noise.reset()
        self._sound[:] = 0
        self._frames = 0
        for judge in self._judges.values():
            judge.forget()

    def _known(self, language: str) -> tuple[str, ...]:
        """Of which languages words are listened for where this one is spoken."""
        return tuple(dict.fromkeys(one for one in (ENGLISH, language) if one in self._weights))

    def _looks(self, language: str) -> dict[str, Floats]:
        """What the network of each of them says of the last of the sound."""
        encoded = self._encoder.of([self._sound[-SAMPLES:]])
        return {one: likelihoods(self._weights[one], encoded)[0] for one in self._known(language)}

    def _said(self, language: str, look: Floats | None) -> bool:
        twice = language == ENGLISH and self._second is not None
        second = self._looked_again if twice else None
        return self._judges[language].said(look, second, lambda: self._noise.stands_out_db)

    def _looked_again(self) -> float | None:
        """Where that fails, what the network is sure of stops the robot all the same."""
        try:
            return self._second(self._sound) if self._second else None
        except Exception:
            self.failed += 1
            if worth_a_line(self.failed):
                log.exception("stop_second_look_failed", failed=self.failed)
            return None


def open_stop_spotter(encoder: Path) -> StopSpotter:
    """With the weights that this package brings, from its encoder's folder."""
    network, weights, second, others = _shared(encoder)
    return StopSpotter(network, weights, second=second.likelihood, others=others)


@functools.cache
def _shared(
    encoder: Path,
) -> tuple[StopEncoder, StopWeights, SecondLook, Mapping[str, StopWeights]]:
    """One of each for all who listen; it may be asked from any thread."""
    weights, others = read_weights(), read_language_weights()
    return StopEncoder(encoder, weights.added), weights, SecondLook(encoder), others
