"""Rules for names of places, rooms, things and skills: no name may be a sentence people need.

The language can change while a robot runs, so every language counts, whichever is spoken now.

`TemplateScanner` finds the words of a template without compiling it: few names share a word with
every part of a template, and only for those a template is compiled.
"""

import re
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache
from itertools import chain, product

from hassil import Intents, recognize_all
from hassil.expression import (
    Alternative,
    Expression,
    Group,
    RuleReference,
    Sentence,
    TextChunk,
)
from hassil.intents import Intent, IntentData, WildcardSlotList
from hassil.parse_expression import parse_sentence

from edgevox.agent.phrases.load import ENGLISH, phrasebook
from edgevox.agent.phrases.numbers import digits
from edgevox.agent.phrases.own_names import heard, without_article
from edgevox.agent.phrases.phrasebook import written_out
from edgevox.agent.skills import OneOf, Skill
from edgevox.agent.skills.skill import OwnName
from edgevox.agent.stop.words import find_stop_word
from edgevox.agent.text.same_name import name_form, names_meant
from edgevox.agent.text.spelling import folded, key, separated, unpunctuated
from edgevox.core.errors import InvalidValue
from edgevox.core.files.text import one_form
from edgevox.core.languages import LANGUAGES

_PART = re.compile(r"[][()|]|<\w+>|\{[^}]*\}|[^][()|<>{}]+")
_ENDS = {"[": "]", "(": ")"}

_Needs = tuple[frozenset[str], ...]


@dataclass(frozen=True, slots=True)
class TemplateWords:
    """The words of a template, and its slots; of each set of `needs` it takes one word at least.

    Where words are written without spaces, these are letters.
    """

    words: frozenset[str]
    needs: _Needs
    slots: frozenset[str]


class TemplateScanner:
    """Finds them for the templates that share some rules."""

    def __init__(self, rules: Mapping[str, str], *, spaced: bool) -> None:
        self._rules = rules
        self._spaced = spaced
        self._known: dict[str, TemplateWords] = {}

    def scan(self, template: str) -> TemplateWords:
        """The words of a template, and of the rules in it."""
        spelled = folded(separated(one_form(template))).casefold()
        return self._alternatives(iter(_PART.findall(spelled)), "")

    def _alternatives(self, parts: Iterator[str], end: str) -> TemplateWords:
        """What there is to choose from, up to the end of the group."""
        choices: list[list[TemplateWords]] = [[]]
        before = " "
        for part in parts:
            if part == end:
                break
            if part == "|":
                choices.append([])
                before = " "
                continue
            found = self._part(part, parts)
            touches = self._spaced and not (before[-1].isspace() or part[0].isspace())
            if touches:  # what they say is no whole word
                found = TemplateWords(found.words, (), found.slots)
                choices[-1][-1:] = [TemplateWords(o.words, (), o.slots) for o in choices[-1][-1:]]
            choices[-1].append(found)
            before = part
        return _chosen(list(map(_in_turn, choices)))

    def _part(self, part: str, parts: Iterator[str]) -> TemplateWords:
        match part[0]:
            case "[" | "(":
                found = self._alternatives(parts, _ENDS[part])
                return found if part == "(" else TemplateWords(found.words, (), found.slots)
            case "<":
                rule = part[1:-1]
                if rule not in self._known:
                    self._known[rule] = self.scan(self._rules[rule])
                return self._known[rule]
            case "{":
                slot = part[1:-1].rpartition(":")[2]
                return TemplateWords(frozenset(), (), frozenset((slot,)))
        text = unpunctuated(part)
        words = text.split() if self._spaced else [one for one in text if one != " "]
        return TemplateWords(
            frozenset(words), tuple(frozenset((one,)) for one in words), frozenset()
        )


def _in_turn(parts: list[TemplateWords]) -> TemplateWords:
    if len(parts) == 1:
        return parts[0]
    return TemplateWords(
        frozenset().union(*[one.words for one in parts]),
        tuple(chain.from_iterable([one.needs for one in parts])),
        frozenset().union(*[one.slots for one in parts]),
    )


