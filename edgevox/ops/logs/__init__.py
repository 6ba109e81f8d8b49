"""Logs: how a line looks, where it goes, what is held back, and what the bus says in them.

Modules write lines with `edgevox.core.log`; only programs set this up. Imports core.
"""

from edgevox.ops.logs.observer import BusLog
from edgevox.ops.logs.setup import (
    LEVELS,
    RateLimit,
    TurnLines,
    is_set_up,
    level_of,
    set_level,
    set_up,
    tear_down,
    writes_json,
)

__all__ = [
    "LEVELS",
    "BusLog",
    "RateLimit",
    "TurnLines",
    "is_set_up",
    "level_of",
    "set_level",
    "set_up",
    "tear_down",
    "writes_json",
]
