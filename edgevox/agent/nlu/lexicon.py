"""The words of a set of skills in one language: which speak for which skill, and which for none.

All of it comes from what the skills and the phrasebook bring anyway: their templates, examples and
words. A word that only one skill's sentences hold says much, one that all hold says nothing.

Finds many phrases in a sentence at once.

The small words that say how a sentence is meant: `[function_words]` of a language's file.

A sentence as words, numbers and marks, in the one spelling that everything is compared in.
"""

import math
import re
import unicodedata
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache
from typing import Any

from edgevox.agent.phrases.numbers import digits
from edgevox.agent.phrases.phrasebook import Phrasebook
from edgevox.agent.skills import Skill, SkillSet
from edgevox.agent.skills.arguments import is_number_type
from edgevox.agent.text.spelling import NUMBER, folded, separated
from edgevox.core.files.text import one_form
from edgevox.core.language_files import language_file


@dataclass(frozen=True, slots=True)
class FunctionWords:
    """What is said around a command, in one language.

    `fillers` mean nothing to a robot. `urges` are said to whoever should do something, where
    nothing else says so: "kitchen, quickly". `negations` deny what follows. `corrections` take back
    what came before. `reports` tell what somebody said or needs, `conditions` what was, will be or
    might be, and `doubts` speak of others than the robot; `questions` open one. `asking` opens an
    order that is put politely, so that it is one although it looks like a question. `wishes` open
    one that is put as a statement: "you' re needed". `reasons` open a clause that only says why.
    `reversals` say that the order of doing is not that of saying. `plans` are what the speaker or
    others do themselves, `pronouns` stand for a thing. `linking` stand between an axis and its
    number, `gerunds` before a verb that stands for its order: "interpreter going". `copulas` stand
    beside a name of which something is told: "the kitchen' s over there". `misheard` are words as a
    recogniser of speech writes them down, with those that were said.

    `abilities` may ask what somebody can do, and not for it. `amounts` are parts of numbers, units
    and times: one that no value took leaves no order.
    `number_marks` are so only beside a number: "two point five". So are `bounds`: "at least two".
    `put_off` say that an order is not for now; one that ends in " ." must end the sentence, and one
    that begins with ". " begin it.
    """

    fillers: tuple[str, ...] = ()
    urges: tuple[str, ...] = ()
    negations: tuple[str, ...] = ()
    corrections: tuple[str, ...] = ()
    reports: tuple[str, ...] = ()
    conditions: tuple[str, ...] = ()
    doubts: tuple[str, ...] = ()
    questions: tuple[str, ...] = ()
    asking: tuple[str, ...] = ()
    wishes: tuple[str, ...] = ()
    reasons: tuple[str, ...] = ()
    reversals: tuple[str, ...] = ()
    plans: tuple[str, ...] = ()
    pronouns: tuple[str, ...] = ()
    linking: tuple[str, ...] = ()
    gerunds: tuple[str, ...] = ()
    copulas: tuple[str, ...] = ()
    abilities: tuple[str, ...] = ()
    amounts: tuple[str, ...] = ()
    number_marks: tuple[str, ...] = ()
    bounds: tuple[str, ...] = ()
    put_off: tuple[str, ...] = ()
    misheard: Mapping[str, str] = field(default_factory=dict)

    def all(self) -> tuple[str, ...]:
        """Every one of them."""
        return (
            *self.fillers, *self.urges, *self.negations, *self.corrections, *self.reports,
            *self.conditions, *self.doubts, *self.questions, *self.asking, *self.wishes,
            *self.reasons, *self.reversals, *self.amounts, *self.number_marks, *self.bounds,
            *self.put_off,
        )  # fmt: skip


@cache
def words_of(code: str) -> FunctionWords:
    """Those of a language of the catalogue; none if its file has none."""
    table: Mapping[str, Any] = language_file(code).get("function_words", {})
    return FunctionWords(
        misheard=table.get("misheard", {}),
        **{n: tuple(words) for n, words in table.items() if n != "misheard"},
    )


Words = tuple[str, ...]

_MARKS = r"[,;.!?:\u2026\u3001\u3002\u060c\u061b\u061f\u0964]+"
_ORDINAL = r"\d+(?:st|nd|rd|th)\b"
WORD = r"(?:[^\W\d_]|[\u0900-\u0963])+'?"
"""A word; the vowels and joiners of Devanagari are no letters to `re`, and part of one."""
_TOKEN = re.compile(rf"{_ORDINAL}|(?<![\d.]){NUMBER}|{WORD}|{_MARKS}|%|\u00b0")
_IS_NUMBER = re.compile(NUMBER)
_IS_MARK = re.compile(_MARKS)
_JOINING = frozenset({0, 8, 9})
"""The combining classes of marks that make another letter or join two: kana voicing, virama."""


