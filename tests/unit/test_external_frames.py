"""Transforms chain up to the map, by the names that robots give their frames."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from edgevox.core.transforms import (
    IDENTITY,
    Pose2D,
    Pose3D,
    angle,
    compose,
    distance,
    lift,
    project,
    rigid,
)
from edgevox.ros2.external.frames import Frames

numbers = st.floats(-100, 100)
angles = st.floats(-math.pi, math.pi)


def moved(x_m: float, y_m: float, yaw_rad: float = 0.0) -> Pose3D:
    return lift(Pose2D(x_m, y_m, yaw_rad))


def test_a_chain_is_followed_to_the_map() -> None:
    frames = Frames()
    frames.put("map", "odom", moved(3, -2, math.pi / 2))
    frames.put("odom", "base_link", moved(1, 0))

    pose = project(frames.lookup("map", "base_link"))

    assert (pose.x_m, pose.y_m) == pytest.approx((3, -1))
    assert pose.yaw_rad == pytest.approx(math.pi / 2)


def test_frames_that_hang_beside_each_other_are_joined_by_what_they_hang_from() -> None:
    frames = Frames()
    frames.put("base_footprint", "base_link", moved(0.1, 0))
    frames.put("base_footprint", "laser", moved(0.3, 0.2))

    pose = project(frames.lookup("base_link", "laser"))

    assert (pose.x_m, pose.y_m) == pytest.approx((0.2, 0.2))


@pytest.mark.parametrize(
    ("links", "start", "found"),
    [
        ([("map", "odom")], "odom", "map"),
        ([("/map", "/odom")], "odom", "map"),
        ([("robot1/map", "robot1/odom")], "robot1/odom", "robot1/map"),
        ([("map", "robot1/odom")], "robot1/odom", "map"),
        ([("earth", "map"), ("map", "odom")], "odom", "map"),
        ([("odom", "base_link")], "base_link", None),
        ([("odom", "map")], "odom", None),
        ([], "map", "map"),
    ],
)
def test_the_map_is_found_above_the_odometry(links, start, found) -> None:
    frames = Frames()
    for parent, child in links:
        frames.put(parent, child, moved(1, 1))

    assert frames.map_above(start) == found


def test_frames_that_nothing_joins_have_no_transform() -> None:
    frames = Frames()
    frames.put("map", "odom", moved(1, 1))

    assert frames.lookup("map", "base_link") is None
    assert frames.lookup("elsewhere", "odom") is None


def test_a_loop_of_transforms_ends() -> None:
    frames = Frames()
    frames.put("a", "b", moved(1, 0))
    frames.put("b", "a", moved(1, 0))

    assert frames.map_above("a") is None
    assert frames.lookup("map", "a") is None


@pytest.mark.parametrize(
    ("parent", "child", "transform"),
    [
        ("map", "map", moved(1, 1)),
        ("", "odom", moved(1, 1)),
        ("map", "odom", moved(math.nan, 1)),
        ("map", "odom", moved(math.inf, 1)),
        ("map", "odom", moved(1e300, 1)),
        ("map", "odom", moved(1, -1e9)),
        ("map", "odom", rigid(Pose3D(0, 0, 0, 0, 0, 0, 0))),
        ("map", "odom", rigid(Pose3D(0, 0, 0, 0, 0, 0, 3))),
        ("map", "odom", rigid(Pose3D(0, 0, 0, 0, 0, 1e300, 1e300))),
    ],
)
def test_what_cannot_be_a_transform_is_not_taken(parent, child, transform) -> None:
    frames = Frames()

    assert not frames.put(parent, child, transform)
    assert frames.lookup("map", "odom") is None


def test_the_newest_transform_counts() -> None:
    frames = Frames()
    frames.put("map", "odom", moved(1, 1))
    frames.put("map", "odom", moved(2, 2))

    assert project(frames.lookup("map", "odom")).x_m == pytest.approx(2)


@given(numbers, numbers, angles, numbers, numbers, angles)
def test_there_and_back_is_nowhere(x1, y1, yaw1, x2, y2, yaw2) -> None:
    frames = Frames()
    frames.put("map", "odom", moved(x1, y1, yaw1))
    frames.put("odom", "base_link", moved(x2, y2, yaw2))

    there = frames.lookup("map", "base_link")
    back = frames.lookup("base_link", "map")

    nowhere = compose(there, back)
    assert distance(nowhere, IDENTITY) < 1e-6
    assert angle(nowhere, IDENTITY) < 1e-6
