"""The recogniser of plain commands: it matches the skills' sentence templates in milliseconds.

`compile_templates` compiles the templates for hassil, in the words of one language. Each template
is parsed once per process, although each agent and each change of language makes a recogniser.

`beginnings` finds how the sentences of a template begin. A sentence is tried only on templates that
begin as it does: most begin with another verb, and trying a template with many forms takes longer
than all other work on a sentence.
"""

import difflib
import re
import threading
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

from hassil import Intents, RecognizeResult, expression, recognize_all
from hassil.expression import (
    Alternative,
    Expression,
    Group,
    ListReference,
    RuleReference,
    Sentence,
    TextChunk,
)
from hassil.intents import Intent, IntentData, SlotList, TextSlotList, WildcardSlotList
from hassil.parse_expression import parse_sentence
from hassil.util import normalize_for_matching

from edgevox.agent.phrases.load import ENGLISH, phrasebook
from edgevox.agent.phrases.numbers import digits, is_exact
from edgevox.agent.phrases.own_names import phrasebook_of
from edgevox.agent.phrases.phrasebook import Phrasebook, brief, whole
from edgevox.agent.phrases.tables import Hearing
from edgevox.agent.skills import NO_SKILLS, Call, Skill, SkillSet
from edgevox.agent.skills.arguments import is_number_type
from edgevox.agent.skills.skill import OneOf
from edgevox.agent.text.alike import most_alike
from edgevox.agent.text.spelling import (
    ENDING,
    NUMBER,
    folded,
    is_same_name,
    key,
    separated,
    unpunctuated,
)
from edgevox.core.files.text import one_form
from edgevox.core.languages import LANGUAGES

ANY = ""
"""The beginning of every sentence."""


def said(text: str) -> str:
    """A sentence in the form in which beginnings are compared: hassil's, in lower case."""
    if text.isascii() and text.replace(" ", "").isalnum():  # nothing to normalise
        return text.strip().casefold()
    return str(normalize_for_matching(text).text).casefold()


def beginnings(template: Sentence, rules: Mapping[str, Sentence]) -> frozenset[str]:
    """Beginnings of a template's sentences, in lower case: first words, or parts of them."""
    found, empty = _begins(template.expression, rules)
    return frozenset({ANY}) if empty or ANY in found else found


def _most_slots(part: Expression, rules: Mapping[str, Sentence]) -> int:
    """The most values that one sentence can give a part of a template."""
    match part:
        case ListReference():
            return 1
        case RuleReference(rule_name=name) if name in rules:
            return _most_slots(rules[name].expression, rules)
        case Alternative():
            return max((_most_slots(item, rules) for item in part.items), default=0)
        case Group():
            return sum(_most_slots(item, rules) for item in part.items)
    return 0


def _begins(part: Expression, rules: Mapping[str, Sentence]) -> tuple[frozenset[str], bool]:
    """Beginnings of a part of a template, and whether the part may be empty."""
    match part:
        case TextChunk():
            words = part.text.split(maxsplit=1)
            return frozenset(map(_compared, words[:1])), not words
        case RuleReference(rule_name=name) if name in rules:
            return _begins(rules[name].expression, rules)
        case Alternative():
            some = [_begins(item, rules) for item in part.items]
            return frozenset().union(*(one for one, _ in some)), any(empty for _, empty in some)
        case expression.Sequence():
            found: frozenset[str] = frozenset()
            for item in part.items:
                more, empty = _begins(item, rules)
                found |= more
                if not empty:
                    return found, False
            return found, True
    return frozenset({ANY}), False  # a word of a list, or any


def _compared(word: str) -> str:
    return word.casefold() if word[0].isalnum() else ANY


_MOST_TEMPLATES = 4096
"""Number of parsed templates of a language that are kept; all robots together have about 700."""

LOOSE_SLOTS = 4
"""A template that one sentence can give more values is not tried with any words in their places:
each place may end at each word, and a sentence of ten words was tried for hours."""
_Lists = dict[str, SlotList]


def compile_templates(
    skills: SkillSet, book: Phrasebook, *, loose: bool = False, asking: bool = False
) -> "Templates":
    """Compile the templates of these skills, or with `asking` those after which the robot asks.

    `loose` accepts any words for known words.
    """
    shared = _shared(book.code, tuple(book.rules.items()), book.hearing.places)
    several = {name: one for name, one in skills.items() if not loose or one.choices}
    written = book.asking if asking else book.templates
    templates = {name: written(one) for name, one in several.items()}
    parsed = {name: [shared.template(one) for one in some] for name, some in templates.items()}
    if loose:
        parsed = {n: [one for one in p if one.slots <= LOOSE_SLOTS] for n, p in parsed.items()}
    lists = {name: shared.lists(skills[name], loose=loose) for name, some in parsed.items() if some}
    return Templates(book.code, shared.rules, parsed, lists)


