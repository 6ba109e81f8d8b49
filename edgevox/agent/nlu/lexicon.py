"""The lexicon: weights of words for skills, function words, and tokens, for one language.

- `FunctionWords`: small words that tell how a sentence is meant, from `[function_words]`.
- `Tokenizer`: splits a sentence into words, numbers and marks in one spelling (`plain`).
- `PhraseIndex`: finds many phrases in a sentence at once.
- `Lexicon`: weighs words by the skills' templates and examples. A word in one skill's sentences
  weighs much, a word in all sentences nothing.
"""

import math
import re
import unicodedata
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache, cached_property, lru_cache
from typing import Any

from edgevox.agent.nlu.templates import openers, usual_places
from edgevox.agent.phrases.numbers import digits
from edgevox.agent.phrases.phrasebook import Phrasebook
from edgevox.agent.skills import Skill, SkillSet
from edgevox.agent.skills.arguments import is_number_type
from edgevox.agent.text.spelling import NUMBER, folded, separated
from edgevox.core.files.text import one_form
from edgevox.core.languages import language_file


@dataclass(frozen=True, slots=True)
class FunctionWords:
    """The words around commands, in one language."""

    fillers: tuple[str, ...] = ()
    """Words without a meaning for a robot."""
    urges: tuple[str, ...] = ()
    """Words that ask for action where nothing else does: "kitchen, quickly"."""
    negations: tuple[str, ...] = ()
    """Words that deny the words after them."""
    corrections: tuple[str, ...] = ()
    """Words that take back the words before them."""
    reports: tuple[str, ...] = ()
    """Words that tell what a person said or needs."""
    conditions: tuple[str, ...] = ()
    """Words that tell what was, will be or might be."""
    doubts: tuple[str, ...] = ()
    """Words about people or things other than the robot."""
    questions: tuple[str, ...] = ()
    """Words that open a question."""
    inverted: tuple[str, ...] = ()
    """Those of them that ask only where they open a clause: "you did well" is no question."""
    asking: tuple[str, ...] = ()
    """Words that open a polite order, which looks like a question."""
    wishes: tuple[str, ...] = ()
    """Words that open an order in the form of a statement: "you' re needed"."""
    reasons: tuple[str, ...] = ()
    """Words that open a clause with a reason."""
    until: tuple[str, ...] = ()
    """Words that open what bounds a motion: "until"."""
    results: tuple[str, ...] = ()
    """Words that open what follows from a reason: "so"."""
    reversals: tuple[str, ...] = ()
    """Words that reverse the order of doing."""
    plans: tuple[str, ...] = ()
    """Words about what the speaker or others do themselves."""
    pronouns: tuple[str, ...] = ()
    """Words that stand for a thing."""
    linking: tuple[str, ...] = ()
    """Words between an axis and its number."""
    gerunds: tuple[str, ...] = ()
    """Words before a gerund that stands for an order: "interpreter going"."""
    copulas: tuple[str, ...] = ()
    """Words beside a name that tell something about it: "the kitchen' s over there"."""
    abilities: tuple[str, ...] = ()
    """Words that may ask about an ability instead of for the action."""
    talking: tuple[str, ...] = ()
    """Words for what a robot can do by talking alone: "can you explain ..."."""
    me: tuple[str, ...] = ()
    """Words for the speaker, the subject first, and, where these are left out, common verbs that
    tell of them."""
    you: tuple[str, ...] = ()
    """Words for the hearer."""
    amounts: tuple[str, ...] = ()
    """Parts of numbers, units and times; the sentence is no order if no value took them."""
    number_marks: tuple[str, ...] = ()
    """Amounts only beside a number: "two point five"."""
    little: tuple[str, ...] = ()
    """Words for a small amount: "a bit"."""
    bounds: tuple[str, ...] = ()
    """Bounds of a number, only beside it: "at least two"."""
    put_off: tuple[str, ...] = ()
    """Words that put an order off. One with " ." at its end must end the sentence; one with ". " at
    its beginning must begin it."""
    misheard: Mapping[str, str] = field(default_factory=dict)
    """Words as speech recognition writes them, with the words that were said."""

    def all(self) -> tuple[str, ...]:
        """All words that tell how a sentence is meant."""
        return (
            *self.fillers, *self.urges, *self.negations, *self.corrections, *self.reports,
            *self.conditions, *self.doubts, *self.questions, *self.asking, *self.wishes,
            *self.reasons, *self.reversals, *self.amounts, *self.number_marks, *self.bounds,
            *self.put_off,
        )  # fmt: skip


@cache
def words_of(code: str) -> FunctionWords:
    """The function words of a language of the catalogue; empty if its file has none."""
    table: Mapping[str, Any] = language_file(code).get("function_words", {})
    return FunctionWords(
        misheard=table.get("misheard", {}),
        **{n: tuple(words) for n, words in table.items() if n != "misheard"},
    )


Words = tuple[str, ...]

