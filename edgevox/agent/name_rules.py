"""Names of places, rooms, things and skills: none may take what people need to say.

The language can change while a robot runs, so every language counts, whichever is spoken now.
"""

from collections.abc import Iterable, Iterator, Mapping
from functools import cache
from itertools import product

from hassil.expression import Alternative, Expression, RuleReference, Sequence, TextChunk
from hassil.parse_expression import parse_sentence

from edgevox.agent.choices import OwnName
from edgevox.agent.own_names import heard, without_article
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
    known = {key(said): word for said, word in choices.aliases.items()}
    known |= {
        key(said): word
        for word, by_code in choices.names.items()
        for code, one in by_code.items()
        for said in heard(code, one)
    }
    known |= {key(word): word for word in choices.words}
    meant = (key(name), *_heard_anywhere().get(key(name), ()))
    return next((known[one] for one in meant if one in known), None)


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
    """
    for code in LANGUAGES:
        owners = {key(one): word for word, (more, _) in entries.items() for one in (word, *more)}
        for word, (_, names) in entries.items():
            for said in heard(code, names[code]) if code in names else ():
                if (owner := owners.setdefault(key(said), word)) != word:
                    return word, code, said, owner
    return None


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