def openers(templates: Sequence[str], book: Phrasebook) -> frozenset[str]:
    """The words with which the sentences of these templates may begin, in lower case."""
    shared = _shared(book.code, tuple(book.rules.items()), book.hearing.places)
    begins = (shared.template(one).begins.values() for one in templates)
    return frozenset(word for some in begins for several in some for word in several if word)


class Templates:
    """The templates of some skills, by skill. `lists` holds the words for the slots of each."""

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
        """The templates that begin as this text does, one intent per skill."""
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
    """Beginnings of its sentences, by their first letter."""
    slots: int
    """The most values that one sentence can give it."""


_Beginning = dict[str, list[tuple[Sentence, tuple[str, ...]]]]
"""Templates with a sentence that begins with one letter, and those beginnings, by skill."""


def _intent(name: str, templates: list[Sentence], lists: _Lists) -> Intent:
    """An intent of parsed templates and of the words for their slots."""
    data = IntentData([], slot_lists=lists)
    vars(data)["sentences"] = templates  # the attribute in which hassil caches what it parses
    return Intent(name, [data])


class _SharedTemplates:
    """The rules and places that all templates of a language share, and the parsed templates."""

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
        return _Template(sentence, begins, _most_slots(sentence.expression, self.rules))

    def lists(self, one: Skill, *, loose: bool) -> _Lists:
        """Words for a skill's slots: any words, or a list if the argument has choices.

        A skill that takes new names also gets the book's usual places.
        """
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
    """The text, without spaces if the language puts none between words."""
    return text if hearing.spaced else text.replace(" ", "")


@lru_cache(maxsize=8192)
def _forms(said: str, code: str, *, spaced: bool) -> tuple[str, ...]:
    """Written forms of a word. Cached, because a new word rebuilds a list of many old ones."""
    plain = key(said)
    sharp = [folded(said.lower())] if "ß" in said.lower() else []  # which `key` spells as ss
    found = dict.fromkeys((digits(plain, code), plain, *sharp))
    return tuple(found) if spaced else tuple(one.replace(" ", "") for one in found)


def word_list(choices: OneOf, book: Phrasebook) -> TextSlotList:
    """All spoken forms of these words, as written and with their numbers as digits."""
    spoken = {
        form: word
        for said, word in book.heard(choices).items()
        for form in _forms(said, book.code, spaced=book.hearing.spaced)
    }
    return _indexed(TextSlotList.from_tuples(spoken.items(), allow_template=False))


def _indexed(words: TextSlotList) -> TextSlotList:
    """The list with its index built now: two threads that look first would both build it."""
    words.get_candidates("")
    return words


@lru_cache(len(LANGUAGES))
def usual_places(code: str) -> Mapping[str, str]:
    """The usual places that a language has a word for, in `key` form, each as it is written.

    One of them in a sentence is meant: it is no misspelt name of the robot's.
    """
    flat = (one.strip("()") for one in phrasebook(code).hearing.places if "[" not in one)
    return {key(name): name for one in flat for name in one.split("|")}


MAX_CHARACTERS = 240
"""Number of characters from which on an utterance is no plain command and goes to the model."""

_NUMBER = re.compile(NUMBER)
_PAIR = re.compile(rf"({NUMBER})\s*,?\s+(?={NUMBER}(?:[\s,]|\W*$))")
_PERCENT = re.compile(r"(?<=\d)\s*%")
_NOTHING = "nothingatall"
_NEAR, _WORD_NEAR = 0.8, 0.6
"""Least similarity of a misheard name to a known one, as a whole and for each word."""
_MAX_UNKNOWN_WORDS = 3
_MAX_UNKNOWN_CHARACTERS = 8
"""Length of the longest unknown name in a language without spaces between words."""


@dataclass(frozen=True, slots=True)
class Understood:
    """An utterance understood as calls."""

    calls: tuple[Call, ...]
    """The calls."""
    unsure: bool = False
    """True if a word was replaced by a similar one, or if the robot must ask first."""


@dataclass(frozen=True, slots=True)
class RefusedCommand:
    """A plain command in which a word is missing or unknown."""

    reason: str
    """The sentence that says which word."""
    detail: str = ""
    """The whole list of known words, if it is too long to be spoken."""


