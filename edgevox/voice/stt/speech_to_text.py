"""The interface of a speech-to-text engine, and a watch over it that tells of its failures.

`stop_first` prefers a stop word that may have been said; `plausible` tests whether Whisper's words
were said, or made of noise.
"""

import math
import re
from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass, field, replace
from typing import Protocol

from edgevox.core.clock import Clock, SystemClock
from edgevox.core.commands import Hypothesis, Rate, as_hypotheses
from edgevox.voice.audio import Samples


@dataclass(frozen=True, slots=True)
class Transcript:
    """The words in a sound, empty if there are none, and how sure it is that they are those.

    `others` are what else may have been said, the likeliest first. `rate` rates other texts by the
    sound, where the words are not sure. `stops` are the hypotheses of a second search, in which the
    engine was shown stop words: only a stop word among them counts.
    """

    text: str
    confidence: float = 1.0
    others: tuple[Hypothesis, ...] = ()
    rate: Rate | None = field(default=None, compare=False, repr=False)
    stops: tuple[Hypothesis, ...] = ()


class SpeechToText(Protocol):
    """Understands one utterance at a time, on the caller's thread."""

    def transcribe(self, samples: Samples, language: str) -> Transcript:
        """The words in this sound at 16 kHz, in a language by its ISO 639-1 code.

        Raises `EdgeVoxError` if the language's model is not here.
        """

    def warm_up(self, language: str) -> None:
        """Load what the language needs, so that the first utterance does not wait for it."""

    def close(self) -> None: ...


MAY_STOP = 0.25
"""The share from which on a hypothesis that is a stop counts as said. A stop that one of two
hearings is sure of has half; of 692 utterances without one, none had so much."""
MAY_STOP_SHOWN = 0.7
"""The share that stop words must have together where they were shown: of 13 people's words in
Arabic, in quiet and in noise, a lone "yes", "no", "start" or "move" has less, in all but few."""


def stop_first(said: Transcript, is_stop: Callable[[str], bool]) -> Transcript:
    """Return the transcript, with a stop that may have been said as its words.

    When in doubt, stop.
    """
    if is_stop(said.text):
        return said
    likely = [one for one in said.others if one.share >= MAY_STOP and is_stop(one.text)]
    shown = [one for one in said.stops if is_stop(one.text)]
    if sum(one.share for one in shown) >= MAY_STOP_SHOWN:
        likely += shown
    if not likely:
        return said
    return replace(said, text=likely[0].text, confidence=likely[0].confidence)


TELL_EVERY_S = 20.0
"""Noise is taken for speech now and then: a robot must not lament all day."""


class WatchedSpeechToText:
    """A `SpeechToText` around another one that watches for faults.

    `tell` is called, at limited intervals, when an utterance was lost to a fault.
    """

    def __init__(self, stt: SpeechToText, clock: Clock | None = None) -> None:
        self.tell: Callable[[], None] = lambda: None
        self.fault = ""
        """The reason why nothing is understood now; empty after a success."""
        self._stt = stt
        self._clock = clock or SystemClock()
        self._told_s = float("-inf")

    def transcribe(self, samples: Samples, language: str) -> Transcript:
        """See `SpeechToText.transcribe`."""
        try:
            heard = self._stt.transcribe(samples, language)
        except Exception as error:
            self._lament(error)
            raise
        self.fault = ""
        return heard

    def warm_up(self, language: str) -> None:
        """See `SpeechToText.warm_up`."""
        try:
            self._stt.warm_up(language)
        except Exception as error:
            self._lament(error)
            raise
        self.fault = ""

    def close(self) -> None:
        """See `SpeechToText.close`."""
        self._stt.close()

    def _lament(self, error: Exception) -> None:
        self.fault = " ".join(str(error).split()) or type(error).__name__
        now_s = self._clock.now()
        if now_s - self._told_s >= TELL_EVERY_S:
            self._told_s = now_s
            self.tell()


SURELY_NOISE = 0.6
MAYBE_NOISE = 0.4
SURELY_SAID = -0.15
MAYBE_GUESSED = -0.6
SURELY_GUESSED = -1.0
REPEATS = 2.6
"""Text that compresses better than this says the same again and again."""
SHORT_S = 3.0
MAYBE_SAID = 0.02
"""Hypotheses less likely than this are left out."""
AROUND_S = 0.55
"""Seconds of an utterance that are silence, before and after the speech."""
BYTES_A_SECOND = 12.0
"""Bytes of UTF-8 per second that even a slow speaker reaches; bytes, so that a character that
stands for more counts for more. With fewer, words are missing: in noise "Walk backward half a
metre." becomes "Walk backward." Of 256 commands by voices to train with, those heard whole had
11.8 or more, cut ones 10.5 or fewer."""

