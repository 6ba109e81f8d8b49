"""What may stand in a line: plain, finite, of one line, not endless, and nobody's words."""

import math
import traceback
from collections.abc import Iterable, Mapping
from types import TracebackType
from typing import Any

from edgevox.core.log import Said
from edgevox.core.text import printable

MOST_CHARACTERS = 8000
"""Longer values are cut in their middle: container engines break lines at 16 KiB."""
_MOST_ITEMS = 64
_INDENT = "  "

ExcInfo = tuple[type[BaseException], BaseException, TracebackType | None]


def plain(value: object, *, speech: bool) -> Any:
    """The value as JSON takes it. What somebody said becomes its length, unless `speech`."""
    if isinstance(value, str):  # first, as most values are
        return cut(value)
    if value is None or isinstance(value, int):  # a bool is one, too
        return value
    if isinstance(value, float):
        return value if math.isfinite(value) else str(value)
    if isinstance(value, Said):
        return cut(value.text) if speech else repr(value)
    if isinstance(value, Mapping):
        pairs = list(value.items())[:_MOST_ITEMS]
        return {str(name): plain(one, speech=speech) for name, one in pairs}
    if isinstance(value, list | tuple | set | frozenset):
        return [plain(one, speech=speech) for one in list(value)[:_MOST_ITEMS]]
    return cut(str(value))


def cut(text: str) -> str:
    """Not endless."""
    if len(text) <= MOST_CHARACTERS:
        return text
    half = MOST_CHARACTERS // 2
    return f"{text[:half]} ... {text[-half:]}"


def trace(error: ExcInfo) -> str:
    """A traceback, its last lines if it is endless.

    Its lines stand further in: what an exception quotes never looks like a line of the log.
    """
    text = cut("".join(_lines(error)).rstrip())
    return "\n".join(f"{_INDENT}{line}" for line in printable(text).split("\n"))


def _lines(error: ExcInfo) -> Iterable[str]:
    kind, value, where = error
    return traceback.format_exception(kind, value, where)
