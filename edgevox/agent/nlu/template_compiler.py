"""Compiles the sentence templates of skills for hassil, in the words of one language.

A template is parsed once in the life of the process, however many recognisers have it: one is made
for each agent, and again for each change of the language.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache

from hassil import Intents
from hassil.expression import Sentence
from hassil.intents import Intent, IntentData, SlotList, TextSlotList, WildcardSlotList
from hassil.parse_expression import parse_sentence

from edgevox.agent.choices import OneOf
from edgevox.agent.nlu.beginnings import ANY, beginnings, said
from edgevox.agent.numbers import digits
from edgevox.agent.phrase_hearing import Hearing
from edgevox.agent.phrasebook import Phrasebook
from edgevox.agent.skills import Skill, SkillSet
from edgevox.agent.spelling import folded, key, separated
from edgevox.core.languages import LANGUAGES
from edgevox.core.text import one_form

_MOST_TEMPLATES = 4096
"""How many parsed templates of a language are kept; all robots together have about 700."""

_Lists = dict[str, SlotList]


def compile_templates(skills: SkillSet, book: Phrasebook, *, loose: bool) -> "Templates":
    """Those of these skills; `loose` lets any words stand where one of some words should."""
    shared = _shared(book.code, tuple(book.rules.items()), book.hearing.places)
    templates = {
        name: book.templates(one) for name, one in skills.items() if not loose or one.choices
    }
    parsed = {name: [shared.template(one) for one in some] for name, some in templates.items()}
    lists = {name: shared.lists(skills[name], loose=loose) for name, some in parsed.items() if some}
    return Templates(book.code, shared.rules, parsed, lists)


class Templates:
    """The templates of some skills. `lists` are what may stand in the slots of each."""

    def __init__(
        self,
        code: str,
        rules: dict[str, Sentence],
        templates: Mapping[str, Sequence["_Template"]],
        lists: Mapping[str, _Lists],
    ) -> None:
        self._code = code
        self._rules = rules
        self._templates = templates
        self.lists = lists
        self._letters = set().union(*(one.begins for some in templates.values() for one in some))
        self._by_letter: dict[str, _Beginning] = {}

    def fitting(self, text: str) -> Intents:
        """Those that begin as this text does, one intent per skill."""
        begun = said(text)
        found = {}
        for name, some in self._beginning_with(begun[:1]).items():
            if fit := [one for one, begins in some if begun.startswith(begins)]:
                found[name] = _intent(name, fit, self.lists[name])
        return Intents(self._code, found, expansion_rules=self._rules)

    def _beginning_with(self, letter: str) -> "_Beginning":
        letter = letter if letter in self._letters else ANY
        if letter not in self._by_letter:
            self._by_letter[letter] = {
                name: [
                    (one.sentence, begins)
                    for one in some
                    if (begins := one.begins.get(letter) or one.begins.get(ANY))
                ]
                for name, some in self._templates.items()
            }
        return self._by_letter[letter]


@dataclass(frozen=True, slots=True)
class _Template:
    sentence: Sentence
    begins: Mapping[str, tuple[str, ...]]
    """What its sentences may begin with, by the first letter."""


_Beginning = dict[str, list[tuple[Sentence, tuple[str, ...]]]]
"""By skill, the templates of which a sentence begins with one letter, and with what else."""


def _intent(name: str, templates: list[Sentence], lists: _Lists) -> Intent:
    """Of templates that are parsed already, and of what may stand in their slots."""
    data = IntentData([], slot_lists=lists)
    vars(data)["sentences"] = templates  # where it keeps what it would parse itself
    return Intent(name, [data])


class _SharedTemplates:
    """What all templates of a language have in common, and those that were parsed."""

    def __init__(self, code: str, rules: Sequence[tuple[str, str]], places: Sequence[str]) -> None:
        shared = Intents.from_dict(
            {
                "language": code,
                "intents": {},
                "lists": {"place": {"values": [_pattern(place) for place in places]}},
                "expansion_rules": {name: _pattern(rule) for name, rule in rules},
            }
        )
        self.rules = shared.expansion_rules
        self._places = {name: _indexed(one) for name, one in shared.slot_lists.items()}
        self.template = lru_cache(_MOST_TEMPLATES)(self._read)

    def _read(self, template: str) -> _Template:
        sentence = parse_sentence(_pattern(template), keep_text=True)
        begins: dict[str, tuple[str, ...]] = {}
        for one in beginnings(sentence, self.rules):
            begins[one[:1]] = (*begins.get(one[:1], ()), one)
        return _Template(sentence, begins)

    def lists(self, one: Skill, *, loose: bool) -> _Lists:
        """Any words, but where words are given to choose from; the book's usual places."""
        lists: _Lists = {
            name: WildcardSlotList(name)
            if loose or name not in one.choices
            else TextSlotList(name, [])
            for name in one.arguments_model.model_fields
        }
        return lists | self._places if one.new_names else lists


_shared = lru_cache(len(LANGUAGES))(_SharedTemplates)


def _pattern(template: str) -> str:
    return folded(separated(one_form(template)))


def written(text: str, hearing: Hearing) -> str:
    """With spaces only where the language has them between words."""
    return text if hearing.spaced else text.replace(" ", "")


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
    return _indexed(TextSlotList.from_tuples(spoken.items(), allow_template=False))


def _indexed(words: TextSlotList) -> TextSlotList:
    """The same with its index made: two threads that look first would make it at once."""
    words.get_candidates("")
    return words