def _chosen(choices: list[TemplateWords]) -> TemplateWords:
    if len(choices) == 1:
        return choices[0]
    needs: _Needs = ()
    if all(one.needs for one in choices):
        needs = (frozenset().union(*[min(one.needs, key=len) for one in choices]),)
    both = _in_turn(choices)
    return TemplateWords(both.words, needs, both.slots)


_PLACE_SLOTS = frozenset({"room", "location", "place", "target", "value"})
_NUMBER_SLOTS = frozenset({"distance", "degrees", "x", "y", "z", "count", "percent"})
_NAME_SLOTS = frozenset({"name"})
_SLOTS = _PLACE_SLOTS | _NUMBER_SLOTS | _NAME_SLOTS
_STOP = "stop"
"""The skill that halts a body; it may be called what it is."""


def check_name(field: str, name: str) -> None:
    """Raise `InvalidValue`, naming `field`, for a name that people need for something else.

    Such a name holds a stop word of any language, or is an answer or a general command in one.
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
    """Check the names of skills, and the words of their arguments, as `check_name` does.

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
    """True if a name is a command or a question to a robot in any language.

    "go back" and "home" are such sentences, and so is one with a number or one of these `places` in
    it: "go to the kitchen". Nor may the order to go there be one to go to one of them: "kitchen
    now", "kitchen and office". The places are as `names_of` gives them.
    """
    forms = frozenset(map(name_form, places))
    plain = key(name)
    held = _places_in(plain, forms)
    return any(_is_said_in(code, plain, forms, held) for code in LANGUAGES)


def is_clause_word(name: str, languages: Iterable[str] = tuple(LANGUAGES)) -> bool:
    """True if a name is a function word in one of these languages: "here", "it", "and"."""
    spelled = key(name)
    return any(spelled in phrasebook(code).hearing.clause_words for code in languages)


def bare_name(code: str, name: str) -> str:
    """A name in this language without its article, as it stands behind any."""
    return without_article(code, name)


def name_clash(
    entries: Mapping[str, tuple[Iterable[str], Mapping[str, OwnName]]],
) -> tuple[str, str, str, str] | None:
    """The first name that two words share: word, language, name, other word; None if all differ.

    `entries` has for each word its aliases, which count in every language, and its names by
    language. The language is empty for an alias, and for the word itself.
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
    """Spoken forms, in any language, of those words that phrasebooks know, to the words."""
    forms = {name_form(word): word for word in words}
    return {said: forms[form] for form in forms for said in _heard_anywhere().get(form, ())}


@cache
def _heard_anywhere() -> Mapping[str, tuple[str, ...]]:
    """Spoken forms of the words of all phrasebooks, by the words' name forms."""
    found: dict[str, tuple[str, ...]] = {}
    for code in LANGUAGES:
        for word, forms in phrasebook(code).words.items():
            form = name_form(word)
            found[form] = (*found.get(form, ()), *forms.heard)
    return found


@dataclass(frozen=True, slots=True)
class _SpokenTemplate:
    """A template with the rules that it names, and its words: it is parsed when it may fit."""

    template: str
    rules: Mapping[str, str]
    its: TemplateWords
    _kept: list[Sentence] = field(default_factory=list)

    def may_be(self, words: frozenset[str], held: str) -> bool:
        """Whether a name of these words may be one of its sentences; rules out most at once.

        `held` are the parts of it that are names of places.
        """
        slots = self.its.slots
        if any(one.isdisjoint(words) for one in self.its.needs):
            return False
        if not slots <= _PLACE_SLOTS:
            return bool(held) or not slots & _PLACE_SLOTS
        return all(one in self.its.words or (slots and one in held) for one in words)

    @property
    def parsed(self) -> Sentence:
        """As hassil has it; parsed when it is first needed."""
        if not self._kept:
            spelled = folded(separated(one_form(written_out(self.template, self.rules))))
            self._kept.append(parse_sentence(spelled, keep_text=True))
        return self._kept[0]


