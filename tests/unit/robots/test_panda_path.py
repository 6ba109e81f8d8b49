"""Motions that are written down before they start."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from edgevox.robots.panda.motion import PEAK, Pace, steps, written

PERIOD_S = 0.02
PACE = Pace(hand_m_s=0.5, joint_rad_s=1.5)

angles = st.lists(st.floats(-2.0, 2.0), min_size=7, max_size=7).map(np.array)


def points_for(knots: np.ndarray) -> np.ndarray:
    """A hand that moves 10 cm between knots."""
    return np.column_stack([np.arange(len(knots)) * 0.1, *np.zeros((2, len(knots)))])


@given(st.lists(angles, min_size=2, max_size=6))
def test_it_ends_at_the_last_knot_and_starts_near_the_first(found) -> None:
    knots = np.array(found)
    rows = written(knots, points_for(knots), PACE, PERIOD_S, 0.0)

    assert np.isfinite(rows).all()
    assert rows[-1] == pytest.approx(knots[-1])
    assert np.abs(rows[0] - knots[0]).max() < 0.1


@given(angles, angles)
def test_no_joint_turns_faster_than_its_pace(start, end) -> None:
    knots = np.array([start, end])
    rows = written(knots, points_for(knots), PACE, PERIOD_S, 0.0)
    speeds = np.abs(np.diff(np.vstack([start, rows]), axis=0)) / PERIOD_S

    assert speeds.max() <= PACE.joint_rad_s * 1.001


def test_the_hand_goes_no_faster_than_its_pace() -> None:
    knots = np.zeros((2, 7))
    knots[1] = 0.01
    points = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0]])

    rows = written(knots, points, PACE, PERIOD_S, 0.0)

    assert len(rows) * PERIOD_S == pytest.approx(PEAK * 1.0 / PACE.hand_m_s, abs=PERIOD_S)


def test_it_starts_and_ends_gently() -> None:
    knots = np.array([np.zeros(7), np.full(7, 1.0)])
    rows = written(knots, points_for(knots), PACE, PERIOD_S, 0.0)[:, 0]

    assert rows[0] < 0.001
    assert rows[-1] - rows[-2] < 0.001
    assert (np.diff(rows) >= 0).all()


def test_commands_run_ahead_of_a_motor_that_is_late() -> None:
    knots = np.array([np.zeros(7), np.full(7, 1.0)])
    rows = written(knots, points_for(knots), PACE, PERIOD_S, 0.0)
    led = written(knots, points_for(knots), PACE, PERIOD_S, 0.05)
    middle = len(rows) // 2

    speed = (rows[middle + 1, 0] - rows[middle - 1, 0]) / (2 * PERIOD_S)
    assert led[middle, 0] - rows[middle, 0] == pytest.approx(0.05 * speed)
    assert led[-1] == pytest.approx(knots[-1])


def test_going_nowhere_takes_no_time() -> None:
    knots = np.zeros((2, 7))

    assert len(written(knots, np.zeros((2, 3)), PACE, PERIOD_S, 0.05)) == 1


@pytest.mark.parametrize(
    ("distances", "longest", "count"),
    [((0.0,), (0.1,), 1), ((0.25,), (0.1,), 3), ((0.1, 1.5), (0.1, 0.5), 3)],
)
def test_a_way_is_cut_so_that_no_part_is_too_long(distances, longest, count) -> None:
    assert steps(distances, longest) == count