def plain(text: str) -> str:
    """One spelling: no accents, no vowel points, no capitals, words that a mark joins apart."""
    spelled = folded(separated(one_form(text.replace("_", " ")))).casefold()
    if spelled.isascii():
        return spelled
    return "".join(one for one in spelled if unicodedata.combining(one) in _JOINING)


def is_number(token: str) -> bool:
    """Whether this token is written in digits."""
    return bool(_IS_NUMBER.fullmatch(token))


def is_mark(token: str) -> bool:
    """Whether this token is punctuation."""
    return bool(_IS_MARK.fullmatch(token))


class Tokenizer:
    """Splits sentences of one language.

    Where words have no spaces between them the longest that is known counts, and what is not known
    falls into single characters.
    """

    def __init__(self, book: Phrasebook, known: Iterable[str]) -> None:
        self._spaced = book.hearing.spaced
        self._known = frozenset() if self._spaced else frozenset(known)
        self._longest = max(map(len, self._known), default=1)

    def __call__(self, text: str) -> Words:
        tokens = _TOKEN.findall(plain(text))
        if self._spaced:
            return tuple(tokens)
        return tuple(part for token in tokens for part in self._parts(token))

    def _parts(self, token: str) -> Sequence[str]:
        if is_number(token) or is_mark(token) or token.isascii():
            return (token,)
        parts, at = [], 0
        while at < len(token):
            length = next(
                (n for n in range(self._longest, 1, -1) if token[at : at + n] in self._known), 1
            )
            parts.append(token[at : at + length])
            at += length
        return parts


def find(tokens: Sequence[str], phrase: Words) -> list[int]:
    """Where this phrase begins among these tokens."""
    size = len(phrase)
    return [i for i in range(len(tokens) - size + 1) if tuple(tokens[i : i + size]) == phrase]


class PhraseIndex:
    """Phrases by their first words, so that a sentence is walked through once."""

    def __init__(self, phrases: Iterable[Words]) -> None:
        self._by_first: dict[str, list[Words]] = {}
        for one in dict.fromkeys(phrases):
            if one:
                self._by_first.setdefault(one[0], []).append(one)

    def find(self, tokens: Sequence[str]) -> Iterator[tuple[int, Words]]:
        """Each phrase that stands there, with where it begins."""
        for at, token in enumerate(tokens):
            for phrase in self._by_first.get(token, ()):
                if tuple(tokens[at : at + len(phrase)]) == phrase:
                    yield at, phrase

    def places(self, tokens: Sequence[str]) -> frozenset[int]:
        """Where the words of these phrases stand."""
        return frozenset(
            at for start, one in self.find(tokens) for at in range(start, start + len(one))
        )

    def starts(self, tokens: Sequence[str]) -> frozenset[int]:
        """Where these phrases begin."""
        return frozenset(start for start, _ in self.find(tokens))


_SYNTAX = re.compile(r"[()\[\]|{}<>]")
_SLOT = re.compile(r"\{(\w+)\}")
_BEHIND_SLOT = re.compile(r"\{\w+\}\s*(\([^()]*\)|\[[^\[\]]*\]|[^\s\[\](){}|]+)")
_NAME_WORDS = re.compile(r"[a-z]+")
_WORD = re.compile(WORD)
_FILLER_WEIGHT = 0.1
"""What a word counts that may mean nothing as well: "up", "got"."""
_EXAMPLE_WEIGHT = 0.25
"""What a word of an example counts, against one of a template: examples are of few people."""
_SHORTEST_MIXED = 4
_SHORTEST_SLIP = 6
"""Shorter words are too often others when one letter differs."""
_EVERYWHERE = 0.6
"""A word that this share of the skills knows belongs to none of them."""


@dataclass(frozen=True, slots=True)
class SkillWords:
    """What is known of one skill's language: words with their weights, and the units of numbers.

    `shown` are the words that only its examples hold, `measures` the `amounts` of its templates.
    """

    skill: Skill
    weights: Mapping[str, float]
    units: Mapping[str, frozenset[str]]
    shown: frozenset[str]
    measures: frozenset[str]

    @property
    def numbers(self) -> tuple[str, ...]:
        """The arguments that are numbers, in their order."""
        fields = self.skill.arguments_model.model_fields
        return tuple(name for name, info in fields.items() if is_number_type(info.annotation))


