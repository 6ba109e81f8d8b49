"""A grid over the world that knows, for each cell, how far its centre is from what is solid."""

import math
from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from edgevox.robots.shapes import Floats, Point, Shape, bounds, distance
from edgevox.robots.world_model import World

CELL_M = 0.05
MOST_CELLS = 1000
"""Along one side; a larger world gets larger cells."""


def cell_size(world: World) -> float:
    """How wide the cells of a world's grid are, in metres."""
    return max(CELL_M, max(world.width_m, world.height_m) / MOST_CELLS)


class Grid:
    """Clearances, (rows, columns) metres, row 0 at the lower edge, known up to `reach_m`."""

    def __init__(self, world: World, reach_m: float) -> None:
        self.cell_m = cell_size(world)
        self.reach_m = reach_m
        self._x_m, self._y_m = world.x_min_m, world.y_min_m
        columns = math.ceil(world.width_m / self.cell_m)
        rows = math.ceil(world.height_m / self.cell_m)
        x = self._x_m + (np.arange(columns) + 0.5) * self.cell_m
        y = self._y_m + (np.arange(rows) + 0.5) * self.cell_m
        to_x_edge = np.minimum(x - world.x_min_m, world.x_max_m - x)
        to_y_edge = np.minimum(y - world.y_min_m, world.y_max_m - y)
        self.clearance_m: Floats = np.minimum(
            np.minimum(to_x_edge[None, :], to_y_edge[:, None]), reach_m
        )

    def add(self, shapes: Iterable[Shape]) -> "Grid":
        """A copy with these shapes in it too."""
        copy: Grid = object.__new__(Grid)
        copy.__dict__.update(self.__dict__)
        copy.clearance_m = self.clearance_m.copy()
        for shape in shapes:
            copy._stamp(shape)
        return copy

    def cell(self, point: Point) -> tuple[int, int]:
        """Row and column of the cell that holds a point, the nearest cell for one outside."""
        rows, columns = self.clearance_m.shape
        row = math.floor((point[1] - self._y_m) / self.cell_m)
        column = math.floor((point[0] - self._x_m) / self.cell_m)
        return min(max(row, 0), rows - 1), min(max(column, 0), columns - 1)

    def center(self, row: int, column: int) -> Point:
        """The middle of a cell."""
        return self._x_m + (column + 0.5) * self.cell_m, self._y_m + (row + 0.5) * self.cell_m

    def along(self, start: Point, end: Point) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
        """Rows and columns of the cells that a straight line passes, half a cell apart."""
        length = math.hypot(end[0] - start[0], end[1] - start[1])
        last = max(1, math.ceil(2 * length / self.cell_m))
        steps = np.arange(last + 1) * (1.0 / last)
        rows, columns = self.clearance_m.shape
        y = start[1] + steps * (end[1] - start[1]) - self._y_m
        x = start[0] + steps * (end[0] - start[0]) - self._x_m
        row = np.minimum(np.maximum((y / self.cell_m).astype(np.intp), 0), rows - 1)
        column = np.minimum(np.maximum((x / self.cell_m).astype(np.intp), 0), columns - 1)
        return row, column  # not `np.clip`, which takes as long as all that is above

    def nearest(self, point: Point, free: NDArray[np.bool_], within_m: float) -> Point | None:
        """The middle of the free cell that is nearest to a point, None if all are farther."""
        rows, columns = np.nonzero(free)
        if not len(rows):
            return None
        x = self._x_m + (columns + 0.5) * self.cell_m - point[0]
        y = self._y_m + (rows + 0.5) * self.cell_m - point[1]
        gaps = np.hypot(x, y)
        best = int(gaps.argmin())
        return self.center(int(rows[best]), int(columns[best])) if gaps[best] <= within_m else None

    def _stamp(self, shape: Shape) -> None:
        x0, y0, x1, y1 = bounds(shape)
        low = self.cell((x0 - self.reach_m, y0 - self.reach_m))
        high = self.cell((x1 + self.reach_m, y1 + self.reach_m))
        window = (slice(low[0], high[0] + 1), slice(low[1], high[1] + 1))
        x = self._x_m + (np.arange(low[1], high[1] + 1) + 0.5) * self.cell_m
        y = self._y_m + (np.arange(low[0], high[0] + 1) + 0.5) * self.cell_m
        points = np.column_stack([np.tile(x, len(y)), np.repeat(y, len(x))])
        far = distance(shape, points).reshape(len(y), len(x))
        self.clearance_m[window] = np.minimum(self.clearance_m[window], far)
