"""Data from outside: JSON and pydantic's models, with the field and the expectation in each error.

`read_json` refuses text that two parsers could read differently; `explain` makes an `InvalidValue`
of pydantic's errors.
"""

import json
import re
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from types import MappingProxyType
from typing import Any, TypeVar

from pydantic import TypeAdapter, ValidationError
from pydantic_core import ErrorDetails, InitErrorDetails, PydanticCustomError

from edgevox.core.errors import InvalidFile, InvalidValue

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


T = TypeVar("T")
Place = tuple[str | int, ...]
"""The way to a value inside others: keys of mappings, indices of lists."""

_EXPECTED = {
    "missing": "a value",
    "extra_forbidden": "no such key",
    **dict.fromkeys(("model_type", "dataclass_type", "dict_type"), "a mapping, key to value"),
}
_TEXT_TYPES = ("string_type", "invalid_key")
_QUOTE = "quote it, because YAML reads no, off, yes and on as true or false"


def explain(
    error: ValidationError,
    name: Callable[[Place], str],
    other: Mapping[str, str] = MappingProxyType({}),
) -> InvalidValue:
    """The first problem as an `InvalidValue`. `name` returns the name of a place.

    `other` maps pydantic's error types to expectations that replace those of this module.
    """
    return explain_all(error, name, other)[0]


def read_message(kind: TypeAdapter[T], text: str, name: str, most: int) -> T:
    """Read JSON of at most so many characters. Raises `InvalidValue` for a field of `name`."""
    if len(text) > most:
        raise InvalidValue(name, f"{len(text)} characters", f"at most {most}")
    try:
        return kind.validate_json(text)
    except ValidationError as error:
        raise explain(error, lambda place: dotted((name, *place))) from None


def explain_all(
    error: ValidationError,
    name: Callable[[Place], str],
    other: Mapping[str, str] = MappingProxyType({}),
) -> list[InvalidValue]:
    """All problems, as `explain` returns the first; each field once.

    Where a value may be of several kinds, the kind that it fits best tells what is wrong.
    """
    errors = error.errors(include_url=False)
    fields = [name(one["loc"]) for one in errors]
    found: dict[str, InvalidValue] = {}
    for field, one in zip(fields, errors, strict=True):
        inner = any(other.startswith(f"{field}.") for other in fields)
        if not (inner and one["loc"] and names_a_kind(one["loc"][-1])):
            found.setdefault(field, _explained(field, one, other))
    return list(found.values())


_KIND = re.compile(r"(bool|int|float|str|[A-Z]\w*|[a-z-]+\[.*\]|constrained-\w+)")


def names_a_kind(part: str | int) -> bool:
    """True for the name of one of several kinds that a value may be, as pydantic adds it."""
    return isinstance(part, str) and _KIND.fullmatch(part) is not None


def _explained(field: str, one: ErrorDetails, other: Mapping[str, str]) -> InvalidValue:
    said = one["msg"].removeprefix("Value error, ").removeprefix("Input should be ")
    value = None if one["type"] == "missing" else _without_password(one["input"])
    expected = {**_EXPECTED, **other}.get(one["type"], said)
    if one["type"] in _TEXT_TYPES and isinstance(value, bool):
        expected += f": {_QUOTE}"
    return InvalidValue(field, value, expected)


def told(problems: Sequence[InvalidValue]) -> InvalidValue:
    """These problems, of which there is one at least, as one error."""
    return problems[0] if len(problems) == 1 else InvalidFile(problems)


class Problems:
    """Collects what is wrong with the parts of a file, so that all of it is told at once."""

    def __init__(self, found: Iterable[InvalidValue] = ()) -> None:
        self.found: list[InvalidValue] = list(found)

    @contextmanager
    def collect(self) -> Iterator[None]:
        """Keep the problems of this part, instead of raising them."""
        try:
            yield
        except InvalidValue as error:
            self.found += error.problems

    def tell(self) -> None:
        """Raise `InvalidValue` if there are any, in the order of their lines."""
        if self.found:
            raise told(sorted(self.found, key=_line_of))


def _line_of(problem: InvalidValue) -> int:
    """The line that a field is in, by its name; 0 if it names none."""
    named = re.match(r"[^:]*:(\d+):", problem.field)
    return int(named[1]) if named else 0


def wrong(place: Place, value: object, expected: str) -> ValidationError:
    """The error that a validator of a whole mapping raises for a value inside it."""
    message = PydanticCustomError("value_error", "{expected}", {"expected": expected})
    details = InitErrorDetails(type=message, loc=place, input=value)
    return ValidationError.from_exception_data("value", [details])


def dotted(place: Place) -> str:
    """The name of a place, its parts joined by dots."""
    return ".".join(map(str, place))


def _without_password(value: object) -> object:
    """A value that may be shown: without the part of an address before its @."""
    return re.sub(r"//[^/]*@", "//***@", value) if isinstance(value, str) else value