class Lexicon:
    """The words of these skills in this language, and how sentences of it are split."""

    def __init__(self, skills: SkillSet, book: Phrasebook) -> None:
        self.book = book
        self.skills = skills
        self.places = {
            (name, argument): _spoken(choices.words, book.heard(choices))
            for name, one in skills.items()
            for argument, choices in one.choices.items()
        }
        self.function_words = words_of(book.code)
        fillers = frozenset(map(plain, (*self.function_words.fillers, *book.hearing.articles)))
        chunks = {name: _chunks(one, book, fillers) for name, one in skills.items()}
        known = {word for words in chunks.values() for word in words}
        known |= {said for spoken in self.places.values() for said in spoken}
        known |= {plain(one) for one in words_of(book.code).all()}
        self.tokenize = Tokenizer(book, known)
        self._phrases: dict[str, Words] = {}
        self._indices: dict[tuple[str, ...], PhraseIndex] = {}
        self._written: dict[tuple[str, ...], PhraseIndex] = {}
        self._functions = {part for one in self.function_words.all() for part in self.phrase(one)}
        self._misheard = [
            (self.tokenize(written), self.tokenize(said))
            for written, said in self.function_words.misheard.items()
        ]
        self._gerunds = frozenset(self.function_words.gerunds)
        self.names = {
            place: {self.tokenize(said): word for said, word in spoken.items()}
            for place, spoken in self.places.items()
        }
        self.common, self.words = self._weigh(chunks)
        named = {part for names in self.names.values() for name in names for part in name}
        self._named = named
        self._orders = {
            _letters(word): word
            for word in (*named, *(w for one in self.words.values() for w in one.weights))
            if len(word) >= _SHORTEST_MIXED
        }

    def knows(self, word: str) -> bool:
        """Whether it is a word of some skill, or means nothing to any."""
        return self.speaks(word) or word in self._functions or word in self._named

    def in_a_name(self, word: str) -> bool:
        """Whether it is a word of some name."""
        return word in self._named

    def phrase(self, text: str) -> Words:
        """Words of the language's tables as they stand in sentences: "1st" for "first"."""
        if text not in self._phrases:
            self._phrases[text] = self.tokenize(digits(text, self.book.code))
        return self._phrases[text]

    def as_written(self, phrases: tuple[str, ...]) -> PhraseIndex:
        """The same as `index`, of words whose numbers stay words as well.

        "Metre" is no "1 metre", and "in a second" also "in a 2nd" where it has several words.
        """
        if phrases not in self._written:
            several = (one for one in map(self.phrase, phrases) if len(one) > 1)
            self._written[phrases] = PhraseIndex((*map(self.tokenize, phrases), *several))
        return self._written[phrases]

    def index(self, phrases: tuple[str, ...]) -> PhraseIndex:
        """What finds these in sentences."""
        if phrases not in self._indices:
            self._indices[phrases] = PhraseIndex(map(self.phrase, phrases))
        return self._indices[phrases]

    def spelled(self, tokens: Words) -> Words:
        """With unknown words as those that were meant: see `_spelled`."""
        for written, said in self._misheard:
            for at in reversed(find(tokens, written)):
                tokens = (*tokens[:at], *said, *tokens[at + len(written) :])
        return tuple(
            self._spelled(one, tokens[max(0, at - 2) : at]) for at, one in enumerate(tokens)
        )

    def _spelled(self, word: str, before: Words) -> str:
        """The word that was meant, where this one is unknown: "trun" is "turn".

        That is one of the same letters, one that differs in one letter, or the verb that a gerund
        is of, where one may stand.
        """
        if self.knows(word):
            return word
        if word.endswith("ing") and self._gerunds.intersection(before):
            stems = (word[:-3], word[:-3] + "e", word[:-4])
            return next((one for one in stems if self.speaks(one)), word)
        if same := self._orders.get(_letters(word)):
            return same
        if len(word) < _SHORTEST_SLIP:
            return word
        near = (one for one in self._orders.values() if len(one) >= _SHORTEST_SLIP)
        return next((one for one in near if _is_one_off(word, one)), word)

    def says_a_point(self, word: str) -> bool:
        """Whether it is a word of skills that take several numbers, and of no other ones."""
        knowing = [one for one in self.words.values() if word in one.weights]
        several = [one for one in knowing if len(one.numbers) > 1]
        others = [one for one in knowing if one.skill.choices or len(one.numbers) == 1]
        return bool(several) and not others

    def speaks(self, word: str) -> bool:
        """Whether it speaks for some skill."""
        return word in self.common or any(word in one.weights for one in self.words.values())

    def _weigh(
        self, chunks: Mapping[str, Mapping[str, float]]
    ) -> tuple[frozenset[str], dict[str, SkillWords]]:
        counts = Counter(word for words in chunks.values() for word in words)
        least = max(2.0, _EVERYWHERE * len(chunks))
        in_names = self._name_words(chunks)
        common = frozenset(
            word for word, count in counts.items() if count >= least and word not in in_names
        )
        words = {
            name: SkillWords(
                self.skills[name],
                {
                    word: weight * math.log1p(len(chunks) / in_names.get(word, counts[word]))
                    for word, weight in chunk.items()
                    if word not in common and (word not in in_names or word in _parts(name))
                },
                _units(self.skills[name], self.book),
                frozenset(word for word, weight in chunk.items() if weight == _EXAMPLE_WEIGHT),
                self._measures(self.skills[name]),
            )
            for name, chunk in chunks.items()
        }
        return common, words

    def _measures(self, one: Skill) -> frozenset[str]:
        """The units that stand right behind a number in its templates."""
        texts = (plain(self.book.written_out(one)) for one in self.book.templates(one))
        written = [found[1] for text in texts for found in _BEHIND_SLOT.finditer(text)]
        words = {plain(amount) for amount in self.function_words.amounts}
        if not self.book.hearing.spaced:
            return frozenset(word for word in words if any(word in text for text in written))
        return frozenset(words & {word for text in written for word in _WORD.findall(text)})

    def _name_words(self, chunks: Mapping[str, Mapping[str, float]]) -> dict[str, int]:
        """The words of skills' names that tell skills apart, and how many names hold each.

        They count for these skills alone, whatever the courtesies of others hold: "right now".
        """
        if self.book.fallback is not None:
            return {}
        counts = Counter(word for name in chunks for word in set(_parts(name)))
        return {
            word: n
            for word, n in counts.items()
            if n * 2 <= len(chunks) and word not in self.function_words.fillers
        }


