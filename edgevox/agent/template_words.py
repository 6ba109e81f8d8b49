"""Which words a template holds and which of them must be said, without compiling it.

Few names share a word with every part of a template: for those alone one is compiled.
"""

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from itertools import chain

from edgevox.agent.spelling import folded, separated, unpunctuated
from edgevox.core.text import one_form

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
        """Those of a template, and of the rules in it."""
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
