"""A path planner for a round robot in a 2D world; a failure gives its reason in words.

`Grid` knows the distance from each cell's centre to the nearest solid thing.
"""

import math
from collections.abc import Iterable, Sequence
from itertools import pairwise

import numpy as np
import tcod.path
from numpy.typing import NDArray

from edgevox.agent.skills import SkillFailed
from edgevox.agent.text.reasons import because
from edgevox.core.transforms import Pose2D
from edgevox.robots.shapes import Floats, Point, Shape, bounds, distance, inside, place
from edgevox.robots.world.model import Room, Thing, World

CELL_M = 0.05
MOST_CELLS = 1000
"""Along one side; a larger world gets larger cells."""


def cell_size(world: World) -> float:
    """Return the width of the cells of a world's grid, in metres."""
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


CLEARANCE_M = 0.05
"""Kept from everything, always; more where large cells make the grid vague."""
COMFORT_M = 0.2
"""Kept from everything where there is room; closer costs three times as much."""
_ESCAPE_M = 0.5
"""The radius within which a robot that stands too close to a thing looks for a free place."""

_ENDLESS = np.iinfo(np.int32).max
"""The distance of a cell that cannot be reached."""
_SAMPLES = 200

Costs = NDArray[np.int8]


class PathPlanner:
    """Finds paths. What stands still is prepared once, movable things are added for each plan."""

    def __init__(self, world: World) -> None:
        self._world = world
        self._radius_m = world.robot.radius_m
        self._solid = [_Solid(thing, thing.pose) for thing in world.fixed]
        fixed = [shape for solid in self._solid for shape in solid.shapes]
        cell_m = cell_size(world)
        self._least_m = self._radius_m + max(CLEARANCE_M, 0.71 * cell_m)
        self._comfort_m = max(self._radius_m + COMFORT_M - cell_m, self._least_m)
        self._fixed = Grid(world, self._comfort_m + cell_m).add(fixed)

    def plan(
        self,
        start: Point,
        goal: Point,
        movable: Sequence[Pose2D],
        forbidden: Sequence[Room] = (),
    ) -> tuple[Point, ...]:
        """Corners of a path from start to goal, both included, round the rooms that are forbidden.

        A robot that stands in one of them leaves it by the shortest way. Raises `SkillFailed` with
        a reason that a person may hear.
        """
        loose = [_Solid(*both) for both in zip(self._world.movable, movable, strict=True)]
        self._check_goal(goal, [*self._solid, *loose])
        if there := _rooms_at(goal, forbidden):
            raise SkillFailed(because("policy_place", place=there[0].spoken))
        shapes = [shape for solid in loose for shape in solid.shapes]
        cluttered = self._fixed.add(shapes)
        if path := self._around(cluttered, start, goal, forbidden):
            return path
        if shapes and self._around(self._fixed, start, goal, forbidden):
            raise SkillFailed(because("furniture"))
        if forbidden and (path := self._search(cluttered, start, goal)):
            raise SkillFailed(because("policy_way", place=_crossed(path, forbidden)))
        raise SkillFailed(because("no_way"))

    def _check_goal(self, goal: Point, solids: Sequence["_Solid"]) -> None:
        self._world.bounds.check(*goal)
        near = [solid for solid in solids if solid.near(goal, self._radius_m)]
        gaps = [(solid.gap(goal), solid.thing) for solid in near]
        gap, thing = min(gaps, key=lambda pair: pair[0], default=(np.inf, None))
        if thing and gap == 0.0:
            raise SkillFailed(because("taken", thing=thing.named))
        if thing and gap < self._radius_m:
            raise SkillFailed(because("too_close", thing=thing.named))
        if self._to_edge(goal) < self._radius_m:
            raise SkillFailed(because("at_the_edge"))

    def _to_edge(self, goal: Point) -> float:
        world = self._world
        x, y = goal
        return min(x - world.x_min_m, world.x_max_m - x, y - world.y_min_m, world.y_max_m - y)

    def _around(
        self, grid: Grid, start: Point, goal: Point, forbidden: Sequence[Room]
    ) -> tuple[Point, ...]:
        """The path round these rooms, which are as solid as walls; empty if there is none."""
        shut = grid.add(room.outline for room in forbidden) if forbidden else grid
        left = [room.name for room in _rooms_at(start, forbidden)]
        if not left:
            return self._search(shut, start, goal)
        others = grid.add(room.outline for room in forbidden if room.name not in left)
        return self._leave(others, shut, start, goal)

    def _leave(self, within: Grid, shut: Grid, start: Point, goal: Point) -> tuple[Point, ...]:
        """The path out of a forbidden room by the shortest way, and on from there."""
        costs = self._cost(within), self._cost(shut)
        begin = _free(within, costs[0], start, _ESCAPE_M)
        end = _free(shut, costs[1], goal, 3 * shut.cell_m)
        if begin is None or end is None:
            return ()
        out, on = _finder(costs[0], within.cell(begin)), _finder(costs[1], shut.cell(end))
        far = np.where((costs[1] > 0) & (on.distance < _ENDLESS), out.distance, _ENDLESS)
        row, column = np.unravel_index(int(far.argmin()), far.shape)
        if far[row, column] >= _ENDLESS:
            return ()
        door = int(row), int(column)
        first = _middles(within, out.path_to(door))
        second = _middles(shut, on.path_from(door))
        corners = [*_straightened(within, costs[0], first), *_straightened(shut, costs[1], second)]
        return _joined(start, corners, goal)

    def _search(self, grid: Grid, start: Point, goal: Point) -> tuple[Point, ...]:
        """The path, empty if there is none."""
        cost = self._cost(grid)
        ends = [_free(grid, cost, start, _ESCAPE_M), _free(grid, cost, goal, 3 * grid.cell_m)]
        if ends[0] is None or ends[1] is None:
            return ()
        finder = _pathfinder(cost, grid.cell(ends[0]))
        cells = finder.path_to(grid.cell(ends[1]))
        if len(cells) == 1 and grid.cell(ends[0]) != grid.cell(ends[1]):
            return ()
        middle = _middles(grid, cells)
        if grid.cell(start) == grid.cell(ends[0]):
            middle[0] = start
        if grid.cell(goal) == grid.cell(ends[1]):
            middle[-1] = goal
        return _joined(start, _straightened(grid, cost, middle), goal)

    def _cost(self, grid: Grid) -> Costs:
        """Return the cost to pass each cell; 0 for an impassable one."""
        cost = np.ones(grid.clearance_m.shape, dtype=np.int8)
        cost[grid.clearance_m < self._comfort_m] = 3
        cost[grid.clearance_m < self._least_m] = 0
        return cost


