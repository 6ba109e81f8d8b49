"""The stop word spotter: hears "stop", "halt" and "freeze" before the utterance ends.

It also hears a few words of other languages while those are spoken. English stop words count
whatever language is spoken. It stops for a word in any sentence, even in "do not stop": when in
doubt, it stops. The network's training data and results are in training/spotter/README.md.

A possible English word gets a second look: Whisper is asked for the latest words. The squared odds
of the network, times the likelihood that Whisper gives to a stop word, decide. In quiet the limit
is higher than in noise, where fewer stop words would be heard with it.

The network looks at a second of sound and knows three words; in noise, "Never step back" may be one
to it. Whisper looks at more sound and knows all words. It makes a few hypotheses of the last
seconds, as for an utterance, but its prompt holds no commands: those it would hear everywhere.
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
from edgevox.voice.stop_spotter.network import (
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
"""Samples of a stop word and the speech before it."""
_STOP_WORD = re.compile(r"\b(stop|stops|stopped|halt|freeze|frees)\b", re.IGNORECASE)


class SecondLook:
    """Whisper's smallest English model, from its folder, loaded at the first use.

    It is not the one that transcribes: "stop" must not wait for earlier utterances. It may be asked
    from any thread.
    """

    def __init__(self, folder: Path) -> None:
        self._whisper = Whisper(lambda _: folder, threads=1)

    def likelihood(self, sound: Samples) -> float:
        """Return the share of hypotheses that hold a stop word, by their likelihood, 0 to 1.

        Looks at the last `LOOKED_AT` samples. The share is usually small, because many sentences
        are possible. Takes some 45 ms of a core. Raises `EdgeVoxError` if the model cannot be
        loaded.
        """
        found = self._whisper.hypotheses(sound, "en")
        return sum(math.exp(one.whole) for one in found if _STOP_WORD.search(one.text))


ENGLISH = "en"
LOOKS_EVERY = 2
"""Frames of sound from one look to the next, 64 ms."""
SMOOTHED_LOOKS = 3
"""The number of looks whose mean counts: no single look stops a robot."""
REST_S = 0.6
"""Seconds after a word in which no other counts, so that one word is one stop."""
ASKS_FROM, MOST_ASKED = 0.3, 8
"""The likelihood from which the judge asks for a second look, and the most looks for what may be
one word. It also asks whenever the network is sure, as when a person shouts "stop" again and
again."""
LEAST_ODDS = 0.1
"""The odds of the network (3 for 0.75), squared, times the likelihood of the second look: from
here on a word counts. Squared, because Whisper also finds words in voices that talk at once.
This number sets how many words are heard, and how many false stops there are: see
training/spotter/README.md."""
NOISY_DB, QUIET_DB, QUIET_TIMES = 15.0, 25.0, 30.0
"""Decibels by which speech stands out of the background. At the lower one, or below, the least
odds apply as they are; they rise from there, and are this many times as high at the upper one
and above."""
_UNSURE, _UNHEARD = 1e-3, 3e-5
"""Bounds of belief: the network's doubt is at least the first, the second look's likelihood at
least the second."""

SecondLikelihood = Callable[[Samples], float]
"""The likelihood that a stop word is in the last `LOOKED_AT` samples, 0 to 1."""


class StopJudge:
    """Decides, from the network's likelihoods at every look, when a word has been said.

    Without a second look, a word counts from `threshold` on; else by the odds of both looks. The
    remains of a word that has counted do not count again, unless the network is sure. `likelihood`
    is the one at the last look, 0 to 1; `word` is the word that was said last.
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
        """Return whether a word has just been said.

        Args:
            look: The likelihoods of the words; None between looks.
            second: The likelihood at a second look; None where that failed.
            stands_out: Decibels by which speech is louder than the background; None if unknown.
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
        """Whether a word was said so recently that none counts now."""
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
        """Forget the looks so far: nobody speaks."""
        self._recent.clear()
        self.likelihood, self._asked, self._left_over = 0.0, 0, False
        self._once.counts(False)

    def forget(self) -> None:
        """Forget the sound so far: the next does not follow on it."""
        self.rest()
        self._once.forget()


def _times(stands_out_db: float | None) -> float:
    """Return the factor on the odds, relative to noise."""
    if stands_out_db is None:
        return 1.0
    quiet = (stands_out_db - NOISY_DB) / (QUIET_DB - NOISY_DB)
    return float(QUIET_TIMES ** min(1.0, max(0.0, quiet)))


class StopSpotter:
    """Spots a stop word in running sound, frame by frame.

    Used from one thread. `weights` are for English, `others` for other languages by ISO 639-1 code.
    `second`, if given, confirms a possible English word.
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
        """Load all parts, so that the first stop word does not wait for it."""
        self._looks(ENGLISH)
        self._looked_again()

    def forget(self) -> None:
        """Forget the sound so far: the next frame does not follow on it."""
        self._sleep.reset()
        self._noise.reset()
        self._sound[:] = 0
        self._frames = 0
        for judge in self._judges.values():
            judge.forget()

    def _known(self, language: str) -> tuple[str, ...]:
        """Return the languages whose words are listened for while this one is spoken."""
        return tuple(dict.fromkeys(one for one in (ENGLISH, language) if one in self._weights))

    def _looks(self, language: str) -> dict[str, Floats]:
        """Return each language's likelihoods for the latest sound."""
        encoded = self._encoder.of([self._sound[-SAMPLES:]])
        return {one: likelihoods(self._weights[one], encoded)[0] for one in self._known(language)}

    def _said(self, language: str, look: Floats | None) -> bool:
        twice = language == ENGLISH and self._second is not None
        second = self._looked_again if twice else None
        return self._judges[language].said(look, second, lambda: self._noise.stands_out_db)

    def _looked_again(self) -> float | None:
        """Take the second look; None if it fails, so that a sure network still stops the robot."""
        try:
            return self._second(self._sound) if self._second else None
        except Exception:
            self.failed += 1
            if worth_a_line(self.failed):
                log.exception("stop_second_look_failed", failed=self.failed)
            return None


def open_stop_spotter(encoder: Path) -> StopSpotter:
    """Open a spotter with this package's weights and the encoder in its folder."""
    network, weights, second, others = _shared(encoder)
    return StopSpotter(network, weights, second=second.likelihood, others=others)


@functools.cache
def _shared(
    encoder: Path,
) -> tuple[StopEncoder, StopWeights, SecondLook, Mapping[str, StopWeights]]:
    """Load one of each for all listeners; may be called from any thread."""
    weights, others = read_weights(), read_language_weights()
    return StopEncoder(encoder, weights.added), weights, SecondLook(encoder), others
