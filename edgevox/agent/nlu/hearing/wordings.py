"""Wordings: usual sentences for calls, for comparison with a misheard sentence and as a prompt.

Wordings are a selection from the templates: optional words are left out, except articles before
names, and of several alternatives the first few stay. Calls with numbers have no wordings, because
a number that was not heard must not be guessed.

A hearing prompt shows likely commands to speech recognition before it listens. In noise, speech
recognition hears what it expects. With the robot's own commands and names in the prompt, it
recognises sentences that it otherwise writes as "Lock forward" or "Get your own place".
"""

import itertools
import math
import random
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from functools import lru_cache
from typing import TypeVar

from hassil.expression import (
    Alternative,
    Expression,
    Group,
    ListReference,
    Permutation,
    RuleReference,
    TextChunk,
)
from hassil.parse_expression import parse_sentence

from edgevox.agent.phrases.load import ENGLISH, phrasebook
from edgevox.agent.phrases.own_names import phrasebook_of
from edgevox.agent.phrases.phrasebook import Phrasebook
from edgevox.agent.skills import Call, Skill, SkillSet

_MOST_ALTERNATIVES = 4
"""Number of alternatives that are used: the first ones are the usual ones."""
_MOST_FRAMES = 80
"""Number of frames of one skill, the first of each template before the second ones."""
_MOST_SENTENCES = 700
"""Number of sentences of one skill: the more names it knows, the fewer frames it gets."""
_SLOT = "{}"
_ALONE = ("{name}{polite}", "{name}")
"""Forms of a bare name, without a word for what to do there."""

_Choice = tuple[str, tuple[str, ...]]
_Item = TypeVar("_Item")


@dataclass(frozen=True, slots=True)
class Wording:
    """A usual sentence for a call."""

    sentence: str
    """The sentence."""
    call: Call
    """The call that it asks for."""
    alone: bool = False
    """True if the sentence is only a name."""


def wordings(one: Skill, book: Phrasebook) -> Iterator[Wording]:
    """The wordings of a skill, the most usual first, then those of its bare names."""
    yield from _of_templates(one, book)
    yield from _of_names(one, book)


