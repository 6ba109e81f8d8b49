"""Rigid transforms, held to what SciPy makes of the same numbers."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from poses import FLOOR, POSES, same
from scipy.spatial.transform import RigidTransform, Rotation

from edgevox.core.transforms import (
    IDENTITY,
    OFF_UNIT,
    Pose2D,
    Pose3D,
    angle,
    compose,
    compose_on_floor,
    distance,
    distance_on_floor,
    inverse,
    lift,
    pitch,
    project,
    rigid,
    rotate,
    to_map,
    turn_between,
)


def reference(pose: Pose3D) -> RigidTransform:
    rotation = Rotation.from_quat([pose.qx, pose.qy, pose.qz, pose.qw])
    return RigidTransform.from_components([pose.x_m, pose.y_m, pose.z_m], rotation)


def matrices(*transforms: RigidTransform) -> list[np.ndarray]:
    return [transform.as_matrix() for transform in transforms]


@given(POSES, POSES)
def test_put_together_they_are_what_scipy_makes_of_them(parent, child):
    ours, theirs = matrices(reference(compose(parent, child)), reference(parent) * reference(child))
    assert np.allclose(ours, theirs, atol=1e-9)


@given(POSES)
def test_the_way_back_is_scipys(pose):
    ours, theirs = matrices(reference(inverse(pose)), reference(pose).inv())
    assert np.allclose(ours, theirs, atol=1e-9)


@given(POSES, POSES)
def test_how_far_two_are_turned_apart_is_scipys(one, other):
    between = (reference(one).rotation.inv() * reference(other).rotation).magnitude()
    assert angle(one, other) == pytest.approx(between, abs=1e-6)


@given(FLOOR)
def test_a_pose_on_the_floor_is_a_turn_about_z_and_comes_back_the_same(pose):
    about_z = Rotation.from_euler("z", pose.yaw_rad)
    lifted = lift(pose)
    assert np.allclose(reference(lifted).rotation.as_matrix(), about_z.as_matrix(), atol=1e-9)
    back = project(lifted)
    assert (back.x_m, back.y_m) == (pose.x_m, pose.y_m)
    assert math.cos(back.yaw_rad - pose.yaw_rad) == pytest.approx(1.0)


@given(FLOOR, FLOOR)
def test_on_the_floor_they_are_put_together_as_in_space(parent, child):
    seen = compose_on_floor(parent, child)
    assert to_map((child.x_m, child.y_m), parent) == (seen.x_m, seen.y_m)
    assert same(lift(seen), compose(lift(parent), lift(child)))
    assert distance_on_floor(parent, child) == pytest.approx(distance(lift(parent), lift(child)))


@given(FLOOR, FLOOR)
def test_the_turn_between_two_headings_is_the_short_way_round(one, other):
    turned = turn_between(one.yaw_rad, other.yaw_rad)
    assert abs(turned) == pytest.approx(angle(lift(one), lift(other)), abs=1e-6)
    assert math.cos(one.yaw_rad + turned - other.yaw_rad) == pytest.approx(1.0)


@given(FLOOR)
def test_a_vector_is_turned_as_scipy_turns_it(pose):
    turned = Rotation.from_euler("z", pose.yaw_rad).apply([pose.x_m, pose.y_m, 0.0])
    assert rotate(pose.x_m, pose.y_m, pose.yaw_rad) == pytest.approx(tuple(turned[:2]), abs=1e-9)


def test_what_is_pitched_looks_down():
    x, y, z = reference(pitch(math.radians(30.0))).rotation.apply([1.0, 0.0, 0.0])
    assert (x, y, z) == (pytest.approx(math.sqrt(0.75)), pytest.approx(0.0), pytest.approx(-0.5))


@given(POSES)
def test_seen_from_above_it_points_where_its_x_axis_does(pose):
    x, y, _ = reference(pose).rotation.apply([1.0, 0.0, 0.0])
    yaw_rad = project(pose).yaw_rad
    flat = math.hypot(x, y)
    assert (flat * math.cos(yaw_rad), flat * math.sin(yaw_rad)) == pytest.approx((x, y), abs=1e-9)


@given(POSES)
def test_there_and_back_is_nowhere(pose):
    assert same(compose(pose, inverse(pose)), IDENTITY)
    assert same(compose(inverse(pose), pose), IDENTITY)


@given(POSES, POSES, POSES)
def test_it_does_not_matter_which_two_are_put_together_first(one, two, three):
    assert same(compose(compose(one, two), three), compose(one, compose(two, three)))


def test_a_quarter_turn_left_makes_ahead_left():
    seen = compose(lift(Pose2D(1.0, 2.0, math.pi / 2)), Pose3D(3.0))
    assert (seen.x_m, seen.y_m) == (pytest.approx(1.0), pytest.approx(5.0))


def test_the_optical_frame_has_its_z_ahead_and_its_y_down():
    optical = Pose3D(0, 0, 0, -0.5, 0.5, -0.5, 0.5)
    ahead, down = compose(optical, Pose3D(0, 0, 1)), compose(optical, Pose3D(0, 1, 0))
    assert (ahead.x_m, ahead.y_m, ahead.z_m) == (1, 0, 0)
    assert (down.x_m, down.y_m, down.z_m) == (0, 0, -1)


@given(POSES, st.floats(1 - 0.9 * OFF_UNIT, 1 + 0.9 * OFF_UNIT))
def test_a_quaternion_that_is_off_by_rounding_is_the_one_that_was_meant(pose, factor):
    q = (factor * part for part in (pose.qx, pose.qy, pose.qz, pose.qw))
    assert same(rigid(Pose3D(pose.x_m, pose.y_m, pose.z_m, *q)), pose)


@pytest.mark.parametrize(
    "q", [(0, 0, 0, 0), (0, 0, 0, 3), (0, 0, 1e300, 1e300), (math.nan, 0, 0, 1)]
)
def test_what_is_no_quaternion_is_no_place_either(q):
    assert not Pose2D.finite.fget(project(rigid(Pose3D(1.0, 2.0, 3.0, *q))))
