"""How numbers are said in one language: `edgevox.agent.numbers` reads them by it."""

import re
from collections.abc import Mapping
from dataclasses import dataclass, field

Rewriting = tuple[re.Pattern[str], str]
"""A pattern and what it is replaced with."""


@dataclass(frozen=True, slots=True)
class Numbers:
    """How numbers are said: what `edgevox.agent.numbers` reads."""

    decimal_comma: bool = False
    rules: tuple[Rewriting, ...] = ()
    words: Mapping[str, float] = field(default_factory=dict)
    units: str = ""
    centimetres: str = ""
    metres: str = ""
