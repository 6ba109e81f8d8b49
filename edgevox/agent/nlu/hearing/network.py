"""A network of all sentences that skills understand, searched by sound.

Speech recognition writes "a maricano" where somebody orders an Americano. Every sentence that a
robot understands is a path through this network, so the path that sounds most like the words is
what was probably said. The cost of a path is an edit distance over phonemes (`sounds.py`).
"""

import heapq
import itertools
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
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

from edgevox.agent.nlu.hearing.sounds import Costs, Sounds, SpanTable
from edgevox.agent.nlu.hearing.wordings import parsed_rule

_MOST_STEPS = 4000
"""The most steps of one search, against grammars with too many sentences that are as near."""

_Values = tuple[tuple[str, str], ...]


@dataclass(frozen=True, eq=False, slots=True)
class Sentences:
    """What may be said for one skill."""

    skill: str
    templates: tuple[str, ...]
    """In hassil's notation. What needs a slot that has no words here is left out."""
    words: Mapping[str, tuple[str, ...]]
    """What may be said for each slot."""
    alone: bool = False
    """True if these are only names, without a word for what to do."""


@dataclass(frozen=True, slots=True)
class Path:
    """A sentence of the network that sounds like a text."""

    of: Sentences
    values: frozenset[tuple[str, str]]
    """The slots with their words."""
    words: str
    """The sentence."""
    distance: float
    """The share of the text's sounds that differ."""

    @property
    def meaning(self) -> tuple[str, frozenset[tuple[str, str]]]:
        """The skill and what is said for its slots."""
        return self.of.skill, self.values


class _Edge(NamedTuple):
    target: int
    labels: tuple[int, ...] = ()
    """The indices of words of which one is said; none for an edge without words."""
    slot: str = ""
    """The slot whose words they are, if any."""


class _Waiting(NamedTuple):
    """The beginning of a path, in the order in which they are followed."""

    whole: float
    """Cost of the beginning and of the cheapest end."""
    number: int
    cost: float
    node: int
    at: int
    """How many sounds were heard until here."""
    values: _Values
    labels: tuple[int, ...]
    of: Sentences


