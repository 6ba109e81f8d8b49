"""The places that a robot knows by name, from a YAML file that its people write.

    dock: {x: 0.0, y: 0.0, yaw: 3.14, aliases: [home, charger]}
    front_door: {x: 4.5, y: -1.2}

Metres and radians (counter-clockwise from x) in the map frame; `yaw` is the way to look there.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from edgevox.core.errors import InvalidValue
from edgevox.core.user_file import read_text
from edgevox.core.yaml_file import parse_yaml
from edgevox.robots.names import read_name
from edgevox.robots.world_fields import Fields
from edgevox.ros2.external.plausible import FURTHEST_M

MOST_LOCATIONS = 200
_KEYS = ("x", "y", "yaw", "aliases")
LONGEST_NAME = 40


@dataclass(frozen=True, slots=True)
class Location:
    """A point of the map (m), the way to look there (rad) if any, and what else it is called."""

    x_m: float
    y_m: float
    yaw_rad: float | None = None
    aliases: tuple[str, ...] = ()


def load_locations(path: Path) -> Mapping[str, Location]:
    """Read and check a locations file.

    Raises `InvalidValue` naming the file, the field, its value and what was expected.
    """
    return parse_locations(read_text(path, "locations"), path.name)


def parse_locations(text: str, name: str) -> Mapping[str, Location]:
    """The locations that this YAML text describes; `name` is the file's name in messages."""
    top = Fields(name, parse_yaml(text, name))
    if not 1 <= len(top.data) <= MOST_LOCATIONS:
        raise InvalidValue(name, f"{len(top.data)} locations", f"1 to {MOST_LOCATIONS}")
    locations = {
        read_name(top.where, key, LONGEST_NAME): _location(top.sub(key)) for key in top.data
    }
    _check_words(top, locations)
    return locations


def _location(fields: Fields) -> Location:
    fields.check_keys(_KEYS)
    for key in ("x", "y"):
        if key not in fields:
            raise InvalidValue(fields.path(key), None, "metres, map frame")
    yaw_rad = fields.number("yaw", 0.0, low=-math.tau, high=math.tau)
    return Location(
        x_m=fields.number("x", 0.0, low=-FURTHEST_M, high=FURTHEST_M),
        y_m=fields.number("y", 0.0, low=-FURTHEST_M, high=FURTHEST_M),
        yaw_rad=yaw_rad if "yaw" in fields else None,
        aliases=tuple(
            read_name(fields.path("aliases"), one, LONGEST_NAME) for one in fields.texts("aliases")
        ),
    )


def _check_words(top: Fields, locations: Mapping[str, Location]) -> None:
    """Refuse what would be said of two places, as matching ignores case and underscores."""
    owners: dict[str, str] = {}
    for name, location in locations.items():
        for said in (name, *location.aliases):
            plain = " ".join(said.casefold().replace("_", " ").split())
            if owners.setdefault(plain, name) != name:
                raise InvalidValue(
                    top.path(name), said, f"a name that {owners[plain]!r} does not have"
                )
