"""The decider: is a sentence that no template knows an order, which one, and how surely?

`evidence` puts the signs for and against a reading into numbers, which a head weighs. `Readings`
reads a sentence and judges the reading; `Decider` adds the encoder's opinion.
"""

import itertools
import math
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from edgevox.agent.nlu.clauses import ClauseReading, find_names, find_place
from edgevox.agent.nlu.encoder import Floats, Head, SentenceReader
from edgevox.agent.nlu.lexicon import Lexicon, Words, is_mark, is_number
from edgevox.agent.nlu.meaning import ASK_FROM, SURE_FROM
from edgevox.agent.nlu.reading import CallReader, Reading
from edgevox.agent.nlu.remainder import is_denied_inside, is_left_over, is_unsaid
from edgevox.agent.phrases.load import ENGLISH
from edgevox.agent.phrases.numbers import digits, is_exact
from edgevox.agent.phrases.own_names import phrasebook_of
from edgevox.agent.skills import Call, Skill, SkillSet
from edgevox.agent.text.spelling import key

QUESTION_MARKS = "?\N{FULLWIDTH QUESTION MARK}\N{ARABIC QUESTION MARK}"
_MOST_DOUBTS = 4
_MOST_NAMED = 2
_SEVERAL = 2
_SPEAKS = 0.4
"""Least weight of a word that opens an order."""
_SAYS_SO = 0.6
"""Least weight of a skill's words that alone say that the skill is wanted.

In English any such word is enough: the head was trained on ten times as many English sentences.
"""


def evidence(reading: Reading, lexicon: Lexicon, text: str) -> Mapping[str, float]:
    """The evidence about a reading: numbers by name, in a fixed order."""
    parts, tokens = reading.parts, reading.tokens
    words = lexicon.function_words
    size = max(1, sum(not is_mark(token) for token in tokens))
    asking = bool(lexicon.index(words.asking).starts(tokens))
    wishing = bool(lexicon.index(words.wishes).starts(tokens))
    said = _SaidWords(lexicon, tokens, reading.courteous)
    asks = any(mark in text for mark in QUESTION_MARKS)
    return {
        "strange": reading.strange,
        "strange_inside": max(part.strange for part in parts),
        "strange_alone": max(part.strange * (part.grounded == 0) for part in parts),
        "strange_unfilled": max(part.strange * (part.unfilled > 0) for part in parts),
        "share_strange": reading.strange / size,
        "size": math.log(size),
        "parts": len(parts),
        "least_support": min(part.support for part in parts),
        "support": math.log1p(sum(part.support for part in parts)),
        "margin": min(part.support - part.rival for part in parts),
        "grounded": min(part.grounded for part in parts),
        "nearly": any(part.nearly for part in parts),
        "unitless": any(part.unitless for part in parts),
        "corrected": reading.corrected,
        "denied": reading.denied,
        "reports": said.count(words.reports) > 0,
        "conditions": min(said.count(words.conditions), 2),
        "doubts": min(said.count(words.doubts), _MOST_DOUBTS),
        "doubts_inside": min(said.count(words.doubts, reading.parts), _MOST_DOUBTS),
        "asks": asks and not asking,
        "opens_as_question": (said.opens(words.questions) and not asking)
        or (asks and said.count(words.questions) > 0),
        "doubted_first": said.opens((*words.doubts, *words.conditions)),
        "asking": asking,
        "wishing": wishing,
        "plans": said.count(words.plans) > 0,
        "urged": bool(lexicon.index(words.urges).starts(tokens)),
        "addressed": _addresses_another(reading, lexicon),
        "half_filled": any(part.unfilled > 0 and part.grounded > 0 for part in parts),
        "courteous": len(reading.courteous) > 0,
        "imperative": _is_imperative(reading, lexicon),
        "moves": all(lexicon.skills[part.call.skill].moves for part in parts),
        "elliptic": any(part.support <= 0 for part in parts),
        "unspaced": not lexicon.book.hearing.spaced,
    }


def is_denied(text: str, lexicon: Lexicon) -> bool:
    """True if a word of this language denies something in a sentence read in another language."""
    return bool(lexicon.index(lexicon.function_words.negations).starts(lexicon.tokenize(text)))


