"""What words say that come after the robot's own: do they count, answer, choose, or encourage?"""

from collections.abc import Sequence
from dataclasses import replace

from edgevox.agent.dialogue.acts import Answer, Answers
from edgevox.agent.dialogue.corrections import Corrections
from edgevox.agent.dialogue.performer import Performer
from edgevox.agent.dialogue.question import OpenQuestion
from edgevox.agent.nlu.disfluencies import is_back_channel
from edgevox.agent.nlu.interpreter import Interpreter
from edgevox.agent.nlu.meaning import HEARD_FROM, Meaning
from edgevox.agent.stop.words import find_stop_word
from edgevox.core.commands import Heard, Hypothesis, Rate
from edgevox.core.languages import STOP_WORDS

YES_FROM = 0.6
"""Recognition confidence below which the robot asks again after a spoken yes, so that no guessed
yes moves it. Of 58 yeses by the tuning voices, in quiet and in noise, 55 were surer."""

FOLLOWS_FROM, ANSWERS_FROM, DENIES_FROM = 0.6, 0.4, 0.3
"""Recognition confidence from which words without the wake word count: orders and corrections, a
yes to its question, about which it asks again below `YES_FROM`, and a no, which moves nothing."""

_MAY_ANSWER, _DOUBTED = 0.05, YES_FROM - 0.1
"""The share of an answer among the other hypotheses from which on it counts, and how surely heard
it is at most: a yes is asked for again, and a correction asked about."""

_USUAL_STOPS, _USUAL_BACK_CHANNELS, _FAR_MORE_LIKE = 3, 8, 2.0
"""Words of each kind that are rated by the sound, and by how much more likely, in nats, one that
encourages must be. Of 22 stop words by the tuning voices over the robot's own, one sounded so much
like another; it was spotted, and surely heard."""

_FEW_WORDS, _LETTERS = 3, 2
"""So many words may be a mumble; in a script without spaces, of so many characters each."""


class Replies:
    """Reads what a person replies, and changes nothing. Any thread may use it."""

    def __init__(
        self,
        interpreter: Interpreter,
        performer: Performer,
        question: OpenQuestion,
        corrections: Corrections,
    ) -> None:
        self._interpreter = interpreter
        self._performer = performer
        self._question = question
        self._corrections = corrections

    @property
    def _answers(self) -> Answers:
        return self._corrections.answers

    def follows(self, heard: Heard) -> bool:
        """True if these words answer the robot, correct it or are a plain command.

        While it counts down, any words do, and after its question a few that may be an answer. A
        lone "yes" or "no" is short, and is heard less surely than an order.
        """
        text, hearing = heard.text, heard.confidence
        if self._question.counts_down or self.misheard(text, heard.others):
            return True
        answer = self._answers.read(text)
        if answer is not None and self._question.asked:
            return hearing >= (ANSWERS_FROM if answer is Answer.YES else DENIES_FROM)
        if hearing < FOLLOWS_FROM:
            return False
        if answer is Answer.NO and self._performer.moving:
            return True
        if self.chosen(text) or self._corrections.bare(text):
            return True
        matters = self._question.asked or self._performer.moving
        if self._corrections.of(text) or (matters and self._corrections.denies(text)):
            return True
        plain = self._interpreter.plain(text)
        return isinstance(plain, Meaning) and plain.sure

    def misheard(self, text: str, others: Sequence[Hypothesis]) -> Hypothesis | None:
        """The reply to its question that a few words without a meaning may have been, or None.

        It is heard in doubt: a yes is asked for again, and a correction asked about.
        """
        if not (self._question.asked and self._is_short(text) and self._means_nothing(text)):
            return None
        for one in others:
            if one.share >= _MAY_ANSWER and (
                self._answers.read(one.text) or self._corrections.of(one.text)
            ):
                return replace(one, confidence=min(one.confidence, _DOUBTED))
        return None

    def encourages(self, text: str, hearing: float, rate: Rate | None = None) -> bool:
        """True if words over the robot's speech want it to go on: "mm-hm", laughter.

        A few words that were hardly heard are taken for such if they mean nothing to it (Whisper
        writes "shore" for "sure"), or if the sound is far more like a word that encourages: Whisper
        expects stop words, and writes "halt" for "uh-huh".
        `hearing` is how surely they were heard, from 0 to 1, and `rate` rates texts by the sound.
        """
        if self._question.asked:
            return False
        if self.urges(text):
            return True
        if hearing >= HEARD_FROM or not self._is_short(text):
            return False
        if self._means_nothing(text) and not self._answers.may_correct(text):
            return True
        return rate is not None and self._sounds_encouraging(text, rate)

    def _is_short(self, text: str) -> bool:
        spaced = self._interpreter.phrases.hearing.spaced
        return (len(text.split()) if spaced else len(text) / _LETTERS) <= _FEW_WORDS

    def _means_nothing(self, text: str) -> bool:
        """True for words that are no answer, no correction, no plain command and no stop."""
        return (
            self._answers.read(text) is None
            and self._corrections.of(text) is None
            and self._interpreter.plain(text) is None
            and find_stop_word(self._interpreter.phrases.code, text) is None
        )

    def _sounds_encouraging(self, text: str, rate: Rate) -> bool:
        """True if the sound is far more like an encouragement than like these words or a stop."""
        book = self._interpreter.phrases
        stops = STOP_WORDS[book.code].anywhere[:_USUAL_STOPS]
        listens = book.hearing.back_channels[:_USUAL_BACK_CHANNELS]
        rated = rate([text, *(f"{one.capitalize()}." for one in (*stops, *listens))])
        others = 1 + len(stops)
        return max(rated[others:]) >= max(rated[:others]) + _FAR_MORE_LIKE

    def urges(self, text: str) -> bool:
        """True for a yes and for "mm-hm"."""
        said_yes = self._answers.read(text) is Answer.YES
        return said_yes or is_back_channel(text, self._interpreter.phrases.code)

    def chosen(self, text: str) -> Meaning | None:
        """The one of several meanings that an answer to the open question chooses, or None."""
        asked = self._question.asked
        if asked is None or not asked.others:
            return None
        chosen = self._answers.chosen(text, asked.sentences)
        return None if chosen is None else (asked.meaning, *asked.others)[chosen]
