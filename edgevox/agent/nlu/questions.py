"""Questions to the robot: what is asked, and what a language model may answer.

A model knows nothing of the robot and its world. A question about them that no fact answers gets
"I do not know that", and an answer to a question about the robot is held against what it names.
"""

import re
from collections.abc import Iterable
from functools import cached_property

from edgevox.agent.nlu.decider import QUESTION_MARKS, Judged
from edgevox.agent.nlu.lexicon import plain, words_of
from edgevox.agent.phrases.numbers import digits
from edgevox.agent.phrases.phrasebook import Phrasebook
from edgevox.agent.skills import Call, Skill
from edgevox.agent.text.spelling import NUMBER, key
from edgevox.core.languages import LANGUAGES

_LEAST_TOLD = 4.0, 2.8
"""Least weight of the words for a question that names nothing of the robot's world, and for one
that does."""
_LEAST_LEAD = 2.0, 1.0
"""Least lead in weight over another question, for either."""
_MOST_STRANGE = 0.17, 0.25
"""Largest share of unknown words in either: "how fast is light" is no question to the robot."""


def question_of(judged: Judged | None, text: str, code: str) -> Call | None:
    """The one thing that a sentence asks, of skills that only tell; None if that is not clear.

    It needs no encoder: an answer moves nothing, so the words of the questions are enough.
    """
    if judged is None or len(judged.reading.parts) != 1 or not asks(text, code):
        return None
    (part,), facts = judged.reading.parts, judged.evidence
    named = part.grounded > 0
    told = part.support >= _LEAST_TOLD[named]
    known = facts["share_strange"] <= _MOST_STRANGE[named] and not facts["strange_unfilled"]
    clear = part.support - part.rival >= _LEAST_LEAD[named] and not facts["denied"]
    return part.call if told and known and clear else None


def asks(text: str, code: str) -> bool:
    """True if the text has a question mark or begins with a question word, and asks for no act."""
    words, said = words_of(code), f"{plain(text)} "
    wishes = (*words.asking, *words.abilities, *words.wishes)
    if any(said.startswith(f"{plain(one)} ") for one in wishes):
        return False
    asks = any(mark in text for mark in QUESTION_MARKS)
    return asks or any(said.startswith(f"{plain(one)} ") for one in words.questions)


def asks_whether(text: str, code: str) -> bool:
    """True if the words ask about an ability other than to talk: "can you fly".

    "How many hours can you run" asks how many.
    """
    words = words_of(code)
    said = f" {plain(text)} "
    asked = [plain(one) for one in words.abilities if plain(one) in said]
    first = [one for one in map(plain, words.questions) if said.startswith(f" {one} ")]
    if first and not any(said.startswith(f" {one} ") for one in asked):
        return False
    for one in asked:
        said = said.replace(one, " ")
    return bool(asked) and not _holds(said, words.talking, code)


def is_about_hearer(text: str, code: str) -> bool:
    """True if the words speak of the hearer, other than to ask politely: "how old are you"."""
    words = words_of(code)
    said = f" {plain(text)} "
    for one in sorted((*words.asking, *words.abilities, *words.talking), key=len, reverse=True):
        said = said.replace(plain(one), " ")
    return _holds(said, words.you, code)


def _holds(text: str, phrases: Iterable[str], code: str) -> bool:
    """True if one of these phrases stands in the text; as whole words, where there are words."""
    spaced = LANGUAGES[code].spaced
    said = f" {key(text)} "
    return any((f" {key(one)} " if spaced else key(one)) in said for one in phrases)


class WorldWords:
    """The words for the things and places of some skills' arguments, as at its first use."""

    def __init__(self, skills: Iterable[Skill], book: Phrasebook) -> None:
        self._skills = tuple(skills)
        self._book = book

    def named_in(self, text: str) -> bool:
        """True if the text names a thing or a place of the robot's world."""
        return _holds(text, self._forms, self._book.code)

    def claimed_in(self, sentence: str) -> bool:
        """True if the sentence names such a thing, or a number."""
        numbers = _NUMBER.findall(digits(sentence, self._book.code))
        return any(float(one) != 1 for one in numbers) or self.named_in(sentence)

    @cached_property
    def _forms(self) -> frozenset[str]:
        """All names, without those that are only a part of another: "red" of "red cube"."""
        known = {
            key(form): word
            for one in self._skills
            for choices in one.choices.values()
            for form, word in self._book.heard(choices).items()
            if word != _IT
        }
        parts = {part for form in known if " " in form for part in form.split()}
        return frozenset(known.keys() - (parts - {key(word) for word in known.values()}))


_NUMBER = re.compile(NUMBER)
_IT = "it"
"""Pronoun for the thing spoken of last; it names nothing."""
_SENTENCE_END = re.compile(r"(?<=[.!?\u061f\u0964])\s+|(?<=[\u3002\uff01\uff1f])")


class CheckedAnswer:
    """Lets the sentences of a model's answer pass that claim nothing of the robot's world."""

    def __init__(self, world: WorldWords) -> None:
        self._world = world
        self._rest = ""
        self.dropped = False
        """True if a sentence was held back; what follows it is held back as well."""

    def feed(self, piece: str) -> str:
        """The sentences that ended in this piece and may be said."""
        *ended, self._rest = _SENTENCE_END.split(self._rest + piece)
        return "".join(self._passed(one) for one in ended)

    def finish(self) -> str:
        """The last sentence, if it may be said."""
        rest, self._rest = self._rest, ""
        return self._passed(rest)

    def _passed(self, sentence: str) -> str:
        self.dropped = self.dropped or self._world.claimed_in(sentence)
        return "" if self.dropped or not sentence else f"{sentence} "