class Network:
    """The sentences of some skills.

    Args:
        several: The sentences of each skill.
        rules: The templates of the rules that templates name.
        sounds_of: Returns the sounds of a text.
    """

    def __init__(
        self,
        several: Iterable[Sentences],
        rules: Mapping[str, str],
        sounds_of: Callable[[str], Sounds],
    ) -> None:
        self._sounds_of = sounds_of
        self._rules = rules
        self._edges: list[list[_Edge]] = []  # of each node, all to later nodes, -1 is the end
        self._labels: dict[str, int] = {}
        self._starts: list[tuple[Sentences, int]] = []
        for one in several:
            for template in one.templates:
                self._add(one, template)
        self._texts = tuple(self._labels)
        self.words = frozenset(word for text in self._texts for word in text.split())
        """Every word of every sentence."""
        self._table = SpanTable([sounds_of(text) for text in self._texts])

    def nearest(self, text: str, most: float, margin: float) -> list[Path]:
        """Return the sentences that sound like a text, the nearest first, each meaning once.

        Args:
            text: The words.
            most: The largest distance of the nearest one.
            margin: How much farther the others may be.
        """
        heard = self._sounds_of(text)
        if not heard or not self._starts:
            return []
        weight = self._table.weight(heard)
        spans = self._table.spans(heard)
        ahead = self._costs_ahead(spans)
        best = min(float(ahead[start, 0]) for _, start in self._starts)
        if best > most * weight:
            return []
        return [
            Path(
                found.of,
                frozenset(found.values),
                " ".join(self._texts[one] for one in found.labels),
                found.cost / weight,
            )
            for found in self._walk(spans, ahead, best + margin * weight)
        ]

    def _costs_ahead(self, spans: Costs) -> Costs:
        """Cost from each node and position to the end: (nodes + 1, positions)."""
        several = {edge.labels for edges in self._edges for edge in edges if edge.labels}
        costs = {labels: spans[list(labels)].min(axis=0) for labels in several}
        ahead = np.full((len(self._edges) + 1, spans.shape[1]), np.inf, np.float32)
        ahead[-1, -1] = 0.0
        for node in reversed(range(len(self._edges))):
            for target, labels, _ in self._edges[node]:
                then = (costs[labels] + ahead[target]).min(axis=1) if labels else ahead[target]
                np.minimum(ahead[node], then, out=ahead[node])
        return ahead

    def _walk(self, spans: Costs, ahead: Costs, most: float) -> Iterator[_Waiting]:
        """The paths up to a cost, the cheapest first, by A* with the exact cost that is ahead."""
        numbers = itertools.count()
        waiting: list[_Waiting] = []

        def follow(one: _Waiting, target: int, at: int, **more: Any) -> None:
            cost = more.get("cost", one.cost)
            if (whole := cost + float(ahead[target, at])) <= most:
                then = one._replace(whole=whole, number=next(numbers), node=target, at=at, **more)
                heapq.heappush(waiting, then)

        for of, start in self._starts:
            follow(_Waiting(0.0, 0, 0.0, start, 0, (), (), of), start, 0)
        seen = set()
        for _ in range(_MOST_STEPS):
            if not waiting:
                return
            one = heapq.heappop(waiting)
            state = (one.node, one.at, one.of.skill, frozenset(one.values))
            if state in seen:
                continue
            seen.add(state)
            if one.node == -1:
                yield one
                continue
            for target, labels, slot in self._edges[one.node]:
                if not labels:
                    follow(one, target, one.at)
                for said in labels:
                    values = ((slot, self._texts[said]),) if slot else ()
                    costs = one.cost + spans[said, one.at]
                    for at in np.flatnonzero(costs + ahead[target] <= most):
                        follow(
                            one, target, int(at), cost=float(costs[at]),
                            values=(*one.values, *values), labels=(*one.labels, said),
                        )  # fmt: skip

    def _add(self, one: Sentences, template: str) -> None:
        """Draw a template, unless it needs a slot that has no words."""
        start = self._node()
        last = self._draw(one, parse_sentence(template).expression, start)
        if last is not None:
            self._starts.append((one, start))
            self._edges[last].append(_Edge(-1))

    def _draw(self, one: Sentences, expression: Expression, start: int) -> int | None:
        """Draw an expression from a node on; the node at its end, None if it cannot be said."""
        match expression:
            case TextChunk():
                text = " ".join(expression.original_text.split())
                return self._step(start, [text]) if text else start
            case ListReference(list_name=slot):
                words = one.words.get(slot)
                return self._step(start, words, slot) if words else None
            case RuleReference(rule_name=name):
                return self._draw(one, parsed_rule(self._rules[name]), start)
            case Alternative(items=items, is_optional=optional):
                ends = [self._draw(one, item, start) for item in items]
                return self._joined([*ends, start] if optional else ends)
            case Permutation(items=items):
                rows = itertools.permutations(items)
                return self._joined([self._row(one, row, start) for row in rows])
            case Group(items=items):
                return self._row(one, items, start)
        raise TypeError(type(expression))

    def _row(self, one: Sentences, items: Iterable[Expression], start: int) -> int | None:
        at: int | None = start
        for item in items:
            at = None if at is None else self._draw(one, item, at)
        return at

    def _joined(self, ends: Iterable[int | None]) -> int | None:
        there = [end for end in dict.fromkeys(ends) if end is not None]
        if len(there) < 2:
            return there[0] if there else None
        joint = self._node()
        for end in there:
            self._edges[end].append(_Edge(joint))
        return joint

    def _step(self, start: int, texts: Iterable[str], slot: str = "") -> int:
        end = self._node()
        labels = {self._labels.setdefault(text, len(self._labels)) for text in texts}
        self._edges[start].append(_Edge(end, tuple(labels), slot))
        return end

    def _node(self) -> int:
        self._edges.append([])
        return len(self._edges) - 1
