"""Understands answers: yes, no, and "no, the other one", in the words of a language."""

import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from enum import StrEnum
from itertools import chain

from edgevox.agent.spelling import key

MAX_TOKENS = 32
"""What is longer is no answer."""

_PUNCTUATION = " ,.;:!\u3001\u3002\uff0c"
_NUMBER = re.compile(r"-?\d+(?:\.\d+)?")
_TOKEN = re.compile(rf"{_NUMBER.pattern}|[a-z']+|\S")
"""Where words have no spaces between them, each character is one; foreign words stay whole."""


@dataclass(frozen=True, slots=True)
class AnswerWords:
    """What a language answers with; phrases/en.toml says what each is."""

    yes: tuple[str, ...] = ()
    no: tuple[str, ...] = ()
    not_: tuple[str, ...] = ()
    polite: tuple[str, ...] = ()
    little: tuple[str, ...] = ()


class Answer(StrEnum):
    """What somebody says to a question."""

    YES = "yes"
    NO = "no"


class _Part(StrEnum):
    """What a phrase is in an answer, where it is neither yes nor no."""

    NOT = "not"
    POLITE = "polite"
    LITTLE = "little"


@dataclass(frozen=True, slots=True)
class _Value:
    """A value that somebody says: one of the words of an argument, or a number."""

    value: str


_Found = Answer | _Part | _Value
_Phrases = Mapping[tuple[str, ...], _Found]


class Answers:
    """Reads answers in several languages at once. `spaced`: words have spaces between them.

    A text is an answer only if all of it is: "yes, but not now" is none.
    """

    def __init__(self, tables: Iterable[AnswerWords], *, spaced: bool = True) -> None:
        tables = tuple(tables)
        self._spaced = spaced
        nos = self._phrases(Answer.NO, chain.from_iterable(one.no for one in tables))
        nots = self._phrases(_Part.NOT, chain.from_iterable(one.not_ for one in tables))
        polite = self._phrases(_Part.POLITE, chain.from_iterable(one.polite for one in tables))
        yes = self._phrases(Answer.YES, chain.from_iterable(one.yes for one in tables))
        little = self._phrases(_Part.LITTLE, chain.from_iterable(one.little for one in tables))
        self._yes = {**polite, **yes}
        self._no = {**polite, **nots, **nos}
        self._corrections = {**polite, **little, **nots, **nos}

    def read(self, text: str) -> Answer | None:
        """Yes or no, if that is all it says."""
        tokens = self._tokens(text)
        for answer, phrases in ((Answer.NO, self._no), (Answer.YES, self._yes)):
            if set(_parts(tokens, phrases)) - {_Part.POLITE}:
                return answer
        return None

    def after_no(self, text: str) -> str:
        """What is said after a no; nothing if it does not begin with one, or is no more than it."""
        units = text.split() if self._spaced else list(text)
        for count in range(min(len(units), MAX_TOKENS) - 1, 0, -1):
            joint = " " if self._spaced else ""
            if self.read(joint.join(units[:count])) is Answer.NO:
                return joint.join(units[count:]).lstrip(_PUNCTUATION)
        return ""

    def value(self, text: str, spoken: Mapping[str, str], meant: str) -> str | None:
        """The word that is meant instead of the one that was `meant`, if all of it says that.

        `spoken` is what may be said for each word. "No, the office" means it, and so does "not the
        kitchen, the office"; "not the office" does not.
        """
        words = {self._tokens(said): _Value(word) for said, word in spoken.items()}
        found = _parts(self._tokens(text), {**self._corrections, **words})
        said = {one.value for one in found if isinstance(one, _Value)}
        others = said - {meant}
        negated = _Part.NOT in found
        plain = (Answer.NO in found or negated) and len(others) == 1
        return others.pop() if plain and (meant in said or not negated) else None

    def numbers(self, text: str) -> tuple[str, ...]:
        """The numbers of a correction in digits, in their order, if all of it says that."""
        tokens = self._tokens(text)
        said: _Phrases = {(one,): _Value(one) for one in tokens if _NUMBER.fullmatch(one)}
        found = _parts(tokens, {**self._corrections, **said})
        if Answer.NO not in found or _Part.NOT in found:
            return ()
        return tuple(one.value for one in found if isinstance(one, _Value))

    def _phrases(self, part: _Found, said: Iterable[str]) -> dict[tuple[str, ...], _Found]:
        return {self._tokens(one): part for one in said}

    def _tokens(self, text: str) -> tuple[str, ...]:
        plain = key(text)
        return tuple(plain.split() if self._spaced else _TOKEN.findall(plain))


def _parts(tokens: Sequence[str], phrases: _Phrases) -> tuple[_Found, ...]:
    """The phrases that the tokens are, one after another, long ones first; nothing if they are not.

    Works from the end: `rest[i]` is what the tokens from `i` on are.
    """
    if len(tokens) > MAX_TOKENS:
        return ()
    longest = max(map(len, phrases), default=0)
    rest: list[tuple[_Found, ...] | None] = [None] * len(tokens) + [()]
    for start in reversed(range(len(tokens))):
        for end in range(min(len(tokens), start + longest), start, -1):
            part, after = phrases.get(tuple(tokens[start:end])), rest[end]
            if part is not None and after is not None:
                rest[start] = (part, *after)
                break
    return rest[0] or ()
