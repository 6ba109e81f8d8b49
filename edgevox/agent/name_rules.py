"""Names of places, rooms, things and skills: none may take what people need to say.

The language can change while a robot runs, so every language counts, whichever is spoken now.
"""

import re
from collections.abc import Collection, Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import cache
from itertools import product

from hassil import Intents, recognize_all
from hassil.expression import (
    Alternative,
    Expression,
    RuleReference,
    Sentence,
    Sequence,
    TextChunk,
)
from hassil.intents import Intent, IntentData, WildcardSlotList
from hassil.parse_expression import parse_sentence

from edgevox.agent.choices import OwnName
from edgevox.agent.numbers import digits
from edgevox.agent.own_names import heard, without_article
from edgevox.agent.phrase_calls import written_out
from edgevox.agent.phrase_file import ENGLISH, phrasebook
from edgevox.agent.safety import find_stop_word
from edgevox.agent.same_name import name_form, names_meant
from edgevox.agent.skills import OneOf, Skill
from edgevox.agent.spelling import folded, key, separated
from edgevox.core.errors import InvalidValue
from edgevox.core.languages import LANGUAGES
from edgevox.core.text import one_form

_SLOT = re.compile(r"\{(?:\w+:)?(\w+)\}")
_SYNTAX = re.compile(r"[()\[\]|<>]")
_PLACE_SLOTS = frozenset({"room", "location", "place", "target", "value"})
_NUMBER_SLOTS = frozenset({"distance", "degrees", "x", "y", "z", "count", "percent"})
_NAME_SLOTS = frozenset({"name"})
_SLOTS = _PLACE_SLOTS | _NUMBER_SLOTS | _NAME_SLOTS
_STOP = "stop"
"""The skill that halts a body; it may be called what it is."""


def check_name(field: str, name: str) -> None:
    """Raise `InvalidValue`, naming `field`, for a name that people need for something else.

    That is one that holds a stop word of any language, or that is what people say to answer, or to
    stop, in one of them.
    """
    said = name.replace("_", " ")
    spelled = key(said)
    for code in sorted(LANGUAGES, key=lambda code: code != ENGLISH):
        language = LANGUAGES[code].name
        if word := find_stop_word(code, said):
            raise InvalidValue(
                field, name, f"a name without {word!r}, which stops the robot in {language}"
            )
        if spelled in _taken(code):
            raise InvalidValue(
                field, name, f"another name: people say {said!r} to a robot in {language}"
            )


def check_skills(skills: Iterable[Skill]) -> None:
    """The same for the names of skills, and the words that their arguments may be.

    Raises `InvalidValue` naming the skill, and its argument.
    """
    for one in skills:
        if one.name != _STOP:
            check_name("skill", one.name)
        for argument, choices in one.choices.items():
            said = [
                name
                for one in choices.names.values()
                for each in one.values()
                for name in (each.name, *each.heard)
            ]
            for name in (*choices.words, *choices.aliases, *said):
                check_name(f"{one.name}.{argument}", name)


def word_meant(name: str, choices: OneOf) -> str | None:
    """The word of these that people mean by a name in any language; None if it is another."""
    return next(iter(names_meant(name, names_of(choices))), None)


def names_of(choices: OneOf) -> Mapping[str, str]:
    """Everything that people say for these words in any language, to the words."""
    known = dict(choices.aliases)
    for word, by_code in choices.names.items():
        known |= {said: word for code, one in by_code.items() for said in heard(code, one)}
    return {**known, **_common_words(choices.words), **{word: word for word in choices.words}}


def is_sentence(name: str, places: Mapping[str, str]) -> bool:
    """Whether people say it to a robot to make it do something, or to ask it, in any language.

    "go back" and "home" are such sentences, and so is one with a number or one of these `places` in
    it: "go to the kitchen". Nor may the order to go there be one to go to one of them: "kitchen
    now", "kitchen and office". The places are as `names_of` gives them.
    """
    forms = frozenset(map(name_form, places))
    return any(_is_said_in(code, name, forms) for code in LANGUAGES)


def is_clause_word(name: str, languages: Iterable[str] = tuple(LANGUAGES)) -> bool:
    """Whether it stands for something else in one of these languages: "here", "it", "and"."""
    spelled = key(name)
    return any(spelled in phrasebook(code).hearing.clause_words for code in languages)


def bare_name(code: str, name: str) -> str:
    """A name in this language without its article, as it stands behind any."""
    return without_article(code, name)


def name_clash(
    entries: Mapping[str, tuple[Iterable[str], Mapping[str, OwnName]]],
) -> tuple[str, str, str, str] | None:
    """Whose name, in which language, which it is, and whose it is, too; None if all differ.

    `entries` are the aliases, which count in every language, and the names by language of words.
    The language is empty where it is an alias, or the word itself.
    """
    owners: dict[str, str] = {}
    for word, (aliases, _) in entries.items():
        for said in (word, *aliases):
            if (owner := owners.setdefault(name_form(said), word)) != word:
                return word, "", said, owner
    for code in LANGUAGES:
        spoken = dict(owners)
        for word, (_, names) in entries.items():
            for said in heard(code, names[code]) if code in names else ():
                if (owner := spoken.setdefault(name_form(said), word)) != word:
                    return word, code, said, owner
    return None


def _common_words(words: Iterable[str]) -> Mapping[str, str]:
    """What people say in any language for those of these words that all phrasebooks know."""
    forms = {name_form(word): word for word in words}
    return {said: forms[form] for form in forms for said in _heard_anywhere().get(form, ())}