def _letters(word: str) -> tuple[str, str]:
    """What a word has in common with those of which somebody typed two letters the wrong way."""
    return word[:1], "".join(sorted(word))


def _is_one_off(one: str, other: str) -> bool:
    """Whether one letter was left out, put in, or is another; never the first."""
    if one[0] != other[0] or abs(len(one) - len(other)) > 1:
        return False
    same = next((i for i, (a, b) in enumerate(zip(one, other, strict=False)) if a != b), None)
    if same is None:
        return True
    rest, longer = sorted((one[same:], other[same:]), key=len)
    return rest[len(rest) == len(longer) :] == longer[1:]


def _parts(name: str) -> list[str]:
    return _NAME_WORDS.findall(name)


def _spoken(words: Sequence[str], heard: Mapping[str, str]) -> dict[str, str]:
    return {plain(said): word for said, word in heard.items()} | {
        plain(word): word for word in words
    }


def _chunks(one: Skill, book: Phrasebook, fillers: frozenset[str]) -> dict[str, float]:
    """The words of a skill's sentences; those of its templates count fully."""
    templates = [book.written_out(template) for template in book.templates(one)]
    said = _words([example.sentence for example in book.examples(one)])
    found = dict.fromkeys(said - fillers, _EXAMPLE_WEIGHT)
    found |= {word: _FILLER_WEIGHT if word in fillers else 1.0 for word in _words(templates)}
    if book.fallback is None:
        found |= dict.fromkeys(_parts(one.name), 1.0)
    if not book.hearing.spaced:
        return {word: weight for word, weight in found.items() if len(word) > 1}
    return found


def _words(sentences: Iterable[str]) -> set[str]:
    bare = (_SYNTAX.sub(" ", _SLOT.sub(" ", plain(one))) for one in sentences)
    return {word for sentence in bare for word in _WORD.findall(sentence)}


def _units(one: Skill, book: Phrasebook) -> dict[str, frozenset[str]]:
    """What is said right after a number, by argument."""
    units: dict[str, set[str]] = {}
    for template in book.templates(one):
        written = plain(book.written_out(template))
        for match in re.finditer(r"\{(\w+)\}\s*(\([^()]*\)|\[[^\[\]]*\])?", written):
            units.setdefault(match[1], set()).update(_WORD.findall(match[2] or ""))
    return {name: frozenset(words) for name, words in units.items()}