def is_doubted(reading: Reading, facts: Mapping[str, float], lexicon: Lexicon) -> bool:
    """True if the sentence may not want what was read.

    It tells something about a name ("the kitchen's over there"), a number goes on in an unknown
    word, nothing joins two orders, one of which may be taken back ("forward, back one metre"), or
    no word says that the skill is wanted.
    """
    joints = lexicon.index(tuple(lexicon.book.hearing.joints))
    if len(reading.parts) > 1 and not joints.starts(reading.tokens):
        return True
    wanted = any(facts[one] for one in ("urged", "asking", "wishing", "corrected"))
    if _is_told_of(reading.tokens, lexicon, wanted) or _names_another_way(reading, lexicon):
        return True
    if _goes_two_ways(reading, lexicon):
        return True
    pairs = itertools.pairwise(reading.tokens)
    if any(is_number(a) and b.isalpha() and not lexicon.knows(b) for a, b in pairs):
        return True
    return is_unsupported(reading, facts, lexicon) and not wanted


def _names_another_way(reading: Reading, lexicon: Lexicon) -> bool:
    """True if a drive to a place has a word of a motion by an amount: "vai indietro in cucina"."""
    skills = lexicon.skills
    ways = [words.weights for name, words in lexicon.words.items() if skills[name].relative]
    return any(
        lexicon.words[part.call.skill].weights.get(token, 0.0) < _SPEAKS
        and any(one.get(token, 0.0) >= _SPEAKS for one in ways)
        and not lexicon.in_a_name(token)
        for part in reading.parts
        if skills[part.call.skill].choices and skills[part.call.skill].drives
        for at, token in enumerate(reading.tokens[part.start : part.end], part.start)
        if at not in reading.courteous
    )


def _goes_two_ways(reading: Reading, lexicon: Lexicon) -> bool:
    """True if a motion by an amount has, behind a mark, a word of another one alone.

    "Forward, back one metre" may take the first word back.
    """
    moving = {name: one.weights for name, one in lexicon.words.items() if one.skill.relative}
    for part in reading.parts:
        own = moving.get(part.call.skill)
        marks = [at for at in range(part.start, part.end) if is_mark(reading.tokens[at])]
        for at in range(marks[0], part.end) if own is not None and marks else ():
            token = reading.tokens[at]
            others = any(token in one for name, one in moving.items() if name != part.call.skill)
            if own is not None and token not in own and others:
                return True
    return False


def _is_told_of(tokens: Words, lexicon: Lexicon, wanted: bool) -> bool:
    """True if a name stands beside a copula: "the dock is free", "over there's the dock".

    In a `wanted` sentence a name may follow the copula: "your next waypoint is the dock".
    """
    copulas, articles = lexicon.function_words.copulas, lexicon.book.hearing.articles
    for at, one in enumerate(tokens):
        if one not in copulas or lexicon.in_a_name(one):
            continue
        if at and lexicon.in_a_name(tokens[at - 1].removesuffix("'")):
            return True
        after = next((word for word in tokens[at + 1 :] if word not in articles), "")
        if not wanted and lexicon.in_a_name(after):
            return True
    return False


def is_unsupported(reading: Reading, facts: Mapping[str, float], lexicon: Lexicon) -> bool:
    """True if the words of the skills alone do not say that the skills are wanted."""
    if lexicon.book.code == ENGLISH:
        return facts["least_support"] <= 0
    return min(part.told for part in reading.parts) < _SAYS_SO


@dataclass(frozen=True, slots=True)
class _SaidWords:
    """The function words in a sentence, without those inside its courtesies."""

    lexicon: Lexicon
    tokens: Sequence[str]
    courteous: frozenset[int]

    def count(self, phrases: tuple[str, ...], parts: Sequence[ClauseReading] | None = None) -> int:
        """Number of these phrases in the sentence, anywhere or within these parts."""
        return len(
            {
                one
                for at, one in self._found(phrases)
                if parts is None or any(part.start <= at < part.end for part in parts)
            }
        )

    def opens(self, phrases: tuple[str, ...]) -> bool:
        """True if the sentence, or a part after a punctuation mark, begins with such a phrase."""
        starts = {0, *(at + 1 for at, token in enumerate(self.tokens) if is_mark(token))}
        return any(at in starts for at, _ in self._found(phrases))

    def _found(self, phrases: tuple[str, ...]) -> Iterator[tuple[int, Words]]:
        for at, one in self.lexicon.index(phrases).find(self.tokens):
            if not self.courteous.issuperset(range(at, at + len(one))):
                yield at, one