class Recogniser:
    """Matches utterances against the templates of a set of skills. Any thread may use it.

    An utterance may join several commands ("go to the kitchen, then tell me your battery"); all its
    parts must match. An unknown word that is similar to a known one is corrected ("kichen"); any
    other is refused by name, since a robot must not guess where to drive. The templates come from
    the phrasebook, or from the skills themselves. Words learned since the last utterance count.
    `dialogue_skills` come last, and every word must fit them.
    """

    def __init__(
        self, skills: SkillSet, language: str = ENGLISH, dialogue_skills: SkillSet = NO_SKILLS
    ) -> None:
        codes = dict.fromkeys((language, ENGLISH))
        books = [phrasebook_of(code, skills.values()) for code in codes]
        self._language = language
        self._skills = skills
        self._words = skills.words()
        self._learning = threading.Lock()
        self._readers = [_TemplateReader(skills, book, books[0], dialogue_skills) for book in books]

    def recognise(self, text: str) -> Understood | RefusedCommand | None:
        """The calls of a plain command, a refusal, or None for any other text."""
        if len(text) > MAX_CHARACTERS or not is_exact(text, self._language):
            return None
        self._learn()
        plain = digits(" ".join(one_form(text).split()), self._language)
        refused = None
        for reader in self._readers:
            found = reader.read(plain)
            if isinstance(found, Understood):
                return found
            refused = refused or found
        return refused

    def _learn(self) -> None:
        with self._learning:
            words = self._skills.words()
            if words != self._words:
                self._words = words
                for reader in self._readers:
                    reader.learn()


class _TemplateReader:
    """Reads one language, and words refusals in the language of `answers`."""

    def __init__(
        self, skills: SkillSet, book: Phrasebook, answers: Phrasebook, dialogue_skills: SkillSet
    ) -> None:
        self._skills = SkillSet([*skills.values(), *dialogue_skills.values()])
        self._book = book
        self._answers = answers
        self._joints = _joints(book.hearing)
        self._reserved = frozenset(map(key, book.hearing.reserved))
        self._strict = compile_templates(self._skills, book)
        self._asking = compile_templates(self._skills, book, asking=True)
        self._loose = compile_templates(skills, book, loose=True)
        self.learn()

    def learn(self) -> None:
        """Take over the present words of the arguments; the templates stay as they are."""
        made: dict[int, TextSlotList] = {}  # skills may share their choices
        for templates in (self._strict, self._asking):
            for name, lists in templates.lists.items():
                for argument, one in self._skills[name].choices.items():
                    if id(one) not in made:
                        made[id(one)] = word_list(one, self._book)
                    lists[argument] = made[id(one)]

    def read(self, text: str) -> Understood | RefusedCommand | None:
        """The result of `Recogniser.recognise` for a text with numbers as digits."""
        plain = digits(text, self._book.code)
        whole = self._one(plain)
        if isinstance(whole, Understood):
            return whole
        parts = [part for part in self._joints.split(plain) if part.strip()]
        if len(parts) > 1:
            found = [self._one(part) for part in parts]
            known = [part for part in found if isinstance(part, Understood)]
            if len(known) == len(parts):
                calls = tuple(call for part in known for call in part.calls)
                return Understood(calls, unsure=any(part.unsure for part in known))
            refusals = [part for part in found if isinstance(part, RefusedCommand)]
            return refusals[0] if refusals and len(known) + len(refusals) == len(parts) else None
        return whole

    def _one(self, part: str) -> Understood | RefusedCommand | None:
        """The call of a single sentence; two bare numbers side by side count as "x and y"."""
        hearing = self._book.hearing
        part = _PERCENT.sub(f" {hearing.percent}", part)
        paired = _PAIR.sub(rf"\1 {hearing.pair} ", part)
        sentence = written(unpunctuated(separated(paired)), self._book.hearing)
        for call in self._matches(sentence, self._strict):
            return Understood((call,))
        for call in self._matches(sentence, self._asking):
            return Understood((call,), unsure=True)
        if key(sentence) in self._reserved:
            return None
        for call in self._matches(sentence, self._loose):
            return self._repair(call)
        for call in self._matches(f"{sentence} {_NOTHING}", self._loose):
            if any(value == _NOTHING for value in call.arguments.values()):
                return self._repair(call)
        return None

    def _matches(self, sentence: str, templates: Templates) -> Iterator[Call]:
        plain = folded(sentence)
        fitting = templates.fitting(plain)
        for result in recognize_all(plain, fitting) if fitting.intents else ():
            one = self._skills[result.intent.name]
            arguments = _arguments(one, result, sentence)
            if arguments is None:
                continue
            names = {name: arguments[name].replace("' ", "'") for name in one.new_names}
            if self._are_names(names.values()):
                yield Call(result.intent.name, {**arguments, **names})

    def _are_names(self, given: Collection[str]) -> bool:
        """True if these may be names, and not clauses or the command that follows."""
        hearing = self._book.hearing
        if not hearing.spaced:
            return not any(word in said for word in hearing.clause_words for said in given)
        return all(hearing.clause_words.isdisjoint(map(key, said.split())) for said in given)

    def _repair(self, call: Call) -> Understood | RefusedCommand | None:
        """Correct misspelt words of a loose match, or refuse with the wrong word."""
        arguments, nearly = dict(call.arguments), False
        for name, choices in self._skills[call.skill].choices.items():
            said = self._without_articles(str(arguments.get(name, "")))
            if said in ("", _NOTHING) and choices.words:
                return refused(self._answers, "missing_word", name, choices.words)
            if not _may_be_a_name(said, self._book.hearing):
                return None
            if not choices.words:
                return RefusedCommand(
                    self._answers.say("no_words", argument=self._answers.kind(name))
                )
            spoken = {key(one): word for one, word in self._book.heard(choices).items()}
            known = {**spoken, **usual_places(self._book.code)}  # always in the same order
            alike = most_alike(key(said), known, least=_NEAR)
            near = [one for one in alike if one in spoken]
            inflected = self._book.fallback is not None
            same = bool(near) and is_same_name(key(said), near[0], inflected=inflected)
            if not near or not (same or self._is_alike(key(said), near[0])):
                as_said = self._without_articles(str(arguments[name]), leading=True)
                return refused(self._answers, "unknown_word", name, choices.words, as_said)
            nearly |= not same
            arguments[name] = spoken[near[0]]
        return Understood((Call(call.skill, arguments),), nearly)

    def _is_alike(self, said: str, known: str) -> bool:
        """True if the words may be this name misheard, and not another word that contains it."""
        extra = len(said) - len(known)
        longer = known in said and extra > (ENDING if self._book.hearing.spaced else 0)
        return not longer and _alike_word_by_word(said, known)

    def _without_articles(self, said: str, *, leading: bool = False) -> str:
        """Without its articles, or only without the `leading` ones."""
        articles = {key(separated(article)) for article in self._book.hearing.articles}
        words = said.split()
        kept = [at for at, word in enumerate(words) if key(word) not in articles]
        kept = [*range(kept[0], len(words))] if leading and kept else kept
        return " ".join(words[at] for at in kept).replace("' ", "'")