def _of_templates(one: Skill, book: Phrasebook) -> Iterator[Wording]:
    spoken = {name: _names(one, name, book) for name in one.choices}
    reader = _TemplateExpander(book)
    frames = _in_turns(
        reader.expanded(parse_sentence(template).expression) for template in book.templates(one)
    )
    fitting = (frame for frame in frames if set(frame[1]) <= spoken.keys())
    size = max(1, math.prod(map(len, spoken.values())))
    most = max(1, min(_MOST_FRAMES, _MOST_SENTENCES // size))
    for text, slots in itertools.islice(dict.fromkeys(fitting), most):
        yield from _filled(one, text, slots, spoken)


def _names(one: Skill, argument: str, book: Phrasebook) -> Mapping[str, str]:
    """Spoken names and their words, own names first; only own names if there are more arguments."""
    heard = book.heard(one.choices[argument])
    own = {said: word for said, word in heard.items() if said == word.replace("_", " ")}
    return own or heard if len(one.choices) > 1 else own | heard


def _of_names(one: Skill, book: Phrasebook) -> Iterator[Wording]:
    """Wordings of bare names, for a drive that needs only the name."""
    needed = bare_name(one)
    if needed is None:
        return
    polite = next(iter(book.answers.polite), "")
    for said, word in _names(one, needed, book).items():
        for form in _ALONE:
            sentence = form.format(name=said, polite=f", {polite}" if polite else "")
            yield Wording(sentence, Call(one.name, {needed: word}), alone=True)


def bare_name(one: Skill) -> str | None:
    """The argument whose name alone asks for a drive, because it needs no other; None if none."""
    needed = [name for name, info in one.arguments_model.model_fields.items() if info.is_required()]
    return needed[0] if one.drives and len(needed) == 1 and needed[0] in one.choices else None


def _filled(
    one: Skill, text: str, slots: tuple[str, ...], spoken: Mapping[str, Mapping[str, str]]
) -> Iterator[Wording]:
    for several in itertools.product(*(spoken[name].items() for name in slots)):
        words = text
        for said, _ in several:
            words = words.replace(_SLOT, said, 1)
        values = {name: word for name, (_, word) in zip(slots, several, strict=True)}
        yield Wording(" ".join(words.split()), Call(one.name, values))


class _TemplateExpander:
    """Expands templates of one language."""

    def __init__(self, book: Phrasebook) -> None:
        self._rules = book.rules
        self._articles = frozenset(book.hearing.articles)

    def expanded(self, expression: Expression) -> Iterator[_Choice]:
        """Texts with a mark for each slot, and the slots in their order."""
        if isinstance(expression, TextChunk):
            yield expression.original_text, ()
        elif isinstance(expression, ListReference):
            yield _SLOT, (expression.list_name,)
        elif isinstance(expression, RuleReference):
            yield from self.expanded(parsed_rule(self._rules[expression.rule_name]))
        elif isinstance(expression, Alternative) and expression.is_optional:
            yield "", ()
        elif isinstance(expression, Alternative):
            usual = expression.items[:_MOST_ALTERNATIVES]
            yield from _in_turns(self.expanded(item) for item in usual)
        elif isinstance(expression, Group):
            yield from _joined([self._part(expression, at) for at in range(len(expression.items))])

    def _part(self, group: Group, at: int) -> list[_Choice]:
        """The choices for a part of a group; an optional article before a name always stays."""
        part = group.items[at]
        if isinstance(part, Alternative) and part.is_optional:
            article = next(self.expanded(part.items[0]), ("", ()))[0]
            named = any(isinstance(one, ListReference) for one in group.items[at + 1 : at + 3])
            if named and article.strip() in self._articles:
                return [(article, ())]
        return list(self._some(part))

    def _some(self, expression: Expression) -> Iterator[_Choice]:
        return itertools.islice(self.expanded(expression), _MOST_FRAMES)


@lru_cache(maxsize=512)
def parsed_rule(written: str) -> Expression:
    """A parsed rule of a phrasebook. Cached: most templates use the same few."""
    return parse_sentence(written).expression


def _joined(parts: Iterable[list[_Choice]]) -> Iterator[_Choice]:
    for several in itertools.product(*parts):
        yield "".join(text for text, _ in several), tuple(s for _, slots in several for s in slots)


def _in_turns(several: Iterable[Iterator[_Item]]) -> Iterator[_Item]:
    """The first item of each iterator, then the second of each, and so on."""
    waiting = list(several)
    while waiting:
        for one in list(waiting):
            try:
                yield next(one)
            except StopIteration:
                waiting.remove(one)


MOST_CHARACTERS = 800
"""Length of a prompt: Whisper reads at most 223 tokens, the last ones of a longer text."""
_DRAWN = 300
"""Number of sentences that are drawn from the templates of a skill with several names."""
_SHORT = 30
"""Characters that each sentence costs beside its own: few long ones beat many short ones."""


class HearingPrompts:
    """Gives the prompt of each language, rebuilt after the robot has learned words.

    Only English gets the robot's own commands. Names are English in every language, and a prompt
    that mixed two languages made Whisper hear the Portuguese "Pare!" as "París!".
    """

    def __init__(self, skills: SkillSet) -> None:
        self._skills = skills
        self._words: object = None
        self._prompt = ""

    def __call__(self, code: str) -> str:
        if code != ENGLISH:
            return phrasebook(code).hearing.written
        words = self._skills.words()
        if words != self._words:
            skills = self._skills.values()
            self._prompt = hearing_prompt(skills, phrasebook_of(code, skills))
            self._words = words
        return self._prompt


def hearing_prompt(skills: Iterable[Skill], book: Phrasebook) -> str:
    """The prompt of one language: the robot's commands while there is room, then sample commands.

    Each skill gives plain sentences that ask for it, with each name that it knows.
    """
    room = MOST_CHARACTERS - len(book.hearing.written)
    kept: list[str] = []
    for sentence in dict.fromkeys(_in_turns(iter(_usual(one, book)) for one in skills)):
        if len(sentence) < room:
            room -= len(sentence) + 1
            kept.append(sentence)
    # Whisper expects the last words most, so the sample spelling stands last.
    return " ".join([*kept, book.hearing.written])


def _usual(one: Skill, book: Phrasebook) -> list[str]:
    """The skill's most usual wording with each of its names, and the bare names.

    Of a skill with several names, sentences that have every name at least once.
    """
    if one.lasting:  # to forget a place must never be what was expected
        return []
    if len(one.choices) > 1:
        return _with_every_name(one, book)
    found: dict[tuple[int, tuple[str, ...]], str] = {}
    for wording in wordings(one, book):
        values = tuple(map(str, wording.call.arguments.values()))
        found.setdefault((wording.alone, values), _sentence(wording.sentence))
    return list(found.values())


def _with_every_name(one: Skill, book: Phrasebook) -> list[str]:
    """Few sentences that have every name but defaults, which are hardly said: always the same."""
    draw = _Draw(one, book)
    drawn = [draw.sentence() for _ in range(_DRAWN if draw.templates else 0)]
    left, found = {name for _, said in drawn for name in said}, []
    while left:
        sentence, said = max(drawn, key=lambda it: len(it[1] & left) / (len(it[0]) + _SHORT))
        left -= said
        found.append(_sentence(sentence))
    return found


class _Draw:
    """Draws sentences from the templates of a skill, each time the same ones."""

    def __init__(self, one: Skill, book: Phrasebook) -> None:
        fields = one.arguments_model.model_fields
        self._random = random.Random(0)  # noqa: S311 - the same sentences each time
        self._rules = book.rules
        self._names = {
            slot: [said for said, word in _names(one, slot, book).items() if word != default]
            for slot in one.choices
            for default in [fields[slot].default]
        }
        self.templates = [parse_sentence(it).expression for it in book.templates(one)]

    def sentence(self) -> tuple[str, frozenset[tuple[str, str]]]:
        """A sentence and the names in it by slot; none if it has a slot or a name twice."""
        said: list[tuple[str, str]] = []
        text = self._drawn(self._random.choice(self.templates), said)
        slots, names = ({one[at] for one in said} for at in (0, 1))
        once = len(slots) == len(names) == len(said)
        return " ".join(text.split()), frozenset(said if once else ())

    def _drawn(self, expression: Expression, said: list[tuple[str, str]]) -> str:
        match expression:
            case TextChunk():
                return str(expression.original_text)
            case ListReference(list_name=slot):
                if not self._names.get(slot):
                    return ""
                said.append((slot, self._random.choice(self._names[slot])))
                return said[-1][1]
            case RuleReference(rule_name=name):
                return self._drawn(parsed_rule(self._rules[name]), said)
            case Alternative(items=items, is_optional=optional):
                if optional and self._random.random() < 0.5:
                    return ""
                usual = [1 / (1 + at) for at in range(len(items))]  # the first ones are
                [item] = self._random.choices(items, usual)
                return self._drawn(item, said)
            case Permutation(items=items) | Group(items=items):
                return "".join(self._drawn(item, said) for item in items)
        raise TypeError(type(expression))


def _sentence(words: str) -> str:
    return f"{words[:1].upper()}{words[1:]}."
