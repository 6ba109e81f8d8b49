"""Reads what only EdgeVox knows in a world file: the rooms and the battery."""

import numpy as np

from edgevox.core.errors import InvalidValue
from edgevox.robots.names import read_name
from edgevox.robots.shapes import Point, Polygon, inside
from edgevox.robots.world_fields import Fields
from edgevox.robots.world_model import BatterySpec, Room

MOST_ROOMS = 200


def read_rooms(rooms: Fields) -> tuple[Room, ...]:
    """The rooms, in the file's order."""
    if len(rooms.data) > MOST_ROOMS:
        raise InvalidValue(rooms.where, len(rooms.data), f"at most {MOST_ROOMS} rooms")
    return tuple(
        _room(name, Fields(rooms.path(str(name)), data)) for name, data in rooms.data.items()
    )


def read_battery(fields: Fields) -> BatterySpec:
    """The battery; what is absent is usual."""
    usual = BatterySpec()
    fields.check_keys(BatterySpec.__dataclass_fields__)
    return BatterySpec(
        capacity_wh=fields.positive("capacity_wh", usual.capacity_wh),
        idle_w=fields.number("idle_w", usual.idle_w, low=0.0),
        linear_w_per_m_s=fields.number("linear_w_per_m_s", usual.linear_w_per_m_s, low=0.0),
        angular_w_per_rad_s=fields.number(
            "angular_w_per_rad_s", usual.angular_w_per_rad_s, low=0.0
        ),
        charge_w=fields.number("charge_w", usual.charge_w, low=0.0),
        dock=fields.point("dock") if "dock" in fields else None,
    )


def _room(name: object, fields: Fields) -> Room:
    name = read_name(fields.where, name)
    fields.check_keys(("outline", "goal", "aliases", "hints"))
    outline = Polygon(fields.points("outline", 3))
    goal = fields.point("goal") if "goal" in fields else _middle(outline)
    if not inside(outline, np.array([goal]))[0]:
        raise InvalidValue(fields.path("goal"), list(goal), "a point inside the outline")
    aliases = tuple(read_name(fields.path("aliases"), one) for one in fields.texts("aliases"))
    return Room(name, outline, goal, fields.texts("hints"), aliases)


def _middle(outline: Polygon) -> Point:
    x, y = np.mean(np.asarray(outline.vertices), axis=0)
    return float(x), float(y)