@cache
def _heard_anywhere() -> Mapping[str, tuple[str, ...]]:
    """What people say for the words of all phrasebooks, by the form of these words."""
    found: dict[str, tuple[str, ...]] = {}
    for code in LANGUAGES:
        for word, forms in phrasebook(code).words.items():
            form = name_form(word)
            found[form] = (*found.get(form, ()), *forms.heard)
    return found


@dataclass(frozen=True, slots=True)
class _SpokenTemplate:
    """A template without rules, its slots, and the words that stand in it.

    Where words are written without spaces, these are its letters.
    """

    template: str
    words: frozenset[str]
    slots: frozenset[str]
    _kept: list[Sentence] = field(default_factory=list)

    def may_be(self, words: frozenset[str], *, holds: bool, numbered: bool) -> bool:
        """Whether a name of these words may be one of its sentences; rules out most at once."""
        if not self.slots:
            return words <= self.words
        fits = bool(words & self.words)
        if self.slots & _PLACE_SLOTS:
            fits = fits and holds
        return fits and (numbered or not self.slots & _NUMBER_SLOTS)

    @property
    def parsed(self) -> Sentence:
        """As hassil has it; parsed when it is first needed."""
        if not self._kept:
            self._kept.append(parse_sentence(self.template, keep_text=True))
        return self._kept[0]


def _is_said_in(code: str, name: str, places: Collection[str]) -> bool:
    book = phrasebook(code)
    plain = key(name)
    holds = _holds_one(plain, places)
    verb, _, _ = book.programs.go.partition(" ")  # "go", so that no place is called "back"
    if any(_is_said(code, said, places, holds=holds) for said in (plain, key(f"{verb} {name}"))):
        return True
    if not holds:
        return False
    go = book.programs.go.replace("{place}", name)
    joints = "|".join(re.escape(key(one)) for one in (*book.hearing.joints, *book.programs.between))
    edge = r"\b" if book.hearing.spaced else ""
    parts = re.split(f"{edge}(?:{joints}){edge}", plain) if joints else []
    return bool(go and _is_said(code, key(go), places, holds=True)) or (
        len(parts) > 1 and any(name_form(part) in places for part in parts)
    )


def _holds_one(plain: str, places: Collection[str]) -> bool:
    """Whether a part of it is the name of a place."""
    words = plain.split() if " " in plain else plain
    space = " " if " " in plain else ""
    ends = ((start, end) for end in range(1, len(words) + 1) for start in range(end))
    return any(name_form(space.join(words[start:end])) in places for start, end in ends)


def _is_said(code: str, plain: str, places: Collection[str], *, holds: bool) -> bool:
    """`holds`: a part of it is the name of one of the places."""
    spaced = phrasebook(code).hearing.spaced
    text = plain if spaced else plain.replace(" ", "")
    words = frozenset(plain.split() if spaced else text)
    numbered = any(one.isdigit() for one in digits(text, code))
    fitting = [one for one in _sentences(code) if one.may_be(words, holds=holds, numbered=numbered)]
    if not fitting:
        return False
    data = IntentData([], slot_lists={name: WildcardSlotList(name) for name in _SLOTS})
    vars(data)["sentences"] = [one.parsed for one in fitting]  # where it keeps what it would parse
    found = recognize_all(text, Intents(code, {"said": Intent("said", [data])}))
    return any(
        all(_fills(code, name, one.text.strip(), places) for name, one in each.entities.items())
        for each in found
    )


def _fills(code: str, slot: str, text: str, places: Collection[str]) -> bool:
    """Whether this is what stands in such a slot."""
    if slot in _PLACE_SLOTS:
        return name_form(text) in places
    if slot in _NUMBER_SLOTS:
        return any(one.isdigit() for one in digits(text, code))
    return slot in _NAME_SLOTS


@cache
def _sentences(code: str) -> tuple[_SpokenTemplate, ...]:
    """All that skills, questions and programs are asked for by in this language."""
    book = phrasebook(code)
    said = [
        written_out(template, book.rules)
        for entries in (book.skills, book.dialogue)
        for one in entries.values()
        for template in one.templates
    ]
    said += [
        written_out(template, book.programs.rules)
        for templates in book.programs.templates.values()
        for template in templates
    ]
    spelled = (folded(separated(one_form(one))) for one in said)
    return tuple(
        _SpokenTemplate(one, _literals(one, spaced=book.hearing.spaced), frozenset(slots))
        for one in spelled
        if _SLOTS.issuperset(slots := _SLOT.findall(one))
    )


def _literals(template: str, *, spaced: bool) -> frozenset[str]:
    text = key(_SYNTAX.sub(" ", _SLOT.sub(" ", template)))
    return frozenset(text.split() if spaced else text)


@cache
def _taken(code: str) -> frozenset[str]:
    """What people say in this language that is no name, in the spelling of `key`."""
    book = phrasebook(code)
    stopping = (
        sentence
        for template in book.skills[_STOP].templates
        for sentence in _shortest(parse_sentence(template).expression, book.rules)
    )
    said = (*book.hearing.reserved, *book.answers.yes, *book.answers.no, *stopping)
    return frozenset(map(key, said))


def _shortest(part: Expression, rules: Mapping[str, str]) -> Iterator[str]:
    """The sentences that a template is, without anything that may be left out."""
    match part:
        case TextChunk():
            yield part.original_text
        case Alternative(is_optional=True):
            yield ""
        case Alternative():
            for item in part.items:
                yield from _shortest(item, rules)
        case Sequence():
            for parts in product(*(tuple(_shortest(item, rules)) for item in part.items)):
                yield "".join(parts)
        case RuleReference(rule_name=rule):
            yield from _shortest(parse_sentence(rules[rule]).expression, rules)
        case _:
            raise TypeError(part)
