"""What the humanoid sees, and how it looks."""

import math

import numpy as np
import pytest
from humanoid_rig import h1, turn, walk

from edgevox.core.transforms import Pose3D
from edgevox.robots.humanoid import HumanoidRobot


@pytest.fixture(scope="module")
def robot():
    with HumanoidRobot(h1(), speed=None) as one:
        yield one


def test_the_head_camera_takes_pictures_of_the_size_it_promises(robot) -> None:
    image, spec = robot.camera(), robot.camera_spec

    assert image.pixels.shape == (spec.height_px, spec.width_px, 3)
    assert image.pixels.dtype == np.uint8
    assert image.time_s == robot.time_s
    assert spec.parent == "body"
    assert np.ptp(image.pixels) > 50


def test_the_horizon_is_where_a_level_camera_at_that_mount_has_it(robot) -> None:
    spec = robot.camera_spec
    mount: Pose3D = spec.mount
    down = 2 * math.atan2(mount.qy, mount.qw)
    focal = spec.height_px / 2 / math.tan(spec.vertical_fov_rad / 2)
    expected = spec.height_px / 2 - focal * math.tan(down)

    pixels = robot.camera().pixels.astype(float)
    darkest = pixels.mean(axis=2).min(axis=1)
    horizon = int(np.argmax(darkest < 190))  # the sky and the haze are brighter than the floor

    assert horizon == pytest.approx(expected, abs=10)


def test_it_sees_the_floor_move_when_it_walks_and_turns(robot) -> None:
    robot.reset()
    before = robot.camera().pixels.astype(int)
    walk(robot, 0.4)
    after_walk = robot.camera().pixels.astype(int)
    turn(robot, 30)
    after_turn = robot.camera().pixels.astype(int)

    assert np.abs(after_walk - before).mean() > 1.0
    assert np.abs(after_turn - after_walk).mean() > 1.0


def test_the_picture_follows_the_robot(robot) -> None:
    robot.reset()
    near = robot.picture()
    walk(robot, 4.0)
    far = robot.picture()

    assert near.shape == far.shape == (480, 640, 3)
    for picture in (near, far):
        middle = picture[150:400, 260:380].astype(int).sum(axis=2)
        assert (middle < 180).mean() > 0.15  # the black robot stands there
