"""Readings of sentences, judged: is there evidence that one is no order, or another one?

`Readings` reads a sentence for one set of skills, and tells what stands in it beside.
"""

import threading
from collections.abc import Collection, Mapping, Set
from dataclasses import dataclass
from typing import Any

from edgevox.agent.nlu.clauses import find_names, find_place
from edgevox.agent.nlu.evidence import (
    evidence,
    is_denied,
    is_doubted,
    is_unsupported,
)
from edgevox.agent.nlu.lexicon import Lexicon, Words, is_mark, is_number
from edgevox.agent.nlu.reading import CallReader, Reading
from edgevox.agent.nlu.remainder import (
    SPEAKS,
    is_denied_inside,
    is_left_over,
    is_unsaid,
    speaks_of_motion,
)
from edgevox.agent.phrases.load import ENGLISH
from edgevox.agent.phrases.numbers import digits, is_exact
from edgevox.agent.phrases.own_names import phrasebook_of
from edgevox.agent.skills import Call, Skill, SkillSet
from edgevox.agent.text.spelling import key

_SAYS_AN_ABILITY = 2.0
"""Least weight of the words for a motion that "can you ..." asks for, and not about."""

_SEVERAL = 2

_NAMES = 0.25
"""Least weight of the words for a motion by an amount; small words of its templates have less."""

_NAMES_ANOTHER = 2.0
"""Weight of a word that only one motion by an amount has: "left"."""

