"""Compiles the sentence templates of skills for hassil, in the words of one language."""

from functools import lru_cache
from typing import Any

from hassil import Intents
from hassil.intents import TextSlotList

from edgevox.agent.numbers import digits
from edgevox.agent.phrase_hearing import Hearing
from edgevox.agent.phrasebook import Phrasebook
from edgevox.agent.skills import OneOf, Skill, SkillSet
from edgevox.agent.spelling import folded, key, separated
from edgevox.core.text import one_form


def compile_templates(skills: SkillSet, book: Phrasebook, *, loose: bool) -> Intents:
    """Intents, one per skill; `loose` lets any words stand where one of some words should."""
    templates = {
        name: book.templates(one) for name, one in skills.items() if not loose or one.choices
    }
    data = {
        name: {
            "data": [
                {
                    "sentences": [_pattern(sentence) for sentence in sentences],
                    "lists": _lists(skills[name], book, loose=loose),
                }
            ]
        }
        for name, sentences in templates.items()
        if sentences
    }
    rules = {name: _pattern(rule) for name, rule in book.rules.items()}
    return Intents.from_dict({"language": book.code, "intents": data, "expansion_rules": rules})


def _pattern(template: str) -> str:
    return folded(separated(one_form(template)))


def written(text: str, hearing: Hearing) -> str:
    """With spaces only where the language has them between words."""
    return text if hearing.spaced else text.replace(" ", "")


def _lists(one: Skill, book: Phrasebook, *, loose: bool) -> dict[str, Any]:
    """Any words, but for what `learn` gives words to choose from; the book's usual places."""
    lists: dict[str, Any] = {
        name: {"wildcard": True} if loose or name not in one.choices else {"values": []}
        for name in one.arguments_model.model_fields
    }
    usual = [_pattern(place) for place in book.hearing.places]
    return lists | {"place": {"values": usual}} if one.new_names else lists


@lru_cache(maxsize=8192)
def _forms(said: str, code: str, *, spaced: bool) -> tuple[str, ...]:
    """How a word of a language may be written. Kept, for a new word is one of many."""
    plain = key(said)
    found = dict.fromkeys((digits(plain, code), plain))
    return tuple(found) if spaced else tuple(one.replace(" ", "") for one in found)


def word_list(choices: OneOf, book: Phrasebook) -> TextSlotList:
    """What may be said for these words, as it is written and with its numbers as digits."""
    spoken = {
        form: word
        for said, word in book.heard(choices).items()
        for form in _forms(said, book.code, spaced=book.hearing.spaced)
    }
    return TextSlotList.from_tuples(spoken.items(), allow_template=False)
