"""Where the objects of one entry of a world file stand: IR-SIM's `distribution`."""

import math
import random
from collections.abc import Sequence

from edgevox.core.errors import InvalidValue
from edgevox.core.transforms import Pose2D
from edgevox.robots.world_fields import Fields, as_numbers

Area = tuple[Pose2D, Pose2D]
_KEYS = {
    "manual": {"name", "3d"},
    "circle": {"name", "3d", "radius", "center"},
    "random": {"name", "3d", "range_low", "range_high", "min_distance"},
}
_TRIES = 1000


def poses(group: Fields, number: int, area: Area, dice: random.Random) -> list[Pose2D]:
    """A pose for each of `number` objects. `area` is the world less a margin, corner to corner."""
    distribution = group.sub("distribution")
    name = distribution.text("name", "manual")
    if name not in _KEYS:
        raise InvalidValue(distribution.path("name"), name, "one of " + ", ".join(_KEYS))
    distribution.check_keys(_KEYS[name])
    if name == "circle":
        return _on_circle(distribution, number, area)
    if name == "random":
        return _at_random(distribution, number, area, dice)
    return _as_written(group, number)


def _as_written(group: Fields, number: int) -> list[Pose2D]:
    state = group.get("state")
    if state is None:
        state = [1, 1, 0]
    path = group.path("state")
    if not isinstance(state, list) or not state:
        raise InvalidValue(path, state, "[x, y, heading] or a list of them")
    if not isinstance(state[0], list):
        return [_pose(path, state)] * number
    return [_pose(f"{path}[{i}]", state[min(i, len(state) - 1)]) for i in range(number)]


def _pose(where: str, state: object) -> Pose2D:
    x, y, yaw = (*as_numbers(where, state, 2), 0.0)[:3]
    return Pose2D(x, y, yaw)


def _on_circle(fields: Fields, number: int, area: Area) -> list[Pose2D]:
    low, high = area
    radius = fields.positive("radius", min(high.x_m - low.x_m, high.y_m - low.y_m) / 2)
    x, y = (low.x_m + high.x_m) / 2, (low.y_m + high.y_m) / 2
    if "center" in fields:
        x, y = as_numbers(fields.path("center"), fields.get("center"), 2)[:2]
    angles = [2 * math.pi * i / number for i in range(number)]
    return [Pose2D(x + radius * math.cos(a), y + radius * math.sin(a), a - math.pi) for a in angles]


def _at_random(fields: Fields, number: int, area: Area, dice: random.Random) -> list[Pose2D]:
    corners = [(corner.x_m, corner.y_m, corner.yaw_rad) for corner in area]
    for i, key in enumerate(("range_low", "range_high")):
        if key in fields:
            x, y, yaw = as_numbers(fields.path(key), fields.get(key), 3)[:3]
            corners[i] = (x, y, yaw)
    gap = fields.number("min_distance", 1.0, low=0.0)
    found: list[Pose2D] = []
    for _ in range(number):
        found.append(_far_from(found, corners, gap, fields, dice))
    return found


def _far_from(
    others: Sequence[Pose2D],
    corners: list[tuple[float, float, float]],
    gap: float,
    fields: Fields,
    dice: random.Random,
) -> Pose2D:
    for _ in range(_TRIES):
        pose = Pose2D(*(dice.uniform(a, b) for a, b in zip(*corners, strict=True)))
        if all(math.hypot(pose.x_m - o.x_m, pose.y_m - o.y_m) >= gap for o in others):
            return pose
    raise InvalidValue(
        fields.path("min_distance"), gap, "a smaller distance: there is no room for so many"
    )