_MARKS = r"[,;.!?:\u2026\u3001\u3002\u060c\u061b\u061f\u0964]+"
_ORDINAL = r"\d+(?:st|nd|rd|th)\b"
WORD = r"(?:[^\W\d_]|[\u0900-\u0963])+'?"
"""Pattern of a word; `re` takes the vowels and joiners of Devanagari for no letters."""
TOKEN = re.compile(rf"{_ORDINAL}|(?<![\d.]){NUMBER}|{WORD}|{_MARKS}|%|\u00b0")
_IS_NUMBER = re.compile(NUMBER)
_IS_MARK = re.compile(_MARKS)
_JOINING = frozenset({0, 8, 9})
"""Combining classes of marks that make another letter or join two: kana voicing, virama."""


@lru_cache(maxsize=8192)
def plain(text: str) -> str:
    """Spell a text in one way: no accents, vowel points or capitals, and joined words apart."""
    spelled = folded(separated(one_form(text.replace("_", " ")))).casefold()
    if spelled.isascii():
        return spelled
    return "".join(one for one in spelled if unicodedata.combining(one) in _JOINING)


def is_number(token: str) -> bool:
    """True if this token is a number in digits."""
    return bool(_IS_NUMBER.fullmatch(token))


def is_mark(token: str) -> bool:
    """True if this token is punctuation."""
    return bool(_IS_MARK.fullmatch(token))


class Tokenizer:
    """Splits sentences of one language into tokens.

    In a language without spaces the longest known word counts, and unknown text falls into single
    characters.
    """

    def __init__(self, book: Phrasebook, known: Iterable[str]) -> None:
        self._spaced = book.hearing.spaced
        self._known = frozenset() if self._spaced else frozenset(known)
        self._longest = max(map(len, self._known), default=1)

    def __call__(self, text: str) -> Words:
        tokens = TOKEN.findall(plain(text))
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
    """Indices at which a phrase begins among tokens."""
    size = len(phrase)
    return [i for i in range(len(tokens) - size + 1) if tuple(tokens[i : i + size]) == phrase]


class PhraseIndex:
    """Phrases by their first words, so that one pass through a sentence finds all."""

    def __init__(self, phrases: Iterable[Words]) -> None:
        self._by_first: dict[str, list[Words]] = {}
        for one in dict.fromkeys(phrases):
            if one:
                self._by_first.setdefault(one[0], []).append(one)

    def find(self, tokens: Sequence[str]) -> Iterator[tuple[int, Words]]:
        """Each phrase among the tokens, with the index of its first word."""
        for at, token in enumerate(tokens):
            for phrase in self._by_first.get(token, ()):
                if tuple(tokens[at : at + len(phrase)]) == phrase:
                    yield at, phrase

    def places(self, tokens: Sequence[str]) -> frozenset[int]:
        """Indices of all words of these phrases."""
        return frozenset(
            at for start, one in self.find(tokens) for at in range(start, start + len(one))
        )

    def starts(self, tokens: Sequence[str]) -> frozenset[int]:
        """Indices at which these phrases begin."""
        return frozenset(start for start, _ in self.find(tokens))


_SYNTAX = re.compile(r"[()\[\]|{}<>]")
_SLOT = re.compile(r"\{(\w+)\}")
_GROUP = r"\((?:[^()]|\([^()]*\))*\)|\[[^\[\]]*\]"
_BEHIND_SLOT = re.compile(rf"\{{\w+\}}\s*({_GROUP}|[^\s\[\](){{}}|]+)")
_NAME_WORDS = re.compile(r"[a-z]+")
_WORD = re.compile(WORD)
_FILLER_WEIGHT = 0.1
"""Weight of a word that may also mean nothing: "up", "got"."""
_EXAMPLE_WEIGHT = 0.25
"""Weight of a word of an example; a template's word has 1. Examples come from few people."""
_SHORTEST_MIXED = 4
_SHORTEST_SLIP = 6
"""Least letters of a word to correct one letter: in shorter ones it often makes another word."""
_SEVERAL = 2
_EVERYWHERE = 0.6
"""Share of the skills from which on a word that they know speaks for none of them."""


@dataclass(frozen=True, slots=True)
class SkillWords:
    """The words of one skill."""

    skill: Skill
    """The skill."""
    weights: Mapping[str, float]
    """Words that speak for the skill, with their weights."""
    units: Mapping[str, frozenset[str]]
    """Words right after a number, by argument."""
    shown: frozenset[str]
    """Words that only its examples hold."""
    measures: frozenset[str]
    """`amounts` that its templates have after a number."""

    @property
    def numbers(self) -> tuple[str, ...]:
        """Names of the arguments that are numbers, in their order."""
        fields = self.skill.arguments_model.model_fields
        return tuple(name for name, info in fields.items() if is_number_type(info.annotation))


