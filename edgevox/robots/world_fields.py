"""Reads fields of a world file; every error names the file, the field, the value and what fits."""

import difflib
import math
from collections.abc import Collection, Iterator, Mapping
from typing import Any

from edgevox.core.errors import InvalidValue
from edgevox.core.log import get_logger

log = get_logger(__name__)

LARGEST = 1e6
"""No coordinate, size or speed of a world may be greater; it keeps arithmetic well-behaved."""


class Fields:
    """One mapping of a world file, with its place in the file for messages."""

    def __init__(self, where: str, data: Any) -> None:
        if not isinstance(data, Mapping):
            raise InvalidValue(where, data, "a mapping of keys to values")
        self.where = where
        self.data: Mapping[str, Any] = data

    def __contains__(self, key: str) -> bool:
        return self.data.get(key) is not None

    def path(self, key: str) -> str:
        """The full name of a field in messages."""
        return f"{self.where}.{key}"

    def check_keys(self, known: Collection[str], *, others: bool = False) -> None:
        """Refuse unknown keys; with `others`, only those that look like a mistyped known one."""
        for key in self.data:
            if key in known:
                continue
            close = difflib.get_close_matches(str(key), known, n=1, cutoff=0.7)
            if close:
                raise InvalidValue(self.path(str(key)), key, f"did you mean {close[0]!r}?")
            if not others:
                raise InvalidValue(self.path(str(key)), key, "one of " + ", ".join(sorted(known)))
            log.warning("world_key_ignored", where=self.path(str(key)))

    def get(self, key: str) -> Any:
        return self.data.get(key)

    def sub(self, key: str) -> "Fields":
        """A mapping inside this one; an absent one is empty."""
        value = self.data.get(key)
        return Fields(self.path(key), {} if value is None else value)

    def each(self, key: str) -> Iterator["Fields"]:
        """A list of mappings, or a single one, inside this one."""
        value = self.data.get(key)
        if value is None:
            return
        if isinstance(value, Mapping):
            yield Fields(self.path(key), value)
            return
        if not isinstance(value, list):
            raise InvalidValue(self.path(key), value, "a list of mappings")
        for index, one in enumerate(value):
            yield Fields(f"{self.path(key)}[{index}]", one)

    def number(
        self, key: str, default: float, *, low: float = -LARGEST, high: float = LARGEST
    ) -> float:
        """A finite number from `low` to `high`."""
        value = self.data.get(key)
        return default if value is None else as_number(self.path(key), value, low, high)

    def positive(self, key: str, default: float) -> float:
        """A finite number above 0."""
        value = self.number(key, default, low=0.0)
        if value <= 0.0:
            raise InvalidValue(self.path(key), value, "a number above 0")
        return value

    def whole(self, key: str, default: int, *, low: int, high: int) -> int:
        """A whole number from `low` to `high`."""
        value = self.data.get(key, default)
        if isinstance(value, bool) or not isinstance(value, int) or not low <= value <= high:
            raise InvalidValue(self.path(key), value, f"a whole number from {low} to {high}")
        return value

    def text(self, key: str, default: str) -> str:
        value = self.data.get(key, default)
        if not isinstance(value, str) or not value.strip():
            raise InvalidValue(self.path(key), value, "a text")
        return value

    def flag(self, key: str) -> bool:
        """True or False, False if absent."""
        value = self.data.get(key, False)
        if not isinstance(value, bool):
            raise InvalidValue(self.path(key), value, "true or false")
        return value

    def point(self, key: str) -> tuple[float, float]:
        """Two numbers, x and y."""
        return as_point(self.path(key), self.data.get(key))

    def points(self, key: str, least: int) -> tuple[tuple[float, float], ...]:
        """A list of at least `least` points."""
        value = self.data.get(key)
        if not isinstance(value, list) or not least <= len(value) <= 1000:
            raise InvalidValue(self.path(key), value, f"a list of {least} to 1000 [x, y] points")
        return tuple(as_point(f"{self.path(key)}[{i}]", p) for i, p in enumerate(value))

    def texts(self, key: str) -> tuple[str, ...]:
        """A list of texts, empty if absent."""
        value = self.data.get(key) or []
        if not isinstance(value, list) or not all(isinstance(v, str) for v in value):
            raise InvalidValue(self.path(key), value, "a list of texts")
        return tuple(value)


def as_number(where: str, value: Any, low: float = -LARGEST, high: float = LARGEST) -> float:
    """A finite number within bounds, or an `InvalidValue` that says so."""
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise InvalidValue(where, value, "a number")
    if isinstance(value, float) and not math.isfinite(value):
        raise InvalidValue(where, value, "a finite number")
    if not low <= value <= high:
        raise InvalidValue(where, value, f"a number from {low:g} to {high:g}")
    return float(value)


def as_point(where: str, value: Any) -> tuple[float, float]:
    """Two finite numbers, or an `InvalidValue` that says so."""
    if not isinstance(value, list) or len(value) != 2:
        raise InvalidValue(where, value, "two numbers [x, y]")
    return as_number(f"{where}[0]", value[0]), as_number(f"{where}[1]", value[1])


def as_numbers(where: str, value: Any, least: int) -> tuple[float, ...]:
    """At least `least` finite numbers; IR-SIM cuts or ignores what is beyond."""
    if not isinstance(value, list) or len(value) < least:
        raise InvalidValue(where, value, f"a list of at least {least} numbers")
    return tuple(as_number(f"{where}[{i}]", v) for i, v in enumerate(value))


def words(text: str) -> frozenset[str]:
    """The words of a text: a set of keys that is readable where it stands."""
    return frozenset(text.split())
