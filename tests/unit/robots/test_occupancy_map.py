"""A map of cells is made smaller for people, and no wall is lost or moves."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from edgevox.core.transforms import ORIGIN, Pose2D
from edgevox.robots.capabilities import FREE, OCCUPIED, UNKNOWN, OccupancyMap

TURNED = Pose2D(10.0, -3.0, math.pi / 2)


def cells(rows: int, columns: int, known: dict[tuple[int, int], int]) -> np.ndarray:
    made = np.full((rows, columns), UNKNOWN, np.uint8)
    for at, kind in known.items():
        made[at] = kind
    return made


def test_only_what_is_known_is_kept_and_stays_where_it_was():
    grid = OccupancyMap(cells(10, 20, {(2, 5): FREE, (4, 9): OCCUPIED}), 0.5, TURNED).cropped()
    assert grid.cells.shape == (3, 5)
    assert grid.cells[0, 0] == FREE
    assert grid.cells[2, 4] == OCCUPIED
    # 2.5 m along the grid's x, which points north, and 1 m along its y, which points west.
    assert (grid.origin.x_m, grid.origin.y_m) == pytest.approx((9.0, -0.5))
    assert grid.origin.yaw_rad == TURNED.yaw_rad


def test_of_what_is_nowhere_known_no_cell_is_kept():
    assert OccupancyMap(cells(4, 4, {}), 1.0, ORIGIN).cropped().cells.size == 0


def test_a_wall_wins_over_what_is_free_and_that_over_what_is_unknown():
    known = {(0, 0): FREE, (1, 1): OCCUPIED, (0, 2): FREE}
    grid = OccupancyMap(cells(4, 4, known), 0.1, ORIGIN).reduced(2)
    assert grid.cells.tolist() == [[OCCUPIED, FREE], [UNKNOWN, UNKNOWN]]
    assert grid.resolution_m == pytest.approx(0.2)


def test_the_corners_are_those_of_the_turned_grid():
    grid = OccupancyMap(cells(2, 4, {}), 1.0, TURNED)
    assert np.allclose(grid.corners(), [(10, -3), (10, 1), (8, 1), (8, -3)])


@given(
    st.integers(1, 40),
    st.integers(1, 40),
    st.integers(1, 12),
    st.data(),
)
def test_each_wall_is_in_the_cell_that_covers_its_place(rows, columns, most, data):
    row, column = data.draw(st.integers(0, rows - 1)), data.draw(st.integers(0, columns - 1))
    grid = OccupancyMap(cells(rows, columns, {(row, column): OCCUPIED}), 0.05, ORIGIN)
    small = grid.reduced(most)
    assert max(small.cells.shape) <= most
    (found,) = np.argwhere(small.cells == OCCUPIED)
    middle_m = (np.array([row, column]) + 0.5) * grid.resolution_m
    assert (np.floor(middle_m / small.resolution_m) == found).all()