_OF_NOTHING = frozenset(
    {
        "you",
        "thank you",
        "thanks for watching",
        "thank you for watching",
        "thank you very much",
        "please subscribe",
        "subtitles by the amara org community",
        "sous titres réalisés para la communauté d amara org",
        "subtítulos realizados por la comunidad de amara org",
        "sottotitoli creati dalla comunità amara org",
        "legendas pela comunidade amara org",
        "untertitel der amara org community",
        "ご視聴ありがとうございました",
    }
)
"""Phrases that Whisper learnt to write over silence, from the ends of films."""
_BRACKETED = re.compile(r"[\[(*♪][^\])*♪]*[\])*♪]?")
_NOT_WORDS = re.compile(r"[\W_]+")
_SENTENCE_ENDS = re.compile(r"(?<=[.!?\u3002\uff01\uff1f\u0964])\s+")


@dataclass(frozen=True, slots=True)
class Segment:
    """A piece of Whisper's output with its doubts."""

    text: str
    no_speech: float
    """The probability that nothing was said, 0 to 1."""
    log_probability: float
    """The mean log probability of the tokens."""
    compression: float
    """How many times shorter the text is when compressed."""
    whole: float = 0.0
    """The sum of the tokens' log probabilities."""

    @property
    def likelihood(self) -> float:
        """The geometric mean of its tokens' probabilities."""
        return math.exp(self.log_probability)


def plausible(segment: Segment, seconds: float) -> bool:
    """Return whether this was said in a sound of this many seconds."""
    plain = plain_words(segment.text)
    if not plain or segment.compression > REPEATS or segment.log_probability < SURELY_GUESSED:
        return False
    if segment.no_speech > SURELY_NOISE and segment.log_probability < SURELY_SAID:
        return False
    doubtful = segment.no_speech > MAYBE_NOISE
    if doubtful and segment.log_probability < MAYBE_GUESSED:
        return False
    return not (plain in _OF_NOTHING and (doubtful or seconds > SHORT_S or plain == "you"))


def parroted(segment: Segment, prompt: str) -> bool:
    """Return whether these are sentences of the prompt, unlikely to have been said.

    Given voices that talk at once, Whisper repeats the prompt that it was shown.
    """
    if segment.log_probability >= MAYBE_GUESSED:
        return False
    return _sentences(segment.text) <= _sentences(prompt)


def stop_word_parroted(said: str, stop_words: Collection[str], alone: Sequence[Segment]) -> bool:
    """Return whether these are only stop words of the prompt that are not heard without it.

    `alone` holds the hypotheses without the prompt; no likely one has such a word then. In a short
    word such as "on" Whisper hears the "Halt!" that it was shown.
    """
    words = _sentences(said)
    least = max((one.whole for one in alone), default=0.0) - ABOUT_AS_LIKELY
    likely = (one for one in alone if one.whole >= least)
    return words <= {*stop_words} and not any(
        words & {*plain_words(one.text).split()} for one in likely
    )


def _sentences(text: str) -> set[str]:
    """Each sentence of a text as `plain_words`."""
    return {plain_words(one) for one in _SENTENCE_ENDS.split(text.strip())}


def transcript_of(
    hypotheses: Sequence[Segment],
    seconds: float,
    prompt: str,
    likelihood: Callable[[Segment], float] = lambda one: one.likelihood,
) -> Transcript:
    """Return the transcript of a sound of this many seconds, with its alternatives.

    The first hypothesis gives the words; if it was not said, nothing was, whatever follows.
    Different spellings count as one, and unlikely hypotheses are left out. The confidence in words
    is their `likelihood`, lowered where they are too few for the sound.
    """
    said: dict[str, Hypothesis] = {}
    for one, share in zip(hypotheses, _shares(hypotheses), strict=True):
        real = plausible(one, seconds) and not parroted(one, prompt)
        if not real and not said:
            break
        text = words_of(one.text)
        if real and text:
            sure = likelihood(one) * _filled(text, seconds)
            new = Hypothesis(text, 0.0, sure)
            known = said.setdefault(plain_words(text), new)
            said[plain_words(text)] = replace(known, share=known.share + share)
    if not said:
        return Transcript("")
    first, *others = said.values()
    likely = sorted(others, key=lambda one: one.share, reverse=True)
    enough = tuple(one for one in likely if one.share >= MAYBE_SAID)
    return Transcript(first.text, first.confidence, enough)


