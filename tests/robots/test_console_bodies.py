"""What the console is shown of the arm and of the humanoid, which have no map."""

import io
import json

import pytest
from humanoid_rig import h1
from panda_table import open_panda
from PIL import Image

from edgevox.agent.policy import Guard
from edgevox.apps.console.shown_robot import ShownRobot
from edgevox.core.motion.interlock import Interlock
from edgevox.robots.humanoid import HumanoidRobot


@pytest.fixture
def arm():
    with open_panda(speed=0.0) as robot:
        yield ShownRobot(robot, Interlock(), Guard(), str)


@pytest.fixture
def humanoid():
    with HumanoidRobot(h1(), speed=0.0) as robot:
        yield robot


def test_the_arm_shows_its_joints_within_their_limits_its_hand_and_the_things_before_it(arm):
    live = arm.live()
    json.dumps(live, allow_nan=False)
    assert len(live["joints"]) == 7
    assert all(one["lower"] < one["value"] < one["upper"] for one in live["joints"])
    assert live["hand"]["holding"] is None
    assert 0.0 < live["hand"]["open"] <= 1.0
    assert {"red_cube", "green_cube", "blue_cube"} <= {one["name"] for one in live["things"]}
    assert not any(one["held"] for one in live["things"])


def test_the_arm_is_seen_by_its_camera_and_offers_neither_map_nor_stick(arm):
    assert Image.open(io.BytesIO(arm.picture())).size == (320, 240)
    here = arm.capabilities
    assert (here["picture"], here["map"], here["goto"], here["drive"]) == (
        True,
        False,
        False,
        False,
    )


def test_the_humanoid_shows_where_it_stands_and_is_steered(humanoid):
    shown = ShownRobot(humanoid, Interlock(), Guard(), str)
    live = shown.live()
    json.dumps(live, allow_nan=False)
    assert live["pose"]["x"] == pytest.approx(humanoid.pose().x_m, abs=0.001)
    x0, y0, x1, y1 = shown.scene()["bounds"]
    assert x0 < live["pose"]["x"] < x1
    assert y0 < live["pose"]["y"] < y1
    shown.drive(0.2, 0.0)
    humanoid.advance(0.4)
    assert shown.live()["velocity"]["linear"] > 0.0
    shown.halt()
    assert shown.capabilities["drive"]["linear"] == humanoid.max_linear_m_s
