"""The lidar agrees with plane geometry."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from edgevox.core.transforms import Pose2D
from edgevox.robots.flat.apartment import Lidar, cast
from edgevox.robots.world.load import parse_world

NO_DISCS = np.empty((0, 3))
NO_SEGMENTS = np.empty((0, 4))
near = st.floats(-5, 5).filter(lambda v: abs(v) > 1e-3)
angle = st.floats(-math.pi, math.pi)

SQUARE = """
world: {width: 4, height: 2, offset: [-1, -1]}
robot:
  kinematics: {name: diff}
  shape: {name: circle, radius: 0.2}
  state: [0, 0, 0]
  sensors: [{name: lidar2d, number: 360, angle_range: 6.283185307, range_max: 2.5}]
"""


def one_ray(origin: tuple[float, float], heading: float, *segments: tuple[float, ...]) -> float:
    return float(cast(origin, np.array([heading]), np.array(segments), NO_DISCS)[0])


@given(angle, st.floats(0.1, 5))
def test_a_wall_at_a_distance_is_seen_at_that_distance_over_the_cosine(
    off: float, distance: float
) -> None:
    far = one_ray((0, 0), off, (distance, -1000, distance, 1000))

    if abs(off) < math.pi / 2 - 0.01:
        assert far == pytest.approx(distance / math.cos(off), rel=1e-6)
    elif abs(off) > math.pi / 2 + 0.01:
        assert math.isinf(far)


@given(near, near, near, near, st.floats(0.01, 0.99), near, near)
def test_a_ray_aimed_at_a_point_of_a_segment_ends_there(
    x1: float, y1: float, x2: float, y2: float, part: float, ox: float, oy: float
) -> None:
    target = (x1 + part * (x2 - x1), y1 + part * (y2 - y1))
    gap = math.dist((ox, oy), target)
    across = (x2 - x1) * (target[1] - oy) - (y2 - y1) * (target[0] - ox)
    if gap < 1e-2 or abs(across) < 1e-3:
        return

    far = one_ray((ox, oy), math.atan2(target[1] - oy, target[0] - ox), (x1, y1, x2, y2))

    assert far == pytest.approx(gap, rel=1e-5, abs=1e-6)


@given(angle, st.floats(0.5, 5), st.floats(0.05, 0.4), st.floats(-0.95, 0.95))
def test_a_disc_is_seen_where_its_rim_is(
    bearing: float, distance: float, radius: float, offset: float
) -> None:
    center = (distance * math.cos(bearing), distance * math.sin(bearing))
    beam = bearing + math.asin(offset * radius / distance)

    far = cast((0, 0), np.array([beam]), NO_SEGMENTS, np.array([[*center, radius]]))[0]

    hit = (far * math.cos(beam), far * math.sin(beam))
    assert math.dist(hit, center) == pytest.approx(radius, rel=1e-6)
    assert far < distance


@given(angle)
def test_a_ray_hits_the_nearest_of_several_things(heading: float) -> None:
    box = [(r, -r, r, r) for r in (1, 2)] + [(-r, r, r, r) for r in (1, 2)]
    box += [(-r, -r, -r, r) for r in (1, 2)] + [(-r, -r, r, -r) for r in (1, 2)]

    far = one_ray((0, 0), heading, *box)

    inner = 1 / max(abs(math.cos(heading)), abs(math.sin(heading)))
    assert far == pytest.approx(inner, rel=1e-6)


def test_nothing_in_the_way_is_infinitely_far() -> None:
    assert math.isinf(one_ray((0, 0), 0.0, (-1, -1, -1, 1)))


def test_a_sweep_starts_behind_the_robot_and_goes_round_counter_clockwise() -> None:
    lidar = Lidar(parse_world(SQUARE, "square.yaml"))

    scan = lidar.scan(1.5, Pose2D(0.0, 0.0, 0.0), ())

    assert scan.ranges_m.shape == (360,)
    assert scan.ranges_m.dtype == np.float32
    assert scan.angle_min_rad == pytest.approx(-math.pi)
    assert scan.angle_increment_rad == pytest.approx(math.radians(1))
    back, right, front, left = (float(scan.ranges_m[i]) for i in (0, 90, 180, 270))
    assert (back, right, left) == pytest.approx((1.0, 1.0, 1.0), abs=1e-5)
    assert math.isinf(front), "the wall in front is 3 m away, the lidar sees 2.5 m"


def test_a_sweep_turns_with_the_robot() -> None:
    lidar = Lidar(parse_world(SQUARE, "square.yaml"))

    scan = lidar.scan(0.0, Pose2D(2.0, 0.0, math.pi), ())

    assert float(scan.ranges_m[0]) == pytest.approx(1.0, abs=1e-5)


def test_a_part_of_a_circle_includes_both_its_ends() -> None:
    text = SQUARE.replace("number: 360, angle_range: 6.283185307", "number: 3, angle_range: 3.1416")

    scan = Lidar(parse_world(text, "square.yaml")).scan(0.0, Pose2D(0.0, 0.0, 0.0), ())

    assert scan.ranges_m[[0, 2]] == pytest.approx([1.0, 1.0], abs=1e-4)


def test_pushed_things_are_seen_where_they_are_now() -> None:
    text = SQUARE + "obstacle: [{shape: {name: circle, radius: 0.3}, state: [2, 0, 0], mass: 1}]"
    lidar = Lidar(parse_world(text, "square.yaml"))

    scan = lidar.scan(0.0, Pose2D(0.0, 0.0, 0.0), (Pose2D(1.0, 0.0, 0.5),))

    assert float(scan.ranges_m[180]) == pytest.approx(0.7, abs=1e-5)
