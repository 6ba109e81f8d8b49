"""JSON that every parser reads, whatever the numbers in it."""

import json
import math
from collections.abc import Mapping
from typing import Any

_ENCODER = json.JSONEncoder(ensure_ascii=False, allow_nan=False, default=str)
"""One for all: `json.dumps` makes a new one each time that it is told how."""


def write(data: Mapping[str, Any]) -> str:
    """A JSON object that every parser reads: what is not finite becomes null."""
    try:
        text = _ENCODER.encode(data)
        text.encode()
    except ValueError:
        return json.dumps(_finite(data), default=str)
    return text


def _finite(value: Any) -> Any:
    if isinstance(value, float) and not math.isfinite(value):
        return None
    if isinstance(value, Mapping):
        return {str(key): _finite(one) for key, one in value.items()}
    if isinstance(value, list | tuple):
        return [_finite(one) for one in value]
    return value