def _addresses_another(reading: Reading, lexicon: Lexicon) -> bool:
    """True if one or two unknown words stand alone between marks: "Lucy, go to the office"."""
    clauses: list[list[str]] = [[]]
    for token in reading.tokens:
        if is_mark(token):
            clauses.append([])
        else:
            clauses[-1].append(token)
    return len(clauses) > 1 and any(
        one and len(one) <= _MOST_NAMED and not any(map(lexicon.knows, one))
        for one in (clauses[0], clauses[-1])
    )


def _is_imperative(reading: Reading, lexicon: Lexicon) -> bool:
    """True if each part begins, after courtesies, with a word that speaks for its skill."""
    words = set(lexicon.function_words.fillers)
    for part in reading.parts:
        weights = lexicon.words[part.call.skill].weights
        opening = next(
            (
                token
                for at, token in enumerate(reading.tokens[part.start : part.end], part.start)
                if not is_mark(token)
                and at not in reading.courteous
                and (weights.get(token, 0.0) >= _SPEAKS or token not in words)
            ),
            "",
        )
        if weights.get(opening, 0.0) < _SPEAKS:
            return False
    return True


_SAYS_AN_ABILITY = 2.0
"""Least weight of the words for a motion that "can you ..." asks for, and not about."""

_NAMES = 0.25
"""Least weight of the words for a motion by an amount; small words of its templates have less."""

_LEAST_MARGIN = 0.25
"""Least lead in weight over another skill; with less, the words choose neither skill."""


_DOUBTFUL = (ASK_FROM + SURE_FROM) / 2
"""Highest confidence in a doubtful reading: it always asks."""


@dataclass(frozen=True, slots=True)
class Decision:
    """Calls that a sentence means."""

    calls: tuple[Call, ...]
    """The calls."""
    confidence: float
    """Confidence that they are meant, at least `ASK_FROM`."""

    @property
    def sure(self) -> bool:
        """True if they may be done without asking."""
        return self.confidence >= SURE_FROM


@dataclass(frozen=True, slots=True)
class Judged:
    """A reading with the facts for a decision about it."""

    reading: Reading
    """The reading."""
    evidence: Mapping[str, float]
    """The evidence about it."""
    held_back: bool
    """True if something forbids it, whatever its likelihood: see `_held_back`."""
    doubted: bool
    """True if the sentence may not want it: see `is_doubted`."""
    unsaid: bool
    """True if it rests on a name among unknown words: see `is_unsaid`."""
    loses: bool
    """True if it changes something for good, for which only a template is plain enough."""
    unsupported: bool
    """True if the words of the skills alone do not say that the skills are wanted."""


_OBJECTIONS = ("denied", "reports", "opens_as_question", "asks", "plans", "addressed")
"""Evidence that a sentence is no order to the robot, or not for now."""


_TOLD = ("reports", "opens_as_question", "plans", "doubts", "conditions")
"""Evidence that a sentence tells something, though it denies a motion."""


