"""Answers and corrections: yes, no, and "no, the other one", in the words of a language.

A correction changes a call: "no, to the office" is the same call with another value of one
argument.
"""

import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from enum import StrEnum
from functools import lru_cache
from itertools import chain
from typing import Any

from edgevox.agent.phrases.numbers import digits, is_exact
from edgevox.agent.phrases.phrasebook import AnswerWords, Phrasebook
from edgevox.agent.skills import Call, Skill
from edgevox.agent.text.spelling import NUMBER, key, separated, unpunctuated
from edgevox.core.files.json_reader import is_number
from edgevox.core.files.text import one_form

MAX_TOKENS = 32
"""Number of tokens from which on a text is no answer."""

_CLAUSE_END = re.compile(
    r"[;!?\u061b\u061f\u0964\u2026\u3001\u3002\uff01\uff0c\uff1b\uff1f\u060c]+|[.,:](?!\d)"
)
_NUMBER = re.compile(NUMBER)
_TOKEN = re.compile(rf"{NUMBER}|[a-z']+|\S")
"""The tokens of a script without spaces: each character is one; foreign words stay whole."""


class Answer(StrEnum):
    """Answers to a yes-or-no question."""

    YES = "yes"
    NO = "no"


class _AnswerPart(StrEnum):
    """Kinds of phrases in an answer beside yes and no."""

    NOT = "not"
    POLITE = "polite"
    LITTLE = "little"


@dataclass(frozen=True, slots=True)
class _Value:
    """A spoken value: one of the words of an argument, or a number."""

    value: str


_Found = Answer | _AnswerPart | _Value
_Phrases = Mapping[tuple[str, ...], _Found]
_Clause = tuple[_Found, ...]


class Answers:
    """Reads answers in several languages at once.

    A text is an answer only if all of it is: "yes, but not now" is none. `spaced` is True for a
    language that puts spaces between words.
    """

    def __init__(self, tables: Iterable[AnswerWords], *, spaced: bool = True) -> None:
        tables = tuple(tables)
        self._spaced = spaced
        nos = self._phrases(Answer.NO, chain.from_iterable(one.no for one in tables))
        nots = self._phrases(_AnswerPart.NOT, chain.from_iterable(one.not_ for one in tables))
        polite = self._phrases(
            _AnswerPart.POLITE, chain.from_iterable(one.polite for one in tables)
        )
        yes = self._phrases(Answer.YES, chain.from_iterable(one.yes for one in tables))
        little = self._phrases(
            _AnswerPart.LITTLE, chain.from_iterable(one.little for one in tables)
        )
        self._yes = {**polite, **yes}
        self._no = {**polite, **nots, **nos}
        self._denials = {phrase[0] for phrase in chain(nos, nots)}
        self._corrections = {**polite, **little, **nos, **nots}

    def read(self, text: str) -> Answer | None:
        """Yes or no if the text says nothing more, otherwise None."""
        for answer, phrases in ((Answer.NO, self._no), (Answer.YES, self._yes)):
            if {*chain.from_iterable(self._clauses(text, phrases))} - {_AnswerPart.POLITE}:
                return answer
        return None

    def after_no(self, text: str) -> str:
        """The text after a no and a comma or similar sign; empty unless it has both."""
        rest = ""
        for end in _CLAUSE_END.finditer(text):
            if self.read(text[: end.start()]) is not Answer.NO:
                break
            rest = text[end.end() :].strip()
        return rest

    def value(self, text: str, spoken: Mapping[str, str], meant: str) -> str | None:
        """The word that a correction puts in place of `meant`; None if the text is no correction.

        `spoken` maps each spoken form to its word. "No, the office" and "not the kitchen, the
        office" mean the office; "not the office" does not.
        """
        words: _Phrases = {
            form: _Value(word)
            for said, word in spoken.items()
            for form in _forms(said, self._spaced)
        }
        clauses = self._clauses(text, {**self._corrections, **words})
        said = {one.value for clause in clauses for one in _values(clause)}
        negated = {value for clause in clauses for value in _negated(clause)}
        others = said - {meant} - negated
        corrects = negated == {meant} if negated else any(map(_says_no, clauses))
        return others.pop() if corrects and len(others) == 1 else None

    def numbers(self, text: str) -> tuple[str, ...]:
        """The numbers of a correction, as digits in their order; empty if it is no correction."""
        said: _Phrases = {(n,): _Value(n) for n in _NUMBER.findall(text)}
        clauses = self._clauses(text, {**self._corrections, **said})
        if any(map(_negated, clauses)) or not any(map(_says_no, clauses)):
            return ()
        return tuple(one.value for clause in clauses for one in _values(clause))

    def may_correct(self, text: str) -> bool:
        """True if the text could hold a no; a quick check, since most texts do not."""
        return not self._denials.isdisjoint(chain(*_clause_tokens(text, self._spaced)))

    def _clauses(self, text: str, phrases: _Phrases) -> Sequence[_Clause]:
        """The phrases of each clause; empty if a clause holds anything else."""
        clauses = _clause_tokens(text, self._spaced)
        if sum(map(len, clauses)) > MAX_TOKENS:
            return ()
        found = [_parts(tokens, phrases) for tokens in clauses]
        return found if all(found) else ()

    def _phrases(self, part: _Found, said: Iterable[str]) -> dict[tuple[str, ...], _Found]:
        return {form: part for one in said for form in _forms(one, self._spaced)}