class Lexicon:
    """The words of a set of skills in one language, and its tokenizer."""

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

    @cached_property
    def usual_places(self) -> Mapping[Words, str]:
        """The usual places of its language by their words, each as it is written."""
        return {self.tokenize(one): one for one in usual_places(self.book.code).values()}

    @cached_property
    def joined(self) -> Mapping[tuple[str, str], Mapping[str, str]]:
        """The names of each argument in one word, to their values; other usual places have none."""
        found = {}
        for place, names in self.names.items():
            found[place] = {"".join(name): word for name, word in names.items()}
            for words in self.usual_places:
                found[place].setdefault("".join(words), "")
        return found

    def knows(self, word: str) -> bool:
        """True for a word of a skill, of a name, or of the function words."""
        return self.speaks(word) or word in self._functions or word in self._named

    def in_a_name(self, word: str) -> bool:
        """True for a word of a name."""
        return word in self._named

    def phrase(self, text: str) -> Words:
        """The tokens of a phrase from the tables, as in sentences: "1st" for "first"."""
        if text not in self._phrases:
            self._phrases[text] = self.tokenize(digits(text, self.book.code))
        return self._phrases[text]

    def as_written(self, phrases: tuple[str, ...]) -> PhraseIndex:
        """An index as `index`, but with number words kept as words.

        "Metre" must not become "1 metre". A phrase of several words counts in both forms: "in a
        second" and "in a 2nd".
        """
        if phrases not in self._written:
            several = (one for one in map(self.phrase, phrases) if len(one) > 1)
            self._written[phrases] = PhraseIndex((*map(self.tokenize, phrases), *several))
        return self._written[phrases]

    def index(self, phrases: tuple[str, ...]) -> PhraseIndex:
        """The index that finds these phrases in sentences."""
        if phrases not in self._indices:
            self._indices[phrases] = PhraseIndex(map(self.phrase, phrases))
        return self._indices[phrases]

    def outside(
        self, phrases: tuple[str, ...], longer: tuple[str, ...], tokens: Words
    ) -> Iterator[range]:
        """The places of phrases that begin in no longer one of these: "a bit", not "in a bit"."""
        around = [range(at, at + len(one)) for at, one in self.index(longer).find(tokens)]
        for at, one in self.index(phrases).find(tokens):
            if not any(at in other and len(other) > len(one) for other in around):
                yield range(at, at + len(one))

    def spelled(self, tokens: Words) -> Words:
        """The tokens with misheard and misspelt words corrected: see `_spelled`."""
        for written, said in self._misheard:
            for at in reversed(find(tokens, written)):
                tokens = (*tokens[:at], *said, *tokens[at + len(written) :])
        return tuple(
            self._spelled(one, tokens[max(0, at - 2) : at]) for at, one in enumerate(tokens)
        )

    def _spelled(self, word: str, before: Words) -> str:
        """The known word that an unknown one stands for: "trun" is "turn".

        A known word has the same letters or differs in one letter; or it is the verb of a gerund,
        after a word that allows one.
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
        """True for a word of skills that take several numbers, and of no other skills."""
        knowing = [one for one in self.words.values() if word in one.weights]
        several = [one for one in knowing if len(one.numbers) > 1]
        others = [one for one in knowing if one.skill.choices or len(one.numbers) == 1]
        return bool(several) and not others

    def speaks(self, word: str) -> bool:
        """True for a word of some skill's sentences."""
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
        """The amounts that stand right after a number in a skill's templates."""
        texts = (plain(self.book.written_out(one)) for one in self.book.templates(one))
        written = [found[1] for text in texts for found in _BEHIND_SLOT.finditer(text)]
        words = {plain(amount) for amount in self.function_words.amounts}
        if not self.book.hearing.spaced:
            return frozenset(word for word in words if any(word in text for text in written))
        return frozenset(words & {word for text in written for word in _WORD.findall(text)})

    def _name_words(self, chunks: Mapping[str, Mapping[str, float]]) -> dict[str, int]:
        """Words of skills' names that tell skills apart, each with the number of those names.

        They count for these skills alone, even if a courtesy of other skills holds them: "right
        now". What opens the sentences of several other skills tells nothing apart: "drive" is not
        of `drive_forward` alone.
        """
        if self.book.fallback is not None:
            return {}
        counts = Counter(word for name in chunks for word in set(_parts(name)))
        opened = {n: openers(self.book.templates(one), self.book) for n, one in self.skills.items()}
        return {
            word: n
            for word, n in counts.items()
            if n * 2 <= len(chunks)
            and word not in self.function_words.fillers
            and sum(word in opened[name] for name in chunks if word not in _parts(name)) < _SEVERAL
        }


def _letters(word: str) -> tuple[str, str]:
    """A key that a word shares with all reorderings of its letters after the first."""
    return word[:1], "".join(sorted(word))


def _is_one_off(one: str, other: str) -> bool:
    """True if the words differ in one letter, missing, added or replaced, but not the first."""
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
    """The words of a skill's sentences with their weights, 1 for those of its templates."""
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
    """Words right after a number in a skill's templates, by argument."""
    units: dict[str, set[str]] = {}
    for template in book.templates(one):
        written = plain(book.written_out(template))
        for match in re.finditer(rf"\{{(\w+)\}}\s*({_GROUP})?", written):
            units.setdefault(match[1], set()).update(_WORD.findall(match[2] or ""))
    return {name: frozenset(words) for name, words in units.items()}