def _is_said_in(code: str, plain: str, places: Collection[str], held: str) -> bool:
    """`held` are its parts that are the names of some of the places."""
    book = phrasebook(code)
    words = plain.split() if book.hearing.spaced else plain
    if not _vocabulary(code).isdisjoint(words) or all(one in held for one in words):
        verb, _, _ = book.programs.go.partition(" ")  # "go", so that no place is called "back"
        go = book.programs.go.replace("{place}", plain) if held else ""
        said = dict.fromkeys((plain, key(f"{verb} {plain}"), key(go)))
        if any(one and _is_said(code, one, places, held) for one in said):
            return True
    parts = _joint(code).split(plain) if held else []
    return len(parts) > 1 and any(name_form(part) in places for part in parts)


@cache
def _joint(code: str) -> re.Pattern[str]:
    """What joins two orders in this language."""
    book = phrasebook(code)
    joints = "|".join(re.escape(key(one)) for one in (*book.hearing.joints, *book.programs.between))
    edge = r"\b" if book.hearing.spaced else ""
    return re.compile(f"{edge}(?:{joints}){edge}" if joints else r"(?!)")


def _places_in(plain: str, places: Collection[str]) -> str:
    """The parts of it that are names of places, one after the other."""
    words = plain.split() if " " in plain else plain
    space = " " if " " in plain else ""
    ends = ((start, end) for end in range(1, len(words) + 1) for start in range(end))
    parts = (space.join(words[start:end]) for start, end in ends)
    return " ".join(part for part in parts if name_form(part) in places)


def _is_said(code: str, plain: str, places: Collection[str], held: str) -> bool:
    spaced = phrasebook(code).hearing.spaced
    text = plain if spaced else plain.replace(" ", "")
    words = frozenset(plain.split() if spaced else text)
    templates = _templates(code)
    likely = (one for word in (*words, "") for one in templates.get(word, ()))
    fitting = [one for one in likely if one.may_be(words, held)]
    if any(one.its.slots & _NUMBER_SLOTS for one in fitting) and not _has_number(text, code):
        fitting = [one for one in fitting if not one.its.slots & _NUMBER_SLOTS]
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
    return _has_number(text, code) if slot in _NUMBER_SLOTS else slot in _NAME_SLOTS


def _has_number(text: str, code: str) -> bool:
    return any(one.isdigit() for one in digits(text, code))


@cache
def _vocabulary(code: str) -> frozenset[str]:
    """The words, or letters, of all these templates: each takes one of them at least."""
    book = phrasebook(code)
    parts = [*book.skills.values(), *book.dialogue.values()]
    texts = [
        *chain.from_iterable(one.templates for one in parts),
        *chain.from_iterable(book.programs.templates.values()),
        *book.rules.values(),
        *book.programs.rules.values(),
    ]
    text = key(" ".join(texts))
    return frozenset(text.split() if book.hearing.spaced else text)


@cache
def _templates(code: str) -> Mapping[str, Sequence[_SpokenTemplate]]:
    """All that skills, questions and programs are asked for by in this language.

    They are kept by the words of which one must be said for them; by "" where none must.
    """
    book = phrasebook(code)
    programs = chain.from_iterable(book.programs.templates.values())
    spoken = (one.templates for part in (book.skills, book.dialogue) for one in part.values())
    found: dict[str, list[_SpokenTemplate]] = {}
    for rules, templates in (
        (book.rules, chain.from_iterable(spoken)),
        (book.programs.rules, programs),
    ):
        scanner = TemplateScanner(rules, spaced=book.hearing.spaced)
        for template in templates:
            its = scanner.scan(template)
            if its.slots <= _SLOTS:
                one = _SpokenTemplate(template, rules, its)
                for word in min(its.needs, key=len, default=("",)):
                    found.setdefault(word, []).append(one)
    return found


@cache
def _taken(code: str) -> frozenset[str]:
    """Sentences of this language that are no names, in the spelling of `key`."""
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
        case Group():
            for parts in product(*(tuple(_shortest(item, rules)) for item in part.items)):
                yield "".join(parts)
        case RuleReference(rule_name=rule):
            yield from _shortest(parse_sentence(rules[rule]).expression, rules)
        case _:
            raise TypeError(part)