def both(one: Transcript, other: Transcript) -> Transcript:
    """Return what two hearings of one sound make together: each text by the mean of its shares.

    A text that both have is as sure as the surer one of them is. Nothing is heard where the first
    heard nothing.
    """
    if not one.text or not other.text:
        return one
    said: dict[str, Hypothesis] = {}
    for heard in (one, other):
        for h in as_hypotheses(heard.text, heard.confidence, heard.others):
            known = said.setdefault(plain_words(h.text), replace(h, share=0.0))
            said[plain_words(h.text)] = replace(
                known,
                share=known.share + h.share / 2,
                confidence=max(known.confidence, h.confidence),
            )
    first, *others = sorted(said.values(), key=lambda h: h.share, reverse=True)
    enough = tuple(h for h in others if h.share >= MAYBE_SAID)
    return Transcript(first.text, first.confidence, enough)


def _shares(hypotheses: Sequence[Segment]) -> list[float]:
    """Return the share of each hypothesis among all, by likelihood."""
    most = max((one.whole for one in hypotheses), default=0.0)
    weights = [math.exp(one.whole - most) for one in hypotheses]
    return [weight / sum(weights) for weight in weights]


def _filled(text: str, seconds: float) -> float:
    """Return the share of the speech in this time that these words can be, 0 to 1."""
    fewest = BYTES_A_SECOND * (seconds - AROUND_S)
    size = len(text.encode())
    return size / fewest if size < fewest else 1.0


def words_of(text: str) -> str:
    """A text on one line, without remarks such as ``[music]``.

    A sentence that is only said again is left out: over other voices Whisper writes one twice that
    was said once, and "Turn left. Turn left." is another order.
    """
    spoken = " ".join(_BRACKETED.sub(" ", text).split())
    said: list[str] = []
    for sentence in _SENTENCE_ENDS.split(spoken):
        if not said or plain_words(sentence) != plain_words(said[-1]):
            said.append(sentence)
    return " ".join(said) if plain_words(spoken) else ""


def plain_words(text: str) -> str:
    """A text's words without case, marks and remarks, to compare it with another's."""
    return " ".join(_NOT_WORDS.sub(" ", _BRACKETED.sub(" ", text).casefold()).split())


SHOWN_COMMANDS = frozenset({"en"})
"""Languages in which the robot's own commands are shown (`HearingPrompts` of the agent). In others
only how numbers are written is."""
LISTEN_AGAIN_BELOW = 0.9
"""Words that are at least so sure were heard."""
NEAR, AWAY = 1.0, 2.0
"""In nats, the distances to the likeliest hypothesis: below the first, a text was heard then,
too; from the second on, it was not."""
ABOUT_AS_LIKELY = 1.5
"""In nats, below the likeliest hypothesis: without the prompt a stop word was heard down to here.
Chosen with recordings of people (`benchmarks.hearing.people_stops`, the half for tuning)."""
DOUBT = 0.88
"""The factor on the confidence of words that the second hearing does not confirm: a motion needs
a yes then."""


def is_sure(said: Transcript) -> bool:
    """Return whether these words were heard."""
    return bool(said.text) and said.confidence >= LISTEN_AGAIN_BELOW


def is_doubtful(said: Transcript, language: str) -> bool:
    """Return whether to transcribe again, without a prompt."""
    return language in SHOWN_COMMANDS and bool(said.text) and not is_sure(said)


def heard_for(hypotheses: Sequence[Segment], seconds: float) -> tuple[Hypothesis, ...]:
    """Return those that were said in so many seconds, each with its share of all."""
    shares = zip(hypotheses, _shares(hypotheses), strict=True)
    said = ((one, share) for one, share in shares if plausible(one, seconds))
    return tuple(Hypothesis(words_of(one.text), share, one.likelihood) for one, share in said)


def only_alone(one: Segment) -> float:
    """Rate a hypothesis without the prompt that the one with it does not confirm, 0 to 1.

    Never so sure that a motion needs no yes.
    """
    return min(one.likelihood, LISTEN_AGAIN_BELOW) * DOUBT


def heard_again(alone: Sequence[Segment]) -> Callable[[Segment], float]:
    """Return a function that rates a hypothesis by a second transcription, 0 to 1.

    `alone` holds the hypotheses of that transcription, which had no prompt. The rating is higher
    for a text among them, and lower for any other.
    """
    most = max((one.whole for one in alone), default=0.0)
    below: dict[str, float] = {}
    for one in alone:
        below.setdefault(plain_words(one.text), most - one.whole)

    def likelihood(one: Segment) -> float:
        away = below.get(plain_words(one.text), AWAY)
        if away <= NEAR:
            return math.sqrt(one.likelihood)
        return one.likelihood if away < AWAY else one.likelihood * DOUBT

    return likelihood