class Readings:
    """Reads and judges sentences for one set of skills, in one language and in English.

    Skills that only their templates ask for are left out.
    """

    def __init__(self, skills: SkillSet, language: str) -> None:
        self._skills = SkillSet(one for one in skills.values() if not one.plainly)
        self._language = language
        self._words: Any = None
        self._readers: list[tuple[Lexicon, CallReader]] = []

    def of(self, text: str) -> Judged | None:
        """The first reading of a sentence, in the spoken language or in English.

        None for a number that cannot be read as it is written: see `is_exact`.
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
                held_back = (
                    denied
                    or left
                    or _held_back(reading, facts)
                    or _is_about_another_thing(reading, lexicon)
                    or _asks_about_another(reading, lexicon)
                    or _is_hardly_named(reading, lexicon)
                )
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

    def whole(self, text: str, skills: Collection[str]) -> Call | None:
        """The text as one call of one of these skills, though its words may not say so.

        None if words deny, report, condition or change an order, or are left over.
        """
        if not is_exact(text, self._language):
            return None
        self._renew()
        plain = " ".join(text.split())
        for lexicon, reader in self._readers:
            reading = reader.whole(digits(plain, lexicon.book.code), skills)
            if reading is None or _unitless_one(reading):
                continue
            facts = evidence(reading, lexicon, text)
            against = any(facts[one] for one in (*_OBJECTIONS, "conditions", "opens_as_question"))
            left = self._is_left(reading, lexicon, plain, likely=True)
            guessed = reading.strange and not reading.calls[0].arguments
            if against or left or guessed or self._denies(plain):
                return None
            return reading.calls[0]
        return None

    def _denies(self, text: str) -> bool:
        """True if a word of the spoken language or of English denies something."""
        return any(is_denied(text, lexicon) for lexicon, _ in self._readers)

    @property
    def lexicon(self) -> Lexicon:
        """The words of the spoken language, with the present names."""
        self._renew()
        return self._readers[0][0]

    def says_little(self, text: str) -> bool:
        """True if the text has words for a small amount: "a bit", but not that of "in a bit"."""
        lexicon, tokens = self.lexicon, self.lexicon.tokenize(" ".join(text.split()))
        words = lexicon.function_words
        longer = [
            range(at, at + len(one))
            for at, one in lexicon.index((*words.fillers, *words.put_off)).find(tokens)
        ]
        for at, one in lexicon.index(words.little).find(tokens):
            inside = any(at in other and len(other) > len(one) for other in longer)
            after = next(iter(tokens[at + len(one) :]), "")
            if not inside and (not after.isalpha() or lexicon.knows(after)):
                return True  # "a little", but not that of "a little circle"
        return False

    def knows(self, text: str) -> bool:
        """True if each word of a text, small ones aside, is used for a motion of these skills."""
        self._renew()
        lexicon, _ = self._readers[0]
        tokens = _tokens(" ".join(text.split()), lexicon)
        small = lexicon.index(lexicon.function_words.all()).places(tokens)
        said = [one for at, one in enumerate(tokens) if at not in small and not is_mark(one)]
        moving = [one for one in lexicon.skills.values() if one.moves]
        known = {word for one in moving for word in lexicon.tokenize(lexicon.book.can(one))}
        known |= {
            word
            for one in moving
            for word, weight in lexicon.words[one.name].weights.items()
            if weight >= _SPEAKS
        }
        return bool(moving) and known.issuperset(said)

    def objections(self, text: str) -> frozenset[str]:
        """What speaks against doing what these words name; empty if nothing does.

        That is evidence by its name, and words that deny, tell or put off something. Numbers,
        articles and marks do not count: this is to compare what was heard with a sentence.
        """
        self._renew()
        articles = self._readers[0][0].book.hearing.articles
        text = " ".join(one for one in key(text).split() if one not in articles)
        judged = self.of(text)
        facts = judged.evidence if judged else {}
        found = {name for name in _OBJECTIONS if facts.get(name)}
        for lexicon, _ in self._readers:
            words, answers = lexicon.function_words, lexicon.book.answers
            against = (
                *words.negations, *words.corrections, *words.reports, *words.conditions,
                *words.reversals, *words.plans, *answers.no, *answers.not_,
            )  # fmt: skip
            tokens = _tokens(text, lexicon)
            found |= {" ".join(one) for _, one in lexicon.as_written(against).find(tokens)}
        plain = digits(text, self._language).split()
        if self.hold_back(" ".join(one for one in plain if not one.isdigit())):
            found.add("changed")
        return frozenset(found)

    def is_aside(self, text: str, *, may_deny: bool) -> bool:
        """True if no word of a clause counts, names, conditions, corrects or puts off anything.

        A clause that `may_deny` may hold a denial, but no word of a motion then.
        """
        self._renew()
        for lexicon, _ in self._readers:
            words, answers = lexicon.function_words, lexicon.book.answers
            against = (
                *words.conditions, *words.reversals, *words.put_off, *words.reports, *words.bounds,
            )  # fmt: skip
            denying = (*words.negations, *answers.not_, *answers.no)
            tokens = _tokens(" ".join(text.split()), lexicon)
            if any(map(is_number, tokens)) or find_names(lexicon, tokens):
                return False
            if next(lexicon.as_written(against).find(tokens), None):
                return False
            if lexicon.index(words.corrections).starts(tokens) & {0, 1}:
                return False
            denied = bool(lexicon.index(denying).starts(tokens))
            if denied and not (may_deny and not _moves(tokens, lexicon)):
                return False
        return True

    def is_filler(self, text: str) -> bool:
        """True if each word of a text may as well be left out."""
        lexicon = self.lexicon
        words, tokens = lexicon.function_words, _tokens(" ".join(text.split()), lexicon)
        filling = (*words.fillers, *words.urges, *words.results, *lexicon.book.hearing.joints)
        return lexicon.index(filling).places(tokens).issuperset(range(len(tokens)))

    def hold_back(self, text: str) -> bool:
        """True if these words hold something that changes or denies an order."""
        self._renew()
        plain = " ".join(text.split())
        return not is_exact(text, self._language) or any(
            is_denied_inside(plain, lexicon)
            or is_left_over(_tokens(plain, lexicon), lexicon, denials=True)
            for lexicon, _ in self._readers
        )

    def named(self, text: str) -> Call | None:
        """The one motion by an amount that these words name, and nothing beside, or None."""
        judged = self.of(text)
        alone = judged is not None and not judged.held_back and not judged.reading.strange
        return self._amount(judged) if judged and alone else None

    def denied(self, text: str) -> Call | None:
        """The one motion by an amount that these words deny, and nothing beside, or None."""
        judged = self.of(text)
        if judged is None or not judged.reading.denied or any(map(judged.evidence.get, _TOLD)):
            return None
        for lexicon, _ in self._readers:
            words = lexicon.function_words
            tokens = _tokens(" ".join(text.split()), lexicon)
            denials = lexicon.index(words.negations).places(tokens)
            if not denials or lexicon.index(words.talking).starts(tokens):
                continue
            if judged.reading.strange <= len(denials):
                return self._amount(judged)
        return None

    def _amount(self, judged: Judged) -> Call | None:
        """The one motion by an amount of a reading, if more than courtesies names it, and is said.

        "Not right now" denies no turn to the right.
        """
        reading = judged.reading
        if len(reading.parts) != 1 or not self._skills[reading.calls[0].skill].relative:
            return None
        for lexicon, _ in self._readers:
            words = lexicon.function_words
            long = (one for one in (*words.fillers, *words.urges) if len(lexicon.phrase(one)) > 1)
            courteous = lexicon.index(tuple(long)).places(reading.tokens)
            weights = lexicon.words[reading.calls[0].skill].weights
            speaks = any(
                weights.get(one, 0.0) >= _SPEAKS and at not in courteous
                for at, one in enumerate(reading.tokens)
            )
            if speaks and not is_left_over(reading.tokens, lexicon, reading.parts):
                return reading.calls[0]
        return None

    def unknown_place(self, text: str) -> tuple[Skill, str, str] | None:
        """A drive, its argument, and the usual place in these words that it does not know.

        None for words that deny something or that no drive has.
        """
        self._renew()
        lexicon, _ = self._readers[0]
        words, tokens = lexicon.function_words, _tokens(" ".join(text.split()), lexicon)
        said = find_place(tokens, lexicon)
        if not said or lexicon.index(words.negations).starts(tokens):
            return None
        wished = bool(lexicon.index(words.wishes).starts(tokens))
        for one in lexicon.skills.values():
            weights = lexicon.words[one.name].weights
            if one.drives and one.choices and (wished or not weights.keys().isdisjoint(tokens)):
                return one, next(iter(one.choices)), said
        return None

    def _is_left(
        self, reading: Reading, lexicon: Lexicon, text: str, *, likely: bool = False
    ) -> bool:
        """True if a reading that acts leaves out words that change or deny the order.

        An English reading is checked for words of the spoken language as well.
        """
        skills = [lexicon.skills[call.skill] for call in reading.calls]
        if not any(one.drives or one.lasting for one in skills):
            return False
        if is_left_over(reading.tokens, lexicon, reading.parts, likely=likely):
            return True
        if is_denied_inside(text, lexicon) and not reading.corrected:
            return True
        spoken = self._readers[0][0]
        tokens = _tokens(text, spoken)
        return lexicon is not spoken and is_left_over(tokens, spoken, reading.parts, likely=likely)

    def _renew(self) -> None:
        """Rebuild the readers if the words of arguments have changed: places are learned."""
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
    """Judges readings with the encoder and the head. Used from one thread."""

    def __init__(self, encoder: SentenceReader, head: Head) -> None:
        self._encoder = encoder
        self._head = head
        self._last: tuple[str, Floats] | None = None

    def decide(self, judged: Judged | None, text: str) -> Decision | None:
        """The calls to do or to ask about; None if the sentence is no order."""
        if judged is None or judged.held_back or judged.unsaid:
            return None
        order = self._order(text)
        confidence = self._head.confidence(self._head.likelihood(order, judged.evidence))
        if _is_doubtful(judged, order):
            confidence = min(confidence, _DOUBTFUL)
        return Decision(judged.reading.calls, confidence) if confidence >= ASK_FROM else None

    def is_order(self, text: str) -> bool:
        """True if the sentence is an order to the hearer, of any content."""
        return self._order(text) > 0

    def is_general(self, text: str) -> bool:
        """True if general knowledge answers it: it asks about nothing here and now, nor about the
        speaker or the robot.
        """
        return self._head.general(self._features(text)) > 0

    def asked(self, text: str) -> tuple[str, float]:
        """What a robot is most likely asked to do by these words alone, and how likely it is."""
        return self._head.asked(self._features(text))

    def small_talk(self, text: str) -> tuple[str, float]:
        """The kind of small talk that the sentence most likely is, and how likely it is.

        See `say.talk_*` of a language.
        """
        return self._head.small_talk(self._features(text))

    def _order(self, text: str) -> float:
        """The order logit of a sentence."""
        return self._head.order(self._features(text))

    def _features(self, text: str) -> Floats:
        """The encoder's features; the last are kept, since several callers ask for them."""
        if self._last is None or self._last[0] != text:
            self._last = text, self._encoder.features(text)
        return self._last[1]


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