def _alike_word_by_word(said: str, known: str) -> bool:
    """True if each word is similar: "shelf B" is not "shelf A", "kitchen ft" is not "kitchen"."""
    pairs = list(zip(said.split(), known.split(), strict=False))
    ratios = (difflib.SequenceMatcher(None, *pair).ratio() for pair in pairs)
    return len(said.split()) == len(known.split()) and all(one >= _WORD_NEAR for one in ratios)


def refused(
    book: Phrasebook, sentence: str, argument: str, known: Sequence[str], said: str = ""
) -> RefusedCommand:
    """The refusal of a missing or unknown word, with some known words; all are in `detail`."""
    kind = book.kind(argument)
    reason = book.say(sentence, argument=kind, said=said, known=brief(book, known, said))
    return RefusedCommand(reason, whole(book, known))


def _arguments(one: Skill, result: RecognizeResult, sentence: str) -> Mapping[str, Any] | None:
    """The match's slots as arguments; None if a slot for a number holds none.

    Free words and new names come from the sentence with its accents.
    """
    said: dict[str, str] = {}
    for name, entity in result.entities.items():
        said[name] = str(entity.value).strip()
        if is_number_type(one.arguments_model.model_fields[name].annotation):
            if not _NUMBER.fullmatch(said[name]):
                return None
        elif (entity.is_wildcard or name in one.new_names) and entity.text_span:
            said[name] = sentence[slice(*entity.text_span)].strip()
    return one.from_words(said)


def _joints(hearing: Hearing) -> re.Pattern[str]:
    words = "|".join(re.escape(word) for word in hearing.joints) or "(?!)"
    if not hearing.spaced:
        return re.compile(rf"[,;!?\u3001\u3002]*\s*(?:{words})[,\u3001]?\s*|[,;!?\u3001\u3002]\s*")
    return re.compile(
        rf"\s*(?:,|;|\.(?!\d)|(?<!\w)|(?=,))\s*(?:{words})\s+|[;.\u061b\u0964](?!\d)\s+",
        re.IGNORECASE,
    )


def _may_be_a_name(said: str, hearing: Hearing) -> bool:
    """True if these words may be a name, and not a clause or a number."""
    if any(character.isdigit() for character in said):
        return False
    if not hearing.spaced:
        clause = any(word in said for word in hearing.clause_words)
        return len(said) <= _MAX_UNKNOWN_CHARACTERS and not clause
    words: Sequence[str] = said.split()
    return len(words) <= _MAX_UNKNOWN_WORDS and not hearing.clause_words.intersection(
        map(key, words)
    )
