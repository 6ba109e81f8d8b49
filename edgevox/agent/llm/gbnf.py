"""A matcher for GBNF grammars, which tells piece by piece whether a text obeys one.

An engine on board samples by a grammar; a server across the network may not. So `enforce_grammar`
checks the server's answer. The matcher is our own, because libraries that read GBNF only sample by
it and cannot check a text.
"""

import functools
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Union

from edgevox.agent.llm.language_model import ModelFailed
from edgevox.core.cancel import CancelToken
from edgevox.core.servers.errors import OddAnswer

_TOKEN = re.compile(
    r'\s*("(?:\\.|[^"\\\n])*"|\[(?:\\.|[^\]\\\n])*\]|\{\d+(?:,\d*)?\}|[()|?*+]'
    r"|[A-Za-z][\w-]*\s*::=|[A-Za-z][\w-]*)\s*"
)
_ESCAPE = re.compile(r"\\(?:x([0-9A-Fa-f]{2})|u([0-9A-Fa-f]{4})|U([0-9A-Fa-f]{8})|(.))")
_SHORT = {"n": "\n", "r": "\r", "t": "\t"}
_TIMES: Mapping[str, tuple[int, int | None]] = {"?": (0, 1), "*": (0, None), "+": (1, None)}
_MOST_STACKS = 10_000
"""More ways to go on than this means a grammar that calls itself without end."""


@dataclass(frozen=True, eq=False, slots=True)
class _Character:
    allowed: re.Pattern[str]


@dataclass(frozen=True, eq=False, slots=True)
class _GrammarSequence:
    parts: tuple["_Node", ...]


@dataclass(frozen=True, eq=False, slots=True)
class _GrammarChoice:
    options: tuple["_Node", ...]


@dataclass(frozen=True, slots=True)
class _GrammarRepeat:
    part: "_Node"
    least: int
    most: int | None


@dataclass(frozen=True, slots=True)
class _GrammarRule:
    name: str


_Node = Union[_Character, _GrammarSequence, _GrammarChoice, _GrammarRepeat, _GrammarRule]  # noqa: UP007 - names come later
_Stack = tuple[_Node, "_Stack"] | None
"""What is still to come, nearest first; None is the end of the text."""


@functools.lru_cache(maxsize=32)
def parse(grammar: str) -> Mapping[str, _Node]:
    """The rules by name. Raises `ModelFailed` for a grammar that does not parse."""
    tokens, place = [], 0
    while place < len(grammar):
        found = _TOKEN.match(grammar, place)
        if not found:
            raise ModelFailed(f"failed to parse grammar at {grammar[place : place + 40]!r}")
        tokens.append(found[1])
        place = found.end()
    rules: dict[str, _Node] = {}
    reader = _GrammarReader(tokens)
    while reader.peek().endswith("::="):
        name = reader.take().removesuffix("::=").strip()
        rules[name] = reader.choice()
    unknown = {one for one in tokens if re.fullmatch(r"[A-Za-z][\w-]*", one)} - rules.keys()
    if reader.peek() or unknown or "root" not in rules:
        raise ModelFailed(f"failed to parse grammar: {reader.peek() or unknown or 'no root'}")
    return rules


