"""What the Panda's camera sees is where it says."""

import math
import threading
from collections.abc import Iterator

import numpy as np
import pytest
from panda_table import ask, open_panda

from edgevox.robots.capabilities import (
    CameraSpec,
    HasCamera,
    HasEndEffector,
    HasPicture,
    HasPose,
)
from edgevox.robots.mujoco import NoPicture
from edgevox.robots.panda.robot import PandaRobot
from edgevox.robots.panda.table import CUBES


@pytest.fixture
def panda() -> Iterator[PandaRobot]:
    with open_panda(seed=2) as robot:
        yield robot


def seen_at(spec: CameraSpec, point: tuple[float, float, float]) -> tuple[int, int]:
    """Row and column in which a pinhole camera of this spec sees a point of the map."""
    pose = spec.mount
    forward, left, up = turned(pose.qw, pose.qx, pose.qy, pose.qz).T @ (
        np.array(point) - (pose.x_m, pose.y_m, pose.z_m)
    )
    focal_px = spec.height_px / 2 / math.tan(spec.vertical_fov_rad / 2)
    row = spec.height_px / 2 - focal_px * up / forward
    column = spec.width_px / 2 - focal_px * left / forward
    return round(row - 0.5), round(column - 0.5)


def turned(w: float, x: float, y: float, z: float) -> np.ndarray:
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )


def test_each_cube_is_seen_in_its_colour_where_the_mount_says(panda) -> None:
    image = panda.camera()

    assert image.pixels.shape == (240, 320, 3)
    for name, channel in (("red_cube", 0), ("green_cube", 1), ("blue_cube", 2)):
        place = panda.state()["objects"][name]
        row, column = seen_at(panda.camera_spec, (place["x"], place["y"], place["z"]))
        around = image.pixels[row - 1 : row + 2, column - 1 : column + 2].reshape(-1, 3)
        others = np.delete(around, channel, axis=1)
        assert (around[:, channel].astype(int) > others.max(axis=1) + 40).all(), name


def test_a_cube_that_was_moved_is_seen_elsewhere(panda) -> None:
    place = panda.state()["objects"]["red_cube"]
    row, column = seen_at(panda.camera_spec, (place["x"], place["y"], place["z"]))
    before = panda.camera()

    ask(panda.place, "red_cube", "left_bin")
    ask(panda.go_home)
    after = panda.camera()

    assert after.time_s > before.time_s
    assert abs(after.pixels[row, column].astype(int) - before.pixels[row, column]).max() > 60


def test_the_camera_stands_in_the_room_and_sees_all_cubes(panda) -> None:
    assert panda.camera_spec.parent == "map"
    assert len(CUBES) == 3


def test_the_picture_for_people_is_large_and_shows_something(panda) -> None:
    picture = panda.picture()

    assert picture.shape == (480, 640, 3)
    assert picture.dtype == np.uint8
    assert picture.std() > 20


def test_what_the_body_can_do_is_what_it_offers(panda) -> None:
    for protocol in (HasCamera, HasEndEffector, HasPicture):
        assert isinstance(panda, protocol)
    assert not isinstance(panda, HasPose)


def test_pictures_are_taken_from_several_threads_while_the_arm_moves(panda) -> None:
    pictures: list[np.ndarray] = []
    threads = [
        threading.Thread(target=lambda: pictures.append(panda.camera().pixels)) for _ in range(4)
    ]
    for thread in threads:
        thread.start()
    ask(panda.move_to, 0.5, 0.2, 0.3)
    for thread in threads:
        thread.join()

    assert len(pictures) == 4


def test_without_opengl_the_camera_says_so_and_the_arm_goes_on(panda, monkeypatch) -> None:
    monkeypatch.setenv("MUJOCO_GL", "etching")

    for _ in range(2):
        with pytest.raises(NoPicture, match="'etching'"):
            panda.camera()
    ask(panda.go_home)


def test_a_closed_robot_takes_no_pictures(panda) -> None:
    panda.close()

    with pytest.raises(NoPicture):
        panda.camera()
