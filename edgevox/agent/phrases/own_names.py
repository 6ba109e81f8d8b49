"""Phrasebooks of one robot: with the names that its own words have in each language.

What a file or a skill calls a word in a language is said there, and understood beside what the
phrasebook knows for it. What is said of it besides, "bei der Apotheke", comes from the article that
the name begins with, by the table `own_names` of the phrasebook.
"""

from collections.abc import Iterable, Mapping
from dataclasses import replace

from edgevox.agent.phrases.load import phrasebook
from edgevox.agent.phrases.phrasebook import Phrasebook
from edgevox.agent.skills import Skill
from edgevox.agent.skills.skill import OwnName
from edgevox.agent.text.spelling import key
from edgevox.agent.text.words import Word
from edgevox.core.files.text import one_form

_PLAIN = "plain"
"""The forms of a name without an article, in the table `own_names`."""


def phrasebook_of(code: str, skills: Iterable[Skill]) -> Phrasebook:
    """The phrasebook of a language, with the names of these skills' words and arguments."""
    return _named(phrasebook(code), tuple(skills))


def without_article(code: str, name: str) -> str:
    """A name as it stands behind any article: what people are understood by."""
    return _split(phrasebook(code), name)[1]


def heard(code: str, name: OwnName) -> tuple[str, ...]:
    """Everything that people may say for it, without articles."""
    return tuple(dict.fromkeys(without_article(code, one) for one in (name.name, *name.heard)))


def _named(book: Phrasebook, skills: tuple[Skill, ...]) -> Phrasebook:
    names = {
        key(word): by_code[book.code]
        for one in skills
        for choices in one.choices.values()
        for word, by_code in choices.names.items()
        if book.code in by_code
    }
    arguments = {
        name: called
        for one in skills
        if book.code in one.phrases
        for name, called in one.phrases[book.code].arguments.items()
    }
    fallback = _named(book.fallback, skills) if book.fallback else None
    if not names and not arguments and fallback is book.fallback:
        return book
    return replace(
        book,
        words=_words(book, names),
        arguments={**arguments, **book.arguments},
        fallback=fallback,
    )


def _words(book: Phrasebook, names: Mapping[str, OwnName]) -> Mapping[str, Word]:
    """The book's words and these; what one of these is called by is no other word's any more."""
    own = {word: _word(book, name) for word, name in names.items()}
    owners = {key(said): word for word, one in own.items() for said in one.heard}
    kept = {
        word: tuple(said for said in one.heard if owners.get(key(said), word) == word)
        for word, one in book.words.items()
    }
    others = {word: replace(one, heard=kept[word]) for word, one in book.words.items()}
    added = {
        word: replace(
            one,
            heard=tuple(dict.fromkeys((*one.heard, *kept.get(word, ())))),
            hints=book.words[word].hints if word in book.words else (),
        )
        for word, one in own.items()
    }
    return others | added


def _word(book: Phrasebook, name: OwnName) -> Word:
    article, bare = _split(book, name.name)
    forms = book.own_names.get(article, book.unknown).called(bare)
    return Word(
        name=forms.name,
        to=name.to or forms.to,
        at=name.at or forms.at,
        taken=name.taken or forms.taken,
        heard=heard(book.code, name),
    )


def _split(book: Phrasebook, name: str) -> tuple[str, str]:
    """The article that a name begins with, if the book has its forms, and the rest."""
    plain = one_form(name)
    for article in book.own_names.keys() - {_PLAIN}:
        start = article if article.endswith("'") else f"{article} "
        if plain.casefold().startswith(start) and len(plain) > len(start):
            return article, plain[len(start) :]
    return _PLAIN, plain