class _GrammarReader:
    """Recursive descent; an empty token is the end."""

    def __init__(self, tokens: Sequence[str]) -> None:
        self._tokens = tokens
        self._next = 0

    def peek(self) -> str:
        return self._tokens[self._next] if self._next < len(self._tokens) else ""

    def take(self) -> str:
        token = self.peek()
        self._next += 1
        return token

    def choice(self) -> _Node:
        options = [self._sequence()]
        while self.peek() == "|":
            self.take()
            options.append(self._sequence())
        return options[0] if len(options) == 1 else _GrammarChoice(tuple(options))

    def _sequence(self) -> _Node:
        parts: list[_Node] = []
        while (token := self.peek()) and token not in ("|", ")") and not token.endswith("::="):
            parts.append(self._repeated(self._one()))
        return parts[0] if len(parts) == 1 else _GrammarSequence(tuple(parts))

    def _one(self) -> _Node:
        head = self.take()
        if head == "(":
            inner = self.choice()
            if self.take() != ")":
                raise ModelFailed("failed to parse grammar: a parenthesis is not closed")
            return inner
        if head[0] == '"':
            return _GrammarSequence(tuple(_Character(_exactly(c)) for c in _unescape(head[1:-1])))
        if head[0] == "[":
            inside = head[1:-1].replace("[", r"\[")
            return _Character(re.compile(f"[{inside}]", re.DOTALL))
        if not head[0].isalpha():
            raise ModelFailed(f"failed to parse grammar: {head!r} stands after nothing")
        return _GrammarRule(head)

    def _repeated(self, part: _Node) -> _Node:
        token = self.peek()
        if token in _TIMES:
            self.take()
            return _GrammarRepeat(part, *_TIMES[token])
        if token.startswith("{"):
            least, comma, most = self.take()[1:-1].partition(",")
            limit = (int(most) if most else None) if comma else int(least)
            return _GrammarRepeat(part, int(least), limit)
        return part


class Matcher:
    """Follows one text through a grammar."""

    def __init__(self, grammar: str) -> None:
        self._rules = parse(grammar)
        self._stacks = set(self._reach((_GrammarRule("root"), None)))

    @property
    def complete(self) -> bool:
        """True if the text may end here."""
        return None in self._stacks

    def accept(self, piece: str) -> int:
        """Take a piece; return how many of its characters obey, up to the first wrong one."""
        for count, character in enumerate(piece):
            after = {
                stack
                for node, rest in filter(None, self._stacks)
                if isinstance(node, _Character) and node.allowed.match(character)
                for stack in self._reach(rest)
            }
            if not after:
                return count
            self._stacks = after
        return len(piece)

    def _reach(self, stack: _Stack) -> Iterator[_Stack]:
        """All ways to go on from here that wait for a character, or are at the end."""
        seen, waiting = {stack}, [stack]
        while waiting:
            one = waiting.pop()
            if one is None or isinstance(one[0], _Character):
                yield one
                continue
            for following in self._unfold(*one):
                if following not in seen:
                    seen.add(following)
                    waiting.append(following)
            if len(seen) > _MOST_STACKS:
                raise ModelFailed("the grammar calls itself without end")

    def _unfold(self, node: _Node, rest: _Stack) -> Iterator[_Stack]:
        match node:
            case _GrammarRule(name):
                yield (self._rules[name], rest)
            case _GrammarChoice(options):
                yield from ((option, rest) for option in options)
            case _GrammarSequence(parts):
                for part in reversed(parts):
                    rest = (part, rest)
                yield rest
            case _GrammarRepeat(part, least, most):
                if least == 0:
                    yield rest
                if most != 0:
                    fewer = None if most is None else most - 1
                    yield (part, (_GrammarRepeat(part, max(0, least - 1), fewer), rest))


@functools.cache
def _exactly(character: str) -> re.Pattern[str]:
    return re.compile(re.escape(character))


def _unescape(text: str) -> str:
    def one(found: re.Match[str]) -> str:
        code = found[1] or found[2] or found[3]
        return chr(int(code, 16)) if code else _SHORT.get(found[4], found[4])

    return _ESCAPE.sub(one, text)


def enforce_grammar(
    answer: Iterable[str], grammar: str | None, token: CancelToken
) -> Iterator[str]:
    """The pieces of an answer as far as they obey; what is said after its end is left out.

    Raises `OddAnswer` for one that leaves the grammar before its end, and for an empty one.
    """
    if grammar is None:
        yield from answer
        return
    matcher, begun = Matcher(grammar), False
    for piece in answer:
        count = matcher.accept(piece)
        if count:
            begun = True
            yield piece[:count]
        if count < len(piece):
            if matcher.complete:
                return
            raise OddAnswer(f"it does not obey the grammar: {piece[:80]!r}")
    if not begun and not token.cancelled:
        raise OddAnswer("its answer is empty")
