"""Some languages for all of them, where each of them costs much."""

from collections.abc import Iterable
from typing import Any

import pytest

FEW = ("en", "de", "ar", "ja")
"""Without cases and with them, from right to left, and without spaces between words."""


def few(codes: Iterable[str]) -> list[Any]:
    """These languages, as what a test is to be done with: all but a few are `long`."""
    return [pytest.param(one, marks=() if one in FEW else pytest.mark.long) for one in codes]