def _pathfinder(cost: Costs, root: tuple[int, int]) -> tcod.path.Pathfinder:
    finder = tcod.path.Pathfinder(tcod.path.SimpleGraph(cost=cost, cardinal=5, diagonal=7))
    finder.add_root(root)
    return finder


def _finder(cost: Costs, root: tuple[int, int]) -> tcod.path.Pathfinder:
    """Return a path finder that knows the distance to every cell."""
    finder = _pathfinder(cost, root)
    finder.resolve()
    return finder


def _middles(grid: Grid, cells: NDArray[np.intc]) -> list[Point]:
    return [grid.center(row, column) for row, column in cells.tolist()]


def _rooms_at(point: Point, rooms: Sequence[Room]) -> list[Room]:
    where = np.array([point])
    return [room for room in rooms if inside(room.outline, where)[0]]


def _crossed(path: Sequence[Point], forbidden: Sequence[Room]) -> str:
    """The names of the rooms that a path crosses; of all of them where it only comes near."""
    points = np.vstack([np.linspace(a, b, _SAMPLES) for a, b in pairwise(path)])
    crossed = [room for room in forbidden if inside(room.outline, points).any()]
    return ", ".join(room.spoken for room in crossed or forbidden)


class _Solid:
    """A thing, where it stands."""

    def __init__(self, thing: Thing, pose: Pose2D) -> None:
        self.thing = thing
        self.shapes = [place(part, pose) for part in thing.parts]
        boxes = [bounds(shape) for shape in self.shapes]
        self._least = min(box[0] for box in boxes), min(box[1] for box in boxes)
        self._greatest = max(box[2] for box in boxes), max(box[3] for box in boxes)

    def near(self, point: Point, within_m: float) -> bool:
        """False where it is certainly farther away; what is far need not be measured."""
        (x0, y0), (x1, y1) = self._least, self._greatest
        return x0 - within_m <= point[0] <= x1 + within_m and (
            y0 - within_m <= point[1] <= y1 + within_m
        )

    def gap(self, point: Point) -> float:
        """Metres between it and a point, 0 inside it."""
        where = np.array([point])
        return min(float(distance(shape, where)[0]) for shape in self.shapes)


def _free(grid: Grid, cost: Costs, point: Point, within_m: float) -> Point | None:
    return point if cost[grid.cell(point)] else grid.nearest(point, cost > 0, within_m)


def _straightened(grid: Grid, cost: Costs, points: list[Point]) -> list[Point]:
    """The corners that are needed: what lies between two is passed in a straight line.

    A straight line may not come closer to things than the part of the path that it replaces.
    """
    kept = [points[0]]
    worst = 0
    for before, after in pairwise(points):
        worst = max(worst, int(cost[grid.cell(after)]))
        cells = cost[grid.along(kept[-1], after)]
        if not cells.all() or cells.max() > max(worst, int(cost[grid.cell(kept[-1])])):
            kept.append(before)
            worst = int(cost[grid.cell(after)])
    return [*kept, points[-1]]


def _joined(start: Point, middle: list[Point], goal: Point) -> tuple[Point, ...]:
    path = [start]
    for point in (*middle, goal):
        if point != path[-1]:
            path.append(point)
    return tuple(path)
