"""A reader of JSON from outside, which refuses text that two parsers could read differently."""

import json
from collections import Counter
from collections.abc import Iterable, Sequence
from typing import Any

from edgevox.core.errors import InvalidValue

LARGEST_BYTES = 1_000_000
"""Default length of the longest text, in bytes."""
DEEPEST = 32
"""Largest depth of nested objects and lists."""


class _RefusedJson(ValueError):
    """Valid JSON that is refused; the message names the expectation."""


def read_json(text: str | bytes, field: str, *, largest_bytes: int = LARGEST_BYTES) -> Any:
    """The value of a JSON text. Raises `InvalidValue`, naming `field`.

    Keys must be unique in their object, because parsers differ in which of two they take. Numbers
    must be finite and characters whole; length and depth are bounded.
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
    """The object of a JSON text; as `read_json` otherwise."""
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
    """The objects and lists directly inside a value."""
    inner = value.values() if isinstance(value, dict) else value
    return (one for one in inner if isinstance(one, dict | list))


def is_number(value: Any) -> bool:
    """True for a number; True and False are none."""
    return isinstance(value, int | float) and not isinstance(value, bool)
