"""Why something that was asked for is not taken: counted and logged under these names."""

from enum import StrEnum


class Refusal(StrEnum):
    """A reason, as data; the sentence that goes with it says the rest."""

    TOO_LONG = "too_long"
    TOO_MANY = "too_many"
    NOT_FINITE = "not_finite"
    IMPLAUSIBLE = "implausible"
    FORBIDDEN = "forbidden"
    INVALID = "invalid"
