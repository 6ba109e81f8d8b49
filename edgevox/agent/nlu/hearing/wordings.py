"""Plain ways to say what skills do, each with its call: what a misheard sentence is compared with.

They come from the templates, which hold many more: of what may be left out all is but articles
before names, and of several words for the same the first few stand. What takes a number has none
here: a number that was not heard is not guessed.
"""

import itertools
import math
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from functools import lru_cache

from hassil.expression import (
    Alternative,
    Expression,
    Group,
    ListReference,
    RuleReference,
    TextChunk,
)
from hassil.parse_expression import parse_sentence

from edgevox.agent.phrases.phrasebook import Phrasebook
from edgevox.agent.skills import Call, Skill

_MOST_ALTERNATIVES = 4
"""Of words that mean the same, the first few are the usual ones."""
_MOST_FRAMES = 80
"""Of one skill, and the first of each of its templates come first."""
_MOST_SENTENCES = 700
"""Of one skill: the more names it knows, the fewer frames there are around them."""
_SLOT = "{}"
_ALONE = ("{name}{polite}", "{name}")
"""What is said of a place where nobody says what to do there."""

_Choice = tuple[str, tuple[str, ...]]


@dataclass(frozen=True, slots=True)
class Wording:
    """A sentence, and what it asks for; `alone` if it is a name and nothing else."""

    sentence: str
    call: Call
    alone: bool = False


def wordings(one: Skill, book: Phrasebook) -> Iterator[Wording]:
    """Those of a skill, the most usual one first, and what is said of its names alone."""
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
    """What is said for its words, each by its own name first; of two arguments only those."""
    heard = book.heard(one.choices[argument])
    own = {said: word for said, word in heard.items() if said == word.replace("_", " ")}
    return own or heard if len(one.choices) > 1 else own | heard


def _of_names(one: Skill, book: Phrasebook) -> Iterator[Wording]:
    """A name alone is where to drive, if that is all that the skill needs."""
    needed = [name for name, info in one.arguments_model.model_fields.items() if info.is_required()]
    if not one.drives or len(needed) != 1 or needed[0] not in one.choices:
        return
    polite = next(iter(book.answers.polite), "")
    for said, word in _names(one, needed[0], book).items():
        for form in _ALONE:
            sentence = form.format(name=said, polite=f", {polite}" if polite else "")
            yield Wording(sentence, Call(one.name, {needed[0]: word}), alone=True)


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
            yield from self.expanded(_rule(self._rules[expression.rule_name]))
        elif isinstance(expression, Alternative) and expression.is_optional:
            yield "", ()
        elif isinstance(expression, Alternative):
            usual = expression.items[:_MOST_ALTERNATIVES]
            yield from _in_turns(self.expanded(item) for item in usual)
        elif isinstance(expression, Group):
            yield from _joined([self._part(expression, at) for at in range(len(expression.items))])

    def _part(self, group: Group, at: int) -> list[_Choice]:
        """What may stand there: an article before a name, though it may be left out."""
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
def _rule(written: str) -> Expression:
    """A rule of a phrasebook: most templates name the same few."""
    return parse_sentence(written).expression


def _joined(parts: Iterable[list[_Choice]]) -> Iterator[_Choice]:
    for several in itertools.product(*parts):
        yield "".join(text for text, _ in several), tuple(s for _, slots in several for s in slots)


def _in_turns(several: Iterable[Iterator[_Choice]]) -> Iterator[_Choice]:
    """One of each, then the next of each: the first words of all count more than all of one."""
    waiting = list(several)
    while waiting:
        for one in list(waiting):
            try:
                yield next(one)
            except StopIteration:
                waiting.remove(one)
