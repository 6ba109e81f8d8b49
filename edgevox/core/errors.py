"""The root of every error that EdgeVox raises on purpose.

Why something that was asked for is not taken: counted and logged under these names.
"""

import math
from enum import StrEnum

from edgevox.core.files.text import one_line


class Refusal(StrEnum):
    """A reason, as data; the sentence that goes with it says the rest."""

    TOO_LONG = "too_long"
    TOO_MANY = "too_many"
    NOT_FINITE = "not_finite"
    IMPLAUSIBLE = "implausible"
    FORBIDDEN = "forbidden"
    INVALID = "invalid"


class EdgeVoxError(Exception):
    """Something was wrong; the message says what, with which value, and what would be right."""


class InvalidValue(EdgeVoxError):
    """A named field holds a value that cannot be honoured.

    The message reads ``field: got value, expected expectation``; the parts stay available so that a
    face (a ROS 2 parameter result, the terminal) can say them its own way.
    """

    def __init__(
        self, field: str, value: object, expected: str, reason: Refusal = Refusal.INVALID
    ) -> None:
        self.reason = reason
        self.field = field
        self.value = value
        self.expected = expected
        super().__init__(f"{one_line(field)}: got {shorten(value)}, expected {one_line(expected)}")


def finite(field: str, value: float) -> float:
    """The value as a float. Raises `InvalidValue` if it is not finite."""
    if not math.isfinite(value):
        raise InvalidValue(field, value, "a finite number")
    return float(value)


def shorten(value: object, limit: int = 80) -> str:
    """``repr`` of a value, cut in the middle so that a message stays one readable line."""
    text = repr(value)
    if len(text) <= limit:
        return text
    keep = (limit - 1) // 2
    return f"{text[:keep]}…{text[-keep:]}"
