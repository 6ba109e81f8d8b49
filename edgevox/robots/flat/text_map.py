"""A 2D world as text: walls, furniture, room names, the way ahead, and the robot as an arrow."""

import math
from collections.abc import Sequence
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from edgevox.core.transforms import Pose2D
from edgevox.robots.shapes import Floats, Line, Point, Shape, bounds, distance, inside, place
from edgevox.robots.world.model import World

WALL, FURNITURE, MOVABLE, WAY, GOAL = "█", "▒", "□", "·", "◎"
ARROWS = "→↗↑↖←↙↓↘"
FEWEST_COLUMNS, MOST_COLUMNS = 20, 240
_SAMPLES = 3
"""Along each side of a character."""
_LEAST_WALL, _LEAST_THING = 0.01, 0.5
"""The share of a character that must be covered: any share for a wall, so that thin ones stay
whole."""


def draw(
    world: World,
    robot: Pose2D,
    movable: Sequence[Pose2D],
    way: Sequence[Point],
    columns: int,
) -> str:
    """Lines of `columns` characters (20 to 240), y up; a character is twice as high as wide."""
    columns = min(max(columns, FEWEST_COLUMNS), MOST_COLUMNS)
    canvas = _Canvas(world, columns)
    for thing in world.fixed:
        glyph, least = (WALL, _LEAST_WALL) if thing.is_wall else (FURNITURE, _LEAST_THING)
        canvas.fill([place(part, thing.pose) for part in thing.parts], glyph, least)
    for thing, pose in zip(world.movable, movable, strict=True):
        canvas.fill([place(part, pose) for part in thing.parts], MOVABLE, _LEAST_THING)
    for room in world.rooms:
        canvas.label(room.outline, room.spoken)
    for a, b in pairwise(way):
        steps = max(2, math.ceil(math.dist(a, b) / canvas.cell_m))
        for part in np.linspace(0.0, 1.0, steps):
            canvas.put((a[0] + part * (b[0] - a[0]), a[1] + part * (b[1] - a[1])), WAY)
    if way:
        canvas.put(way[-1], GOAL)
    canvas.put((robot.x_m, robot.y_m), ARROWS[round(robot.yaw_rad / (math.pi / 4)) % 8])
    return canvas.text()


class _Canvas:
    def __init__(self, world: World, columns: int) -> None:
        self._world = world
        self.cell_m = world.width_m / columns
        rows = max(1, round(world.height_m / (2 * self.cell_m)))
        self._row_m = world.height_m / rows
        self._cells: NDArray[np.str_] = np.full((rows, columns), " ", dtype="<U1")
        x = (np.arange(columns * _SAMPLES) + 0.5) * self.cell_m / _SAMPLES + world.x_min_m
        y = world.y_max_m - (np.arange(rows * _SAMPLES) + 0.5) * self._row_m / _SAMPLES
        self._samples: Floats = np.stack(np.meshgrid(x, y), axis=-1)

    def fill(self, shapes: Sequence[Shape], glyph: str, least: float) -> None:
        for shape in shapes:
            x0, y0, x1, y1 = bounds(shape)
            top, left = self._cell((x0 - self.cell_m, y1 + self._row_m))
            bottom, right = self._cell((x1 + self.cell_m, y0 - self._row_m))
            rows, columns = slice(top, bottom + 1), slice(left, right + 1)
            covered = self._covered(shape, self._window(rows, columns))
            self._cells[rows, columns][covered >= least] = glyph

    def put(self, point: Point, glyph: str) -> None:
        self._cells[self._cell(point)] = glyph

    def label(self, area: Shape, text: str) -> None:
        """Write a text where it covers nothing, as near to the middle of an area as it goes."""
        x0, y0, x1, y1 = bounds(area)
        top, left = self._cell((x0, y1))
        bottom, right = self._cell((x1, y0))
        free = [
            (
                abs(2 * row - top - bottom) * 2 + abs(2 * column + len(text) - left - right),
                row,
                column,
            )
            for row in range(top, bottom)
            for column in range(left + 1, right - len(text))
            if (self._cells[row, column - 1 : column + len(text) + 1] == " ").all()
        ]
        if free:
            _, row, column = min(free)
            self._cells[row, column : column + len(text)] = list(text)

    def text(self) -> str:
        return "\n".join("".join(row).rstrip() for row in self._cells)

    def _covered(self, shape: Shape, samples: Floats) -> Floats:
        """Return the share of each character of a window that a shape covers, (rows, columns)."""
        points = samples.reshape(-1, 2)
        thin = self.cell_m / _SAMPLES
        hit = distance(shape, points) < thin if isinstance(shape, Line) else inside(shape, points)
        rows, columns = (n // _SAMPLES for n in samples.shape[:2])
        covered: Floats = hit.reshape(rows, _SAMPLES, columns, _SAMPLES).mean(axis=(1, 3))
        return covered

    def _window(self, rows: slice, columns: slice) -> Floats:
        return self._samples[
            rows.start * _SAMPLES : rows.stop * _SAMPLES,
            columns.start * _SAMPLES : columns.stop * _SAMPLES,
        ]

    def _cell(self, point: Point) -> tuple[int, int]:
        rows, columns = self._cells.shape
        row = math.floor((self._world.y_max_m - point[1]) / self._row_m)
        column = math.floor((point[0] - self._world.x_min_m) / self.cell_m)
        return min(max(row, 0), rows - 1), min(max(column, 0), columns - 1)
