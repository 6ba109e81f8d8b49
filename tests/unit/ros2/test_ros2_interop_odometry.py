"""Odometry, the names of frames, and the camera's model."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st
from poses import ON_FLOOR, same

from edgevox.core.errors import InvalidValue
from edgevox.core.transforms import (
    IDENTITY,
    Pose3D,
    angle,
    compose,
    distance,
)
from edgevox.robots.capabilities import CameraSpec
from edgevox.ros2.interop.frames import Frames, Odometer
from edgevox.ros2.interop.outputs import camera_info


@given(st.lists(ON_FLOOR, min_size=1, max_size=30))
def test_the_chain_is_always_the_pose_and_odom_starts_at_the_robot(way):
    odometer = Odometer(1.0, 2.0)
    for number, pose in enumerate(way):
        in_odom = odometer.move(number / 30, pose)
        if number == 0:
            assert same(in_odom, IDENTITY)
        assert same(compose(odometer.map_to_odom, in_odom), pose)


@given(ON_FLOOR, ON_FLOOR)
def test_odom_does_not_jump_when_the_robot_is_put_elsewhere(start, elsewhere):
    odometer = Odometer(1.0, 2.0)
    before = odometer.move(0.0, start)
    after = odometer.move(1 / 30, elsewhere)
    assert distance(before, after) < 0.2
    assert angle(before, after) < 0.4


def test_map_to_odom_stands_still_while_the_robot_drives():
    odometer = Odometer(1.0, 2.0)
    odometer.move(0.0, IDENTITY)
    for number in range(1, 100):
        odometer.move(number / 30, Pose3D(number / 30))
    assert odometer.map_to_odom == IDENTITY


@pytest.mark.parametrize(
    ("odom", "prefix"),
    [("map", ""), ("base_link", ""), ("/odom", ""), ("my odom", ""), ("", "/robot1"), ("", "a b/")],
)
def test_a_frame_that_cannot_be_is_refused(odom, prefix):
    with pytest.raises(InvalidValue, match="odom_frame|frame_prefix"):
        Frames(odom, prefix)


def test_the_camera_sees_its_field_of_view():
    info = camera_info(CameraSpec(640, 480, math.radians(90)))
    assert info.k[4] == pytest.approx(240)
    assert (info.k[2], info.k[5]) == (319.5, 239.5)
    assert list(info.p[:3]) == list(info.k[:3])
