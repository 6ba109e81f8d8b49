"""What the console is shown of a map that others make, such as the `map` of `robot-external`."""

import base64
import io
import json
import math

import numpy as np
import pytest
from PIL import Image

from edgevox.agent.policy import Guard
from edgevox.apps.console.shown_robot import ShownRobot
from edgevox.core.motion.interlock import Interlock
from edgevox.core.transforms import ORIGIN, Pose2D
from edgevox.robots.capabilities import FREE, OCCUPIED, UNKNOWN, OccupancyMap

CELLS = np.array([[OCCUPIED, FREE, UNKNOWN], [FREE, FREE, FREE]], np.uint8)


class Mapped:
    """A body that hears a map."""

    name, skills = "mapped", ()

    def __init__(self) -> None:
        self.map: OccupancyMap | None = None
        self.places = {}

    def newest_map(self):
        return self.map

    def place_at(self, x_m, y_m):
        return None

    def state(self):
        return {"time": 0.0}


@pytest.fixture
def body():
    return Mapped()


@pytest.fixture
def shown(body):
    return ShownRobot(body, Interlock(), Guard(), str)


def greys(grid):
    picture = Image.open(io.BytesIO(base64.b64decode(grid["png"])))
    return np.array(picture.convert("L")).tolist()


def test_it_is_offered_as_a_map_before_there_is_one(shown):
    assert shown.capabilities["map"]
    assert "grid" not in shown.scene()


def test_a_cell_is_a_pixel_and_the_upper_row_is_the_far_one(body, shown):
    body.map = OccupancyMap(CELLS, 0.5, Pose2D(3.0, -1.0, 0.25))
    grid = shown.scene()["grid"]
    assert greys(grid) == [[128, 128, 128], [255, 128, 0]]
    where = {name: grid[name] for name in ("x", "y", "yaw", "resolution")}
    assert where == {"x": 3.0, "y": -1.0, "yaw": 0.25, "resolution": 0.5}


def test_the_whole_of_it_and_every_place_are_within_the_bounds(body, shown):
    body.map = OccupancyMap(CELLS, 1.0, Pose2D(0.0, 0.0, math.pi / 2))
    assert shown.scene()["bounds"] == [-2.0, 0.0, 0.0, 3.0]
    body.places["dock"] = (4.0, -5.0)
    assert shown.scene()["bounds"] == [-2.0, -5.0, 4.0, 3.0]


def test_another_map_is_another_scene_and_the_same_one_is_the_same(body, shown):
    body.map = OccupancyMap(CELLS, 0.5, ORIGIN)
    first = shown.scene()
    assert shown.scene() == first
    body.map = OccupancyMap(CELLS[::-1].copy(), 0.5, ORIGIN)
    second = shown.scene()
    assert second["version"] != first["version"]
    assert greys(second["grid"]) == greys(first["grid"])[::-1]
    body.map = OccupancyMap(body.map.cells, 0.5, Pose2D(0.1, 0.0, 0.0))
    assert shown.scene()["version"] != second["version"]


def test_a_map_on_which_nothing_is_known_is_not_drawn(body, shown):
    body.map = OccupancyMap(CELLS[:0, :0], 0.5, ORIGIN)
    assert "grid" not in shown.scene()


def test_the_worst_that_a_map_can_cost_is_known(body, shown):
    noise = np.random.default_rng(1).integers(0, 3, (512, 512), np.uint8)
    body.map = OccupancyMap(noise, 0.05, ORIGIN)
    assert len(json.dumps(shown.scene(), allow_nan=False)) < 90_000
