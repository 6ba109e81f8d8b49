"""Walks a GBNF grammar at random: what it writes is what a model could have written."""

import random
import re

_TOKEN = re.compile(r'\s*("(?:\\.|[^"\\])*"|\[(?:\\.|[^\]\\])*\]|\{\d+,\d+\}|[()|?]|[\w-]+)')
_ESCAPE = re.compile(r"\\x([0-9a-f]{2})|\\(.)")
_LETTERS = [chr(code) for code in range(128)] + ["é", "東", "🤖"]


class Walker:
    """One random choice after the other, all of them allowed."""

    def __init__(self, grammar: str, source: random.Random) -> None:
        lines = [line for line in grammar.splitlines() if line.strip()]
        parts = (line.partition("::=") for line in lines)
        self._rules = {name.strip(): _TOKEN.findall(body) for name, _, body in parts}
        self._random = source

    def walk(self, rule: str = "root") -> str:
        options, rest = self._options(self._rules[rule])
        assert not rest, f"{rule}: {rest} is left over"
        return self._write(self._random.choice(options))

    def _options(self, tokens):
        """Alternatives, each a list of (what, least, most), up to a closing parenthesis."""
        options, current = [], []
        while tokens:
            head, tokens = tokens[0], tokens[1:]
            if head == ")":
                return [*options, current], [")", *tokens]
            if head == "|":
                options, current = [*options, current], []
            elif head == "?":
                current[-1] = (current[-1][0], 0, 1)
            elif head[0] == "{":
                least, most = map(int, head[1:-1].split(","))
                current[-1] = (current[-1][0], least, most)
            elif head == "(":
                inner, tokens = self._options(tokens)
                assert tokens[0] == ")"
                tokens = tokens[1:]
                current.append((inner, 1, 1))
            else:
                current.append((head, 1, 1))
        return [*options, current], []

    def _write(self, sequence) -> str:
        times = ((what, self._random.randint(least, most)) for what, least, most in sequence)
        return "".join(self._one(what) for what, count in times for _ in range(count))

    def _one(self, what) -> str:
        if isinstance(what, list):
            return self._write(self._random.choice(what))
        if what[0] == '"':
            return _unescape(what[1:-1])
        if what[0] == "[":
            allowed = re.compile(what, re.DOTALL)
            return self._random.choice([c for c in _LETTERS if allowed.fullmatch(c)])
        return self.walk(what)


def _unescape(text: str) -> str:
    return _ESCAPE.sub(lambda m: chr(int(m[1], 16)) if m[1] else m[2], text)
