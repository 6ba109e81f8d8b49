"""Names of places, rooms, things and skills: none may take what people need to say.

The language can change while a robot runs, so every language counts, whichever is spoken now.
"""

from collections.abc import Iterable, Iterator, Mapping
from functools import cache
from itertools import product

from hassil.expression import Alternative, Expression, RuleReference, Sequence, TextChunk
from hassil.parse_expression import parse_sentence

from edgevox.agent.phrase_file import ENGLISH, phrasebook
from edgevox.agent.safety import find_stop_word
from edgevox.agent.skills import OneOf, Skill
from edgevox.agent.spelling import key
from edgevox.core.errors import InvalidValue
from edgevox.core.languages import LANGUAGES

_STOP = "stop"
"""The skill that halts a body; it may be called what it is."""


def check_name(field: str, name: str) -> None:
    """Raise `InvalidValue`, naming `field`, for a name that people need for something else.

    That is one that holds a stop word of any language, or that is what people say to answer, or to
    stop, in one of them.
    """
    said = name.replace("_", " ")
    for code in sorted(LANGUAGES, key=lambda code: code != ENGLISH):
        language = LANGUAGES[code].name
        if word := find_stop_word(code, said):
            raise InvalidValue(
                field, name, f"a name without {word!r}, which stops the robot in {language}"
            )
        if key(said) in _taken(code):
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
            for name in (*choices.words, *choices.aliases):
                check_name(f"{one.name}.{argument}", name)


def word_meant(name: str, choices: OneOf) -> str | None:
    """The word of these that people mean by a name in any language; None if it is another."""
    known = {key(said): word for said, word in choices.aliases.items()}
    known |= {key(word): word for word in choices.words}
    meant = (key(name), *_heard_anywhere().get(key(name), ()))
    return next((known[one] for one in meant if one in known), None)


def is_clause_word(name: str) -> bool:
    """Whether it stands for something else in any language: "here", "it", "and"."""
    return any(key(name) in phrasebook(code).hearing.clause_words for code in LANGUAGES)


@cache
def _heard_anywhere() -> Mapping[str, list[str]]:
    """What people say for the words of all phrasebooks, to those words, all in one spelling."""
    found: dict[str, list[str]] = {}
    for code in LANGUAGES:
        for word, forms in phrasebook(code).words.items():
            for said in forms.heard:
                found.setdefault(key(said), []).append(word)
    return found


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
