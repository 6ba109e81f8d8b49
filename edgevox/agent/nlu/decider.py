"""The decider: is a sentence that no template knows an order, which one, and how surely?

`Decider` weighs the evidence about a reading with the encoder's opinion.
"""

from dataclasses import dataclass

from edgevox.agent.nlu.encoder import Floats, SentenceReader
from edgevox.agent.nlu.head import Head
from edgevox.agent.nlu.judging import Judged
from edgevox.agent.nlu.meaning import ASK_FROM, SURE_FROM
from edgevox.agent.skills import Call

_MOST_READ = 128
"""Number of texts whose features a decider keeps: those of a few sentences and their clauses."""

NOT_NOW, PERHAPS_NOT_NOW, LIKELY_NOW = 0.05, 0.3, 0.5
"""Likelihoods of an order for now below which it is neither done nor asked about, below which what
hardly says a motion is none, and from which on it may be done at once."""

NOW, LEAVES, DENIED, OTHERS = "now", "leave", "denied", "others"
"""The kinds of words for now, of those that want the robot out of a place, of denials, and of what
is said to somebody else.
"""

TALK = "talk"
"""The kind of words that ask for nothing."""

LIKELY_TALK, PLAINLY_TALK = 0.5, 0.85
"""Least likelihood of a remark beside an order, and of one alone."""

PUT_OFF = ("condition", "later", "taken_back")
"""The kinds of words that put an order off or take it back."""

LIKELY_PUT_OFF = 0.5
"""Least likelihood of such words beside an order."""

LIKELY_LEFT, LIKELY_OTHERS = 0.5, 0.3
"""Least likelihood of words that want the robot out of a place, and of those to somebody else."""

LIKELY_DENIED, PLAINLY_DENIED = 0.7, 0.9
"""Least likelihood of a denial of a motion, and of one that names none."""

_DOUBTFUL = (ASK_FROM + SURE_FROM) / 2
"""Highest confidence in a doubtful reading: it always asks."""


@dataclass(frozen=True, slots=True)
class Decision:
    """Calls that a sentence means."""

    calls: tuple[Call, ...]
    """The calls."""
    confidence: float
    """Confidence that they are meant, at least `ASK_FROM`."""
    doubtful: bool = False
    """True if they must be asked about, however likely they are."""

    @property
    def sure(self) -> bool:
        """True if they may be done without asking."""
        return self.confidence >= SURE_FROM


class Decider:
    """Judges readings with the encoder and the head. Used from one thread."""

    def __init__(self, encoder: SentenceReader, head: Head) -> None:
        self._encoder = encoder
        self._head = head
        self._read: dict[str, Floats] = {}

    def decide(self, judged: Judged | None, text: str) -> Decision | None:
        """The calls to do or to ask about; None if the sentence is no order."""
        if judged is None or judged.held_back or judged.unsaid:
            return None
        order = self._order(text)
        confidence = self._head.confidence(self._head.likelihood(order, judged.evidence))
        now = self.for_now(text) if judged.evidence["moves"] else 1.0
        if now < NOT_NOW:
            return None
        talks = bool(judged.evidence["moves"]) and order < 0 and self._is_talk(text)
        if doubtful := _is_doubtful(judged, order) or now < LIKELY_NOW or talks:
            confidence = min(confidence, _DOUBTFUL)
        if confidence < ASK_FROM:
            return None
        return Decision(judged.reading.calls, confidence, doubtful)

    def _is_talk(self, text: str) -> bool:
        kind, likely = self.asked(text)
        return kind == TALK and likely >= PLAINLY_TALK

    def is_order(self, text: str) -> bool:
        """True if the sentence is an order to the hearer, of any content."""
        return self._order(text) > 0

    def for_now(self, text: str) -> float:
        """Likelihood of words about a motion to want it now, and of this robot.

        Others set a condition, put it off, take it back, deny, report or ask about it, want the
        robot to leave a place, or are said to somebody else.
        """
        return self._head.meant.likelihood(NOW, self._features(text))

    def leaves(self, text: str) -> bool:
        """True if the words, a sentence or a clause, most likely want the robot out of a place."""
        written = text.rstrip(" .!") + "."  # as the head has learned them
        kind, likely = self._head.meant.likeliest(self._features(written))
        return kind == LEAVES and likely >= LIKELY_LEFT

    def puts_off(self, text: str) -> bool:
        """True if a clause most likely puts off what is ordered beside it, or takes it back."""
        features = self._features(text)
        return sum(self._head.meant.likelihood(o, features) for o in PUT_OFF) >= LIKELY_PUT_OFF

    def for_others(self, text: str) -> bool:
        """True if words may well be said to, or of, somebody else who is to move."""
        return self._head.meant.likelihood(OTHERS, self._features(text)) >= LIKELY_OTHERS

    def denied(self, text: str) -> float:
        """Likelihood of words about a motion not to want it."""
        return self._head.meant.likelihood(DENIED, self._features(text))

    def is_general(self, text: str) -> bool:
        """True if general knowledge answers it: it asks about nothing here and now, nor about the
        speaker or the robot.
        """
        return self._head.general(self._features(text)) > 0

    def asked(self, text: str) -> tuple[str, float]:
        """What a robot is most likely asked to do by these words alone, and how likely it is."""
        return self._head.asked.likeliest(self._features(text))

    def told(self, text: str) -> tuple[str, float]:
        """The skill that tells what a sentence most likely asks the robot, and how likely it is.

        It is "none" for any other sentence.
        """
        return self._head.told.likeliest(self._features(text))

    def small_talk(self, text: str) -> tuple[str, float]:
        """The kind of small talk that the sentence most likely is, and how likely it is.

        See `say.talk_*` of a language.
        """
        return self._head.talk.likeliest(self._features(text), first=1)

    def _order(self, text: str) -> float:
        """The order logit of a sentence."""
        return self._head.order(self._features(text))

    def _features(self, text: str) -> Floats:
        """The encoder's features; a few are kept, since several callers ask for a sentence's."""
        if text not in self._read:
            if len(self._read) >= _MOST_READ:
                del self._read[next(iter(self._read))]
            self._read[text] = self._encoder.features(text)
        return self._read[text]


def _is_doubtful(judged: Judged, order: float) -> bool:
    """True if the robot must ask, however likely the reading is.

    Either not all words were understood; or it is a motion that no word wants, or the sentence may
    address another person or tell who else will move.
    """
    facts = judged.evidence
    guessed = any(part.guessed for part in judged.reading.parts)
    if facts["strange_alone"] or guessed or judged.loses or judged.reading.ambiguous:
        return True
    if not facts["moves"]:
        return False
    unwanted = judged.doubted or (order < 0 and judged.unsupported)
    unread = facts["strange_inside"] or facts["half_filled"]
    return bool(unwanted or unread or facts["asks"] or facts["plans"] or facts["addressed"])