@lru_cache(maxsize=4096)
def _forms(phrase: str, spaced: bool) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Tokens of a phrase as it is written, and without the accents that people leave out."""
    return _tokens(phrase, spaced), _split(key(phrase), spaced)


@lru_cache(maxsize=16)
def _clause_tokens(text: str, spaced: bool) -> tuple[tuple[str, ...], ...]:
    """The words of each clause that has any. Cached: a text is read several times."""
    clauses = (_tokens(part, spaced) for part in _CLAUSE_END.split(text))
    return tuple(tokens for tokens in clauses if tokens)


def _tokens(text: str, spaced: bool) -> tuple[str, ...]:
    """The words of a text with their accents, which may tell a yes from a no."""
    return _split(unpunctuated(separated(one_form(text)).casefold()), spaced)


def _split(text: str, spaced: bool) -> tuple[str, ...]:
    return tuple(text.split() if spaced else _TOKEN.findall(text))


def _parts(tokens: Sequence[str], phrases: _Phrases) -> _Clause:
    """Split tokens into known phrases, long ones first; empty if that is not possible.

    Works from the end: `rest[i]` holds the phrases of the tokens from `i` on.
    """
    rest: list[_Clause | None] = [None] * len(tokens) + [()]
    for start in reversed(range(len(tokens))):
        for end in range(len(tokens), start, -1):
            part, after = phrases.get(tuple(tokens[start:end])), rest[end]
            if part is not None and after is not None:
                rest[start] = (part, *after)
                break
    return rest[0] or ()


def _values(clause: _Clause) -> list[_Value]:
    return [part for part in clause if isinstance(part, _Value)]


def _says_no(clause: _Clause) -> bool:
    """True if the clause says no to an earlier sentence, not to its own words."""
    plain = [part for part in clause if part is not _AnswerPart.POLITE]
    alone = set(plain) <= {Answer.NO, _AnswerPart.NOT}
    return bool(plain) and (alone or plain[0] is Answer.NO)


def _negated(clause: _Clause) -> set[str]:
    """The values that the clause denies: before a negation, or after it if none is before."""
    plain = [part for part in clause if part is not _AnswerPart.POLITE]
    found = set()
    for at, part in enumerate(plain):
        if part is _AnswerPart.NOT or (part is Answer.NO and at > 0):
            near = _values(tuple(plain[:at]))[-1:] or _values(tuple(plain[at:]))[:1]
            found |= {one.value for one in near}
    return found


_IT = "it"
"""Pronoun for the thing spoken of last; it names no value, so it corrects nothing."""


def correct(call: Call, one: Skill, text: str, answers: Answers, book: Phrasebook) -> Call | None:
    """The corrected call; None unless the text is a correction without doubt.

    A word counts if the skill's templates know it for the argument in this language. Numbers
    replace all numbers of the call, so there must be as many.
    """
    if not answers.may_correct(text) or not is_exact(text, book.code):
        return None
    found = [*_words(call, one, text, answers, book)]
    if len(found) == 1:
        return Call(call.skill, {**call.arguments, **found[0]})
    if found:
        return None
    names = [name for name, value in call.arguments.items() if is_number(value)]
    said = answers.numbers(digits(" ".join(one_form(text).split()), book.code))
    if not names or len(names) != len(said):
        return None
    changed = one.from_words(dict(zip(names, said, strict=True)))
    return Call(call.skill, {**call.arguments, **changed})


def _words(
    call: Call, one: Skill, text: str, answers: Answers, book: Phrasebook
) -> list[Mapping[str, Any]]:
    """Each argument that the text could correct, with its new value."""
    found: list[Mapping[str, Any]] = []
    for name, choices in one.choices.items():
        spoken = {said: word for said, word in book.heard(choices).items() if word != _IT}
        value = answers.value(text, spoken, str(call.arguments.get(name)))
        found += [{name: value}] if value else []
    return found
