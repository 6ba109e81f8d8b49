"""Where cubes are, and where there is room for one."""

import itertools
import math

import pytest

from edgevox.robots.panda import table
from edgevox.robots.panda.table import BINS, CUBES, Placed, places

RED, GREEN, BLUE = "red_cube", "green_cube", "blue_cube"
APART = {
    RED: Placed(0.5, 0.0, 0.025),
    GREEN: Placed(0.5, 0.2, 0.025),
    BLUE: Placed(0.5, -0.2, 0.025),
}


@pytest.mark.parametrize(
    ("place", "held", "expected"),
    [
        (Placed(0.5, 0.0, 0.025), None, "table"),
        (Placed(0.5, 0.0, 0.025), RED, "hand"),
        (Placed(0.40, 0.45, 0.03), None, "left_bin"),
        (Placed(0.40, -0.45, 0.03), None, "right_bin"),
        (Placed(0.505, 0.205, 0.075), None, "green_cube"),
        (Placed(1.2, 0.0, -0.69), None, "floor"),
    ],
)
def test_a_cube_is_where_a_person_would_say(place, held, expected) -> None:
    assert table.where(RED, {**APART, RED: place}, held) == expected


def test_a_cube_on_another_in_a_bin_is_on_that_cube() -> None:
    stacked = {**APART, RED: Placed(0.4, 0.42, 0.03), GREEN: Placed(0.4, 0.42, 0.08)}

    assert table.where(GREEN, stacked, None) == RED
    assert table.on_top(RED, stacked) == GREEN
    assert table.on_top(GREEN, stacked) is None


def test_three_cubes_have_room_in_one_bin() -> None:
    found = dict(APART)
    for name in CUBES:
        spot = table.free_spot(name, BINS["left_bin"], found)
        assert spot is not None
        assert BINS["left_bin"].contains(*spot)
        found[name] = Placed(*spot, 0.03)

    for one, other in itertools.combinations(found.values(), 2):
        assert one.away_m(other) > 0.08


def test_a_cube_goes_back_to_where_it_was_unless_that_is_taken() -> None:
    start = (0.52, 0.0)
    assert table.free_table(GREEN, {**APART, RED: Placed(0.3, 0.0, 0.025)}, start) == start

    elsewhere = table.free_table(GREEN, {**APART, RED: Placed(0.53, 0.01, 0.025)}, start)
    assert elsewhere is not None
    assert math.dist(elsewhere, (0.53, 0.01)) > 0.08


def test_seeds_repeat_and_leave_room_for_the_fingers() -> None:
    assert places(0) == places(0)
    for seed in range(1, 60):
        found = places(seed)
        assert found == places(seed)
        for one, other in itertools.combinations(found.values(), 2):
            assert math.dist((one.x_m, one.y_m), (other.x_m, other.y_m)) > 0.12
        assert not any(box.contains(p.x_m, p.y_m) for p in found.values() for box in BINS.values())
    assert places(1) != places(2)
