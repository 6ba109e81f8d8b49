"""The places that a robot knows by name, from a YAML file that its people write.

    dock: {x: 0.0, y: 0.0, yaw: 3.14, aliases: [home, charger]}
    front_door: {x: 4.5, y: -1.2, names: {de: die Haustür, fr: [la porte d'entrée, la porte]}}

Metres and radians (counter-clockwise from x) in the map frame; `yaw` is the way to look there.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import Annotated

from pydantic import AfterValidator, Field, RootModel

from edgevox.agent.skills import OwnName
from edgevox.core.files.user_file import read_text
from edgevox.core.files.yaml_file import YamlFile
from edgevox.robots.names import LONGEST_PLACE, LocalNames, check_told_apart, read_name
from edgevox.robots.world.fields import Finite, WorldPart, called, listed, within
from edgevox.ros2.external.settings import FURTHEST_M

MOST_LOCATIONS = 200

Metres = Annotated[Finite, within(-FURTHEST_M, FURTHEST_M)]
Name = Annotated[str, called(partial(read_name, longest=LONGEST_PLACE))]


@dataclass(frozen=True, slots=True)
class Location:
    """A point of the map.

    Metres, and the heading in radians, if it has one. `names` are its names by language.
    """

    x_m: float
    y_m: float
    yaw_rad: float | None = None
    aliases: tuple[str, ...] = ()
    names: Mapping[str, OwnName] = field(default_factory=dict)


class LocationEntry(WorldPart):
    """A location of a locations file."""

    x: Metres | None = None
    y: Metres | None = None
    yaw: Annotated[Finite, within(-math.tau, math.tau)] | None = None
    aliases: Annotated[tuple[Name, ...], listed("a list of texts", 0)] = ()
    names: LocalNames = Field(default_factory=dict)


def _home(entries: dict[str, LocationEntry]) -> dict[str, LocationEntry]:
    if not 1 <= len(entries) <= MOST_LOCATIONS:
        raise ValueError(f"1 to {MOST_LOCATIONS} locations")
    check_told_apart({name: (one.aliases, one.names) for name, one in entries.items()})
    return entries


class LocationsFile(RootModel[Annotated[dict[Name, LocationEntry], AfterValidator(_home)]]):
    """A locations file."""


def load_locations(path: Path) -> Mapping[str, Location]:
    """Read and check a locations file.

    Raises `InvalidValue` naming the file, the field, its value and the expected value.
    """
    return parse_locations(read_text(path, "locations"), path.name)


def parse_locations(text: str, name: str) -> Mapping[str, Location]:
    """The locations that this YAML text describes; `name` is the file's name in messages."""
    return read_locations(YamlFile(text, name))


def read_locations(file: YamlFile) -> Mapping[str, Location]:
    """The locations of a file, or of a part of one. Raises as `load_locations`."""
    entries = file.read(LocationsFile, file.data).root
    return {key: _location(file, key, entry) for key, entry in entries.items()}


def _location(file: YamlFile, name: str, entry: LocationEntry) -> Location:
    if entry.x is None or entry.y is None:
        raise file.wrong((name, "x" if entry.x is None else "y"), None, "metres, map frame")
    return Location(entry.x, entry.y, entry.yaw, entry.aliases, entry.names)