_LEAST_MARGIN = 0.25
"""Least lead in weight over another skill; with less, the words choose neither skill."""


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
        self._lock = threading.Lock()
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

    def whole(self, text: str, skills: Collection[str], *, plainly: bool = False) -> Call | None:
        """The text as one call of one of these skills, though its words may not say so.

        None if words deny, report, condition or change an order, or are left over. Unknown words
        without an argument count only if something else `plainly` tells the skill.
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
            against = any(facts[one] for one in (*_OBJECTIONS, "conditions"))
            left = self._is_left(reading, lexicon, plain, likely=True)
            unfilled = any(one.unfilled for one in reading.parts)
            bare = not (reading.calls[0].arguments or plainly)
            guessed = reading.strange and (bare or unfilled)
            another = _names_another_motion(reading, lexicon)
            if against or left or guessed or another or self._denies(plain):
                return None
            return reading.calls[0]
        return None

    def _denies(self, text: str) -> bool:
        """True if a word of the spoken language or of English denies something."""
        return any(is_denied(text, lexicon) for lexicon, _ in self._readers)

    @property
    def skills(self) -> Set[str]:
        """The names of the skills."""
        return self._skills.keys()

    @property
    def lexicon(self) -> Lexicon:
        """The words of the spoken language, with the present names."""
        self._renew()
        return self._readers[0][0]

    def says_little(self, text: str) -> bool:
        """True if the text has words for a small amount: "a bit", but not that of "in a bit"."""
        return self.without_little(text) is not None

    def without_little(self, text: str) -> str | None:
        """The words of a text without those for a small amount; None if it has none."""
        lexicon, tokens = self.lexicon, self.lexicon.tokenize(" ".join(text.split()))
        words = lexicon.function_words
        for one in lexicon.outside(words.little, (*words.fillers, *words.put_off), tokens):
            after = next(iter(tokens[one.stop :]), "")
            if not after.isalpha() or lexicon.knows(after):  # no "a little" of "a little circle"
                space = " " if lexicon.book.hearing.spaced else ""
                return space.join((*tokens[: one.start], *tokens[one.stop :]))
        return None

    def knows(self, text: str) -> bool:
        """True if each word of a text, small ones aside, is used for a motion of these skills."""
        self._renew()
        lexicon, _ = self._readers[0]
        tokens = _tokens(text, lexicon)
        small = lexicon.index(lexicon.function_words.all()).places(tokens)
        said = [one for at, one in enumerate(tokens) if at not in small and not is_mark(one)]
        moving = [one for one in lexicon.skills.values() if one.moves]
        known = {word for one in moving for word in lexicon.tokenize(lexicon.book.can(one))}
        known |= {
            word
            for one in moving
            for word, weight in lexicon.words[one.name].weights.items()
            if weight >= SPEAKS
        }
        return bool(moving) and known.issuperset(said)

    def objects(self, text: str) -> bool:
        """True if the reading of a text says that it is no order to the robot, or not for now."""
        judged = self.of(text)
        return judged is not None and any(judged.evidence[one] for one in _OBJECTIONS)

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

    def is_aside(self, text: str, *, may_deny: bool, opens: bool, plainly: bool = False) -> bool:
        """True if no word of a clause counts, names, conditions, corrects or puts off anything.

        A clause that `may_deny` may hold a denial, but no word of a motion then. One that `opens`
        a text has nothing before it to correct: "sorry, ...". One that is `plainly` talk may name
        and deny ("I was in the kitchen"), tell of later ("I leave in a minute"), and report unless
        it opens: "Anna said, ...".
        """
        self._renew()
        for lexicon, _ in self._readers:
            words, answers = lexicon.function_words, lexicon.book.answers
            reports = () if plainly and not opens else words.reports
            others = () if plainly else (*words.put_off, *words.bounds)
            against = (*words.reversals, *reports, *others)
            tokens = _tokens(text, lexicon)
            conditions = lexicon.as_written(words.conditions).starts(tokens)
            if next(lexicon.as_written(against).find(tokens), None):
                return False
            if 0 in conditions or (conditions and not plainly):
                return False
            if not opens and lexicon.index(words.corrections).starts(tokens) & {0, 1}:
                return False
            if any(is_number(one) or one.isnumeric() for one in tokens):  # "二" has no unit
                return False
            if plainly:
                continue
            if find_names(lexicon, tokens):
                return False
            denying = (*words.negations, *answers.not_, *answers.no)
            denied = bool(lexicon.index(denying).starts(tokens))
            moves = any(speaks_of_motion(one, lexicon) for one in tokens)
            if denied and (moves or not may_deny):
                return False
        return True

    def is_known(self, text: str, skills: Collection[str]) -> bool:
        """True if each word of a clause is known, and a value or a word of these skills is one.

        A clause with a condition is not.
        """
        lexicon = self.lexicon
        tokens, own = _tokens(text, lexicon), lexicon.words
        if next(lexicon.as_written(lexicon.function_words.conditions).find(tokens), None):
            return False
        small = lexicon.index(lexicon.function_words.all()).places(tokens)
        said = [one for at, one in enumerate(tokens) if at not in small and not is_mark(one)]
        known = all(is_number(one) or lexicon.knows(one) for one in said)
        return known and any(
            is_number(one)
            or lexicon.in_a_name(one)
            or any(one in own[skill].weights for skill in own.keys() & skills)
            for one in said
        )

    def has_number(self, text: str) -> bool:
        """True if a text has a number."""
        return any(map(is_number, _tokens(text, self.lexicon)))

    def has_amount(self, text: str) -> bool:
        """True if a text has a unit, or another number than the one of "one more time"."""
        tokens = _tokens(text, self.lexicon)
        units = tuple(self.lexicon.function_words.amounts)
        return any(
            is_number(one) and (float(one) != 1 or after.startswith(units))
            for one, after in zip(tokens, (*tokens[1:], ""), strict=True)
        )

    def named_in(self, text: str) -> Set[str]:
        """The words of arguments that a text names."""
        lexicon = self.lexicon
        names = find_names(lexicon, _tokens(text, lexicon))
        return {word for one in names for word in one.values.values()}

    def is_reason(self, text: str) -> bool:
        """True if a clause opens a reason ("to see you walk", "I need to get past"), no bound."""
        words, opens = self.lexicon.function_words, self._opens
        return opens(text, (*words.reasons, *words.plans)) and not opens(text, words.until)

    def opens_denying(self, text: str) -> bool:
        """True if a text begins with a word that denies: "not there"."""
        return self._opens(text, self.lexicon.function_words.negations)

    def is_bound(self, text: str) -> bool:
        """True if a clause opens what bounds a motion: "until you reach the door"."""
        return self._opens(text, self.lexicon.function_words.until)

    def _opens(self, text: str, phrases: tuple[str, ...]) -> bool:
        tokens = _tokens(text, self.lexicon)
        return 0 in self.lexicon.index(phrases).starts(tokens)

    def is_amount(self, text: str) -> bool:
        """True if a clause is only a number and a unit: "30 centimetres"."""
        words, tokens = self.lexicon.function_words, _tokens(text, self.lexicon)
        units = {
            word
            for one in self.lexicon.words.values()
            for word in (*one.measures, *(unit for some in one.units.values() for unit in some))
        }
        small = self.lexicon.index((*words.fillers, *words.urges)).places(tokens)
        said = [one for at, one in enumerate(tokens) if at not in small]
        numbers = [one for one in said if is_number(one)]
        return len(numbers) == 1 and units.issuperset({*said} - {*numbers})

    def speaks(self, text: str) -> bool:
        """True if a word of a text speaks for a motion, or names a value of one."""
        tokens = _tokens(text, self.lexicon)
        speaks = any(is_number(one) or speaks_of_motion(one, self.lexicon) for one in tokens)
        return speaks or bool(self.named_in(text))

    def is_urge(self, text: str) -> bool:
        """True if a clause only urges: "go go go"."""
        tokens = _tokens(text, self.lexicon)
        urges = self.lexicon.index(self.lexicon.function_words.urges).places(tokens)
        return len(urges) == len(tokens)

    def is_filler(self, text: str) -> bool:
        """True if each word of a text may as well be left out."""
        lexicon = self.lexicon
        words, tokens = lexicon.function_words, _tokens(text, lexicon)
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
            tokens = _tokens(text, lexicon)
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
                weights.get(one, 0.0) >= SPEAKS and at not in courteous
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
        words, tokens = lexicon.function_words, _tokens(text, lexicon)
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
        with self._lock:
            words = self._skills.words()
            if words != self._words:
                codes = dict.fromkeys((self._language, ENGLISH))
                lexicons = [
                    Lexicon(self._skills, phrasebook_of(code, self._skills.values()))
                    for code in codes
                ]
                self._readers = [(lexicon, CallReader(lexicon)) for lexicon in lexicons]
                self._words = words


def _tokens(text: str, lexicon: Lexicon) -> Words:
    return lexicon.tokenize(digits(" ".join(text.split()), lexicon.book.code))


def _names_another_motion(reading: Reading, lexicon: Lexicon) -> bool:
    """True if a word names another motion by an amount: "turn left two steps" is no step back."""
    own = lexicon.words[reading.calls[0].skill].weights
    others = [known for name, known in lexicon.words.items() if lexicon.skills[name].relative]
    return any(
        one not in own and known.weights.get(one, 0.0) >= _NAMES_ANOTHER
        for one in reading.tokens
        for known in others
    )


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
