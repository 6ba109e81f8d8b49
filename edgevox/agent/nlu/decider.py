"""Decides whether a sentence that no template knows is an order, which, and how sure that is."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from edgevox.agent.nlu.confidence import ASK_FROM, SURE_FROM, Head
from edgevox.agent.nlu.encoder import SentenceReader
from edgevox.agent.nlu.evidence import evidence, is_denied, is_doubted, is_unsupported
from edgevox.agent.nlu.lexicon import Lexicon
from edgevox.agent.nlu.readings import CallReader, Reading
from edgevox.agent.nlu.remainder import is_denied_inside, is_left_over, is_unsaid
from edgevox.agent.nlu.tokens import Words
from edgevox.agent.numbers import digits, is_exact
from edgevox.agent.own_names import phrasebook_of
from edgevox.agent.phrase_file import ENGLISH
from edgevox.agent.skills import Call, SkillSet

_LEAST_MARGIN = 0.25
"""Words that speak as much for another skill as for the one that was read choose neither."""


_DOUBTFUL = (ASK_FROM + SURE_FROM) / 2
"""At most so sure is a motion of which not all was understood."""


@dataclass(frozen=True, slots=True)
class Decision:
    """Calls with the confidence that they are meant: at least `ASK_FROM`."""

    calls: tuple[Call, ...]
    confidence: float

    @property
    def sure(self) -> bool:
        """Whether to do it without asking."""
        return self.confidence >= SURE_FROM


@dataclass(frozen=True, slots=True)
class Judged:
    """A reading with what a decision about it rests on."""

    reading: Reading
    evidence: Mapping[str, float]
    held_back: bool
    doubted: bool
    """No word says that it is wanted, or a number may go on in a word that nobody knows."""
    unsaid: bool
    """It rests on a name among words that nobody knows: see `is_unsaid`."""
    loses: bool
    """Something would last or be let go of, for which only a template is plain enough."""
    unsupported: bool
    """The words of the skills alone do not say that they are wanted."""


class Readings:
    """The readings of sentences for one set of skills in one language, each with its evidence."""

    def __init__(self, skills: SkillSet, language: str) -> None:
        self._skills = skills
        self._language = language
        self._words: Any = None
        self._readers: list[tuple[Lexicon, CallReader]] = []

    def of(self, text: str) -> Judged | None:
        """The first reading of a sentence, in the language spoken or in English.

        None where a number is written so that none can be read: see `is_exact`.
        """
        if not is_exact(text, self._language):
            return None
        self._renew()
        plain = " ".join(text.split())
        for lexicon, reader in self._readers:
            reading = reader.read(digits(plain, lexicon.book.code))
            if reading is not None:
                facts = evidence(reading, lexicon, text)
                spoken = self._readers[0][0]
                denied = lexicon is not spoken and is_denied(plain, spoken)
                left = self._is_left(reading, lexicon, plain)
                held_back = denied or left or _held_back(reading, facts)
                return Judged(
                    reading,
                    facts,
                    held_back,
                    doubted=is_doubted(reading, facts, lexicon),
                    unsaid=is_unsaid(reading.parts, lexicon),
                    loses=any(lexicon.skills[one.skill].lasting for one in reading.calls),
                    unsupported=is_unsupported(reading, facts, lexicon),
                )
        return None

    def hold_back(self, text: str) -> bool:
        """Whether these words say something that changes an order, whatever else they say."""
        self._renew()
        plain = " ".join(text.split())
        return not is_exact(text, self._language) or any(
            is_denied_inside(plain, lexicon)
            or is_left_over(_tokens(plain, lexicon), lexicon, denials=True)
            for lexicon, _ in self._readers
        )

    def _is_left(self, reading: Reading, lexicon: Lexicon, text: str) -> bool:
        """Whether a reading that would do something leaves out what changes it.

        English ones are words of the language spoken, too.
        """
        skills = [lexicon.skills[call.skill] for call in reading.calls]
        if not any(one.drives or one.lasting for one in skills):
            return False
        if is_left_over(reading.tokens, lexicon, reading.parts):
            return True
        if is_denied_inside(text, lexicon) and not reading.corrected:
            return True
        spoken = self._readers[0][0]
        return lexicon is not spoken and is_left_over(_tokens(text, spoken), spoken, reading.parts)

    def _renew(self) -> None:
        """The words of arguments may change while the robot runs: places are remembered."""
        words = self._skills.words()
        if words != self._words:
            codes = dict.fromkeys((self._language, ENGLISH))
            lexicons = [
                Lexicon(self._skills, phrasebook_of(code, self._skills.values())) for code in codes
            ]
            self._readers = [(lexicon, CallReader(lexicon)) for lexicon in lexicons]
            self._words = words


def _tokens(text: str, lexicon: Lexicon) -> Words:
    return lexicon.tokenize(digits(text, lexicon.book.code))


class Decider:
    """Judges readings by what an encoder makes of the sentence. Used from one thread."""

    def __init__(self, encoder: SentenceReader, head: Head) -> None:
        self._encoder = encoder
        self._head = head
        self._last: tuple[str, float] | None = None

    def decide(self, judged: Judged | None, text: str) -> Decision | None:
        """What to do, or to ask whether to; None where nobody asks for anything."""
        if judged is None or judged.held_back or judged.unsaid:
            return None
        order = self._order(text)
        confidence = self._head.confidence(self._head.likelihood(order, judged.evidence))
        if _is_doubtful(judged, order):
            confidence = min(confidence, _DOUBTFUL)
        return Decision(judged.reading.calls, confidence) if confidence >= ASK_FROM else None

    def is_order(self, text: str) -> bool:
        """Whether the speaker wants something of whoever hears it, whatever it is."""
        return self._order(text) > 0

    def _order(self, text: str) -> float:
        """The logit of a sentence, which each agent and then the model's grammar ask for."""
        if self._last is None or self._last[0] != text:
            self._last = text, self._head.order(self._encoder.features(text))
        return self._last[1]


def _is_doubtful(judged: Judged, order: float) -> bool:
    """Whether to ask however likely it is.

    Not all of it was understood or, of a motion, no word says that it is wanted, or somebody else
    is spoken to or will move.
    """
    facts = judged.evidence
    guessed = any(part.guessed for part in judged.reading.parts)
    if facts["strange_alone"] or guessed or judged.loses:
        return True
    if not facts["moves"]:
        return False
    unwanted = judged.doubted or (order < 0 and judged.unsupported)
    unread = facts["strange_inside"] or facts["half_filled"]
    return bool(unwanted or unread or facts["asks"] or facts["plans"] or facts["addressed"])


def _held_back(reading: Reading, facts: Mapping[str, float]) -> bool:
    """What no likelihood outweighs.

    That is a denial, a report, a question, a word that nobody knows where a value is missing, and
    words that speak for two skills alike.
    """
    if facts["denied"] or facts["strange_unfilled"] or (facts["moves"] and reading.unread):
        return True
    if facts["moves"] and (facts["opens_as_question"] or facts["reports"]):
        return True
    return any(
        part.rival > 0 and part.support - part.rival < _LEAST_MARGIN for part in reading.parts
    )
