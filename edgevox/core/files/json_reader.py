"""Reads JSON that comes from outside: what two parsers could read differently is refused."""

import json
from collections import Counter
from collections.abc import Iterable, Sequence
from typing import Any

from edgevox.core.errors import InvalidValue

LARGEST_BYTES = 1_000_000
"""The longest text that is read, where a reader does not say otherwise."""
DEEPEST = 32
"""The most objects and lists inside each other."""


class _RefusedJson(ValueError):
    """It is JSON, and still not taken; the message says what would be right."""


def read_json(text: str | bytes, field: str, *, largest_bytes: int = LARGEST_BYTES) -> Any:
    """The value that this text holds. Raises `InvalidValue`, naming `field`.

    A key stands once in its object: parsers differ in which of two they take. Numbers are finite,
    characters are whole, and neither the text nor its nesting is without end.
    """
    size = len(text if isinstance(text, bytes) else text.encode("utf-8", "surrogatepass"))
    if size > largest_bytes:
        raise InvalidValue(field, f"{size} bytes", f"at most {largest_bytes} bytes")
    try:
        data = json.loads(
            text,
            object_pairs_hook=_object,
            parse_constant=_no_constant,
            parse_float=_finite,
        )
        json.dumps(data, ensure_ascii=False).encode()  # half a character is not Unicode
        _check_depth(data)
    except _RefusedJson as error:
        raise InvalidValue(field, text, str(error)) from None
    except (ValueError, RecursionError) as error:
        raise InvalidValue(field, text, f"valid JSON ({error})") from None
    return data


def read_json_object(
    text: str | bytes, field: str, *, largest_bytes: int = LARGEST_BYTES
) -> dict[str, Any]:
    """As `read_json`, of a text that must hold an object."""
    data = read_json(text, field, largest_bytes=largest_bytes)
    if not isinstance(data, dict):
        raise InvalidValue(field, text, "a JSON object, keyword to value")
    return data


def _object(pairs: Sequence[tuple[str, Any]]) -> dict[str, Any]:
    found = dict(pairs)
    if len(found) < len(pairs):
        twice = next(key for key, times in Counter(key for key, _ in pairs).items() if times > 1)
        raise _RefusedJson(f"each key once in its object; {twice!r} is there more than once")
    return found


def _no_constant(constant: str) -> float:
    raise _RefusedJson(f"finite numbers; {constant} is none")


def _finite(digits: str) -> float:
    number = float(digits)
    if number in (float("inf"), float("-inf")):
        raise _RefusedJson(f"finite numbers; {digits[:40]} is none")
    return number


def _check_depth(data: Any) -> None:
    level = list(_holders([data]))
    for _ in range(DEEPEST):
        level = [inner for one in level for inner in _holders(one)]
        if not level:
            return
    if level:
        raise _RefusedJson(f"at most {DEEPEST} objects and lists inside each other")


def _holders(value: dict[str, Any] | list[Any]) -> Iterable[dict[str, Any] | list[Any]]:
    """The objects and lists right inside of one."""
    inner = value.values() if isinstance(value, dict) else value
    return (one for one in inner if isinstance(one, dict | list))


def is_number(value: Any) -> bool:
    """Whether this value is a number; True and False are none."""
    return isinstance(value, int | float) and not isinstance(value, bool)