def _is_about_another_thing(reading: Reading, lexicon: Lexicon) -> bool:
    """True if a motion by an amount has no amount, and several unknown words instead.

    "Grab the cup on the left of the plate" is no turn to the left.
    """
    return any(
        part.strange >= _SEVERAL and not part.grounded
        for part in reading.parts
        if lexicon.skills[part.call.skill].relative
    )


def _is_hardly_named(reading: Reading, lexicon: Lexicon) -> bool:
    """True if nothing but an amount and a small word is said for a motion by an amount.

    "Up two metres" has only the "up" of "back up two metres".
    """
    return any(
        part.support < _NAMES for part in reading.parts if lexicon.skills[part.call.skill].relative
    )


def _asks_about_another(reading: Reading, lexicon: Lexicon) -> bool:
    """True if the words ask about an ability that the skills' words hardly name.

    "Can you walk" asks no arm to go home.
    """
    asks = lexicon.index(lexicon.function_words.abilities).starts(reading.tokens)
    return bool(asks) and any(
        (not part.grounded or part.guessed)
        and (part.strange > 0 or part.support < _SAYS_AN_ABILITY)
        for part in reading.parts
        if lexicon.skills[part.call.skill].moves
    )


def _moves(tokens: Words, lexicon: Lexicon) -> bool:
    """True if a word speaks for a motion."""
    moving = [one for name, one in lexicon.words.items() if lexicon.skills[name].drives]
    return any(one.weights.get(token, 0.0) >= _SPEAKS for one in moving for token in tokens)


def _unitless_one(reading: Reading) -> bool:
    return any(one.unitless and 1.0 in one.call.arguments.values() for one in reading.parts)


def _held_back(reading: Reading, facts: Mapping[str, float]) -> bool:
    """True if something forbids the reading, whatever its likelihood.

    That is a denial; an unknown word where a value is missing; a "one" without a unit, which may
    stand for a thing ("the nearer one"); before a motion a report, a question or an unread part;
    and words that speak for two skills alike.
    """
    if _unitless_one(reading):
        return True
    if facts["denied"] or facts["strange_unfilled"] or (facts["moves"] and reading.unread):
        return True
    if facts["moves"] and (facts["opens_as_question"] or facts["reports"]):
        return True
    return any(
        part.rival > 0 and part.support - part.rival < _LEAST_MARGIN for part in reading.parts
    )
