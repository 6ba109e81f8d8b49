"""What only EdgeVox knows in a world file: the rooms and the battery."""

from typing import Annotated, Any, Self

import numpy as np
from pydantic import AfterValidator, BeforeValidator, Field, model_validator

from edgevox.core.validation import wrong
from edgevox.robots.name_fields import read_name
from edgevox.robots.names_per_language import LocalNames, check_told_apart
from edgevox.robots.shapes import Point, Polygon, inside
from edgevox.robots.world_fields import XY, WorldPart, called, check_keys, listed
from edgevox.robots.world_model import BatterySpec, Room

MOST_ROOMS = 200
TEXTS = listed("a list of texts", 0)
Name = Annotated[str, called(read_name)]


class RoomPart(WorldPart):
    """A room, and the point that it is driven to: the middle, unless it is given."""

    outline: Annotated[tuple[XY, ...], listed("a list of 3 to 1000 [x, y] points", 3, 1000)]
    goal: XY | None = None
    aliases: Annotated[tuple[Name, ...], TEXTS] = ()
    names: LocalNames = Field(default_factory=dict)
    hints: Annotated[tuple[str, ...], TEXTS] = ()

    @model_validator(mode="after")
    def _reaches_its_goal(self) -> Self:
        if not inside(Polygon(self.outline), np.array([self._spot]))[0]:
            raise wrong(("goal",), list(self._spot), "a point inside the outline")
        return self

    @property
    def _spot(self) -> Point:
        x, y = self.goal or np.mean(np.asarray(self.outline), axis=0)
        return float(x), float(y)

    def named(self, name: str) -> Room:
        """The room of this name."""
        return Room(name, Polygon(self.outline), self._spot, self.hints, self.aliases, self.names)


def _few(rooms: dict[str, RoomPart]) -> dict[str, RoomPart]:
    if len(rooms) > MOST_ROOMS:
        raise ValueError(f"at most {MOST_ROOMS} rooms")
    check_told_apart({name: (one.aliases, one.names) for name, one in rooms.items()})
    return rooms


def _battery(data: Any) -> Any:
    if isinstance(data, dict):
        check_keys(data, BatterySpec.__dataclass_fields__)
        return {key: value for key, value in data.items() if value is not None}
    return data


class EdgevoxPart(WorldPart):
    """All of it."""

    rooms: Annotated[dict[Name, RoomPart], AfterValidator(_few)] = Field(default_factory=dict)
    battery: Annotated[BatterySpec, BeforeValidator(_battery)] = BatterySpec()
