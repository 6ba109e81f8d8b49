"""What the frames of a robot may be called, for the settings and for whoever puts them on /tf."""

import re
from typing import Literal, get_args

MAP = "map"
"""Shared by all robots of a domain."""
BASE = "base_link"
ODOM = "odom"
OdomFrame = Literal["", "odom"]
"""The odometry's frame, or none: `base_link` hangs on `map` then."""
ODOM_FRAMES: tuple[str, ...] = get_args(OdomFrame)
ODOM_EXPECTED = f"empty or {ODOM}"
PREFIX_EXPECTED = "empty, or a prefix such as robot1/: letters, digits, underscores and slashes"
_PREFIX = re.compile(r"([A-Za-z][A-Za-z0-9_]*(/[A-Za-z_][A-Za-z0-9_]*)*/?)?")


def is_prefix(text: str) -> bool:
    """Whether frames may begin with it: names with a slash between, a letter first, or nothing."""
    return _PREFIX.fullmatch(text) is not None
