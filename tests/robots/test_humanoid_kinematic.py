"""Robots without a policy are moved outright: exactly, on feet that do not slip; they say so."""

import math
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from humanoid_rig import along, apart, g1, h1, stand, turn, turned_deg, walk, walking

from edgevox.core.errors import InvalidValue
from edgevox.models import locate
from edgevox.robots.capabilities import CountsHalts, Twist2D
from edgevox.robots.command_mux import WATCHDOG_S
from edgevox.robots.humanoid import HumanoidRobot, MujocoHumanoidEnvironment
from edgevox.robots.humanoid.walking_policy import WalkingCommand

BISCUIT = """
<mujoco>
  <worldbody>
    <body pos="0 0 0.5">
      <freejoint/>
      <geom type="box" size="0.1 0.15 0.2"/>
      <body pos="0 0.2 0.1">
        <joint name="left_shoulder" axis="0 1 0"/>
        <geom type="capsule" size="0.03" fromto="0 0 0 0 0 -0.3"/>
      </body>
      <body pos="0 0.1 -0.2">
        <joint name="left_hip" axis="0 1 0" range="-60 60"/>
        <geom type="capsule" size="0.03" fromto="0 0 0 0 0 -0.25"/>
      </body>
    </body>
  </worldbody>
</mujoco>
"""
BALL = """
<mujoco><worldbody><body><freejoint/><geom size="0.2"/></body></worldbody></mujoco>
"""
TABLE = """
<mujoco><worldbody><body><joint name="left_knee"/><geom size="0.2"/></body></worldbody></mujoco>
"""


@pytest.fixture(scope="module")
def unitree() -> Iterator[HumanoidRobot]:
    with HumanoidRobot(h1(), speed=None) as robot:
        yield robot


@pytest.fixture
def robot(unitree) -> HumanoidRobot:
    unitree.reset()
    return unitree


@pytest.fixture
def held_h1(held) -> HumanoidRobot:
    """Its time stands still until it is told."""
    return held(HumanoidRobot, h1())


def custom(folder: Path, text: str) -> Path:
    path = folder / "mine.xml"
    path.write_text(text)
    return path


@pytest.mark.parametrize("distance_m", [0.5, 3.0, -0.7, 0.05])
def test_distances_are_exact(robot, distance_m) -> None:
    before = robot.pose()

    walk(robot, distance_m)

    assert along(before, robot.pose()) == pytest.approx(distance_m, abs=1e-4)
    assert apart(before, robot.pose()) == pytest.approx(abs(distance_m), abs=1e-4)


@pytest.mark.parametrize("degrees", [90, -45, 360])
def test_angles_are_exact(robot, degrees) -> None:
    before = robot.pose()

    turn(robot, degrees)

    off = math.remainder(turned_deg(before, robot.pose()) - degrees, 360)
    assert off == pytest.approx(0, abs=0.01)
    assert apart(before, robot.pose()) < 1e-6


@pytest.mark.parametrize(
    "velocity",
    [
        WalkingCommand(0.6, 0.0, 0.0),
        WalkingCommand(-0.6, 0.0, 0.0),
        WalkingCommand(0.0, 0.0, 0.9),
        WalkingCommand(0.6, 0.0, 0.9),
        WalkingCommand(0.4, 0.0, -0.5),
    ],
)
@pytest.mark.parametrize("make", [h1, lambda: MujocoHumanoidEnvironment(locate("unitree-g1"))])
def test_a_foot_that_stands_does_not_slip_and_one_that_swings_is_lifted(make, velocity) -> None:
    environment = make()
    feet = environment.walker.feet
    highest = [place[2] for _, place in feet()]
    floor, slips, stood = list(highest), [0.0], [None, None]
    for tick in range(300):
        environment.step(velocity if tick < 200 else WalkingCommand())
        for number, (foot, place) in enumerate(feet()):
            highest[number] = max(highest[number], place[2])
            if foot.swing is not None:
                stood[number] = None
                continue
            if stood[number] is None:
                stood[number] = place
            slips.append(float(np.linalg.norm(place - stood[number])))

    assert max(slips) < 1e-3
    assert min(np.subtract(highest, floor)) > 0.04
    assert not environment.walker.stepping


def test_hips_knees_ankles_shoulders_and_elbows_swing_while_it_walks() -> None:
    environment = h1()
    angles = []
    for _ in range(150):
        environment.step(WalkingCommand(0.5))
        angles.append(environment.data.qpos.copy())
    swing = np.ptp(angles[50:], axis=0)

    for side in ("left", "right"):
        for part in ("hip_pitch", "knee", "ankle", "shoulder_pitch", "elbow"):
            joint = environment.model.joint(f"{side}_{part}")
            assert swing[joint.qposadr[0]] > 0.1, (side, part)
            low, high = joint.range
            assert all(low <= row[joint.qposadr[0]] <= high for row in angles)


def test_it_says_that_no_forces_move_it(robot) -> None:
    state = robot.state()

    assert state["simulation"] == "kinematic"
    assert state["gait"] == "procedural gait"
    assert state["fallen"] is False
    assert stand(robot) is False


def test_a_halt_stops_the_base_at_once_and_the_feet_come_together(held_h1) -> None:
    going = walking(held_h1, 3.0)
    held_h1.advance(2.0)
    assert held_h1.velocity().linear_m_s > 0.5

    held_h1.halt("the stop word")
    held_h1.advance(0.1)
    before = held_h1.pose()

    assert held_h1.velocity().linear_m_s == 0.0
    assert str(going.ended()) == "the stop word"
    held_h1.advance(2.0)
    assert held_h1.pose() == before
    assert held_h1.state()["activity"] == "standing"


def test_a_stream_that_stops_halts_it_after_half_a_second(held_h1) -> None:
    held_h1.set_velocity(Twist2D(0.5, 0.0))
    held_h1.advance(0.6)
    assert 0.05 < held_h1.pose().x_m < 0.3
    before = held_h1.pose()

    held_h1.advance(1.0)

    assert held_h1.pose() == before


def test_streams_that_stop_are_counted_and_a_reset_forgets_none(held_h1) -> None:
    assert isinstance(held_h1, CountsHalts)
    for twist in (Twist2D(0.5, 0.0), Twist2D(0.0, 0.0)):
        held_h1.set_velocity(twist)
        held_h1.advance(2 * WATCHDOG_S)
    assert held_h1.watchdog_halts == 1, "the other asked for a stand"

    held_h1.set_velocity(Twist2D(0.5, 0.0))
    held_h1.halt("enough")
    held_h1.advance(2 * WATCHDOG_S)
    assert held_h1.watchdog_halts == 1, "somebody else halted it"

    held_h1.reset()
    held_h1.set_velocity(Twist2D(0.5, 0.0))
    held_h1.advance(2 * WATCHDOG_S)
    assert held_h1.watchdog_halts == 2


def test_a_robot_of_ones_own_that_lacks_most_joints_walks_all_the_same(tmp_path) -> None:
    environment = MujocoHumanoidEnvironment(custom(tmp_path, BISCUIT))
    shoulder = environment.model.joint("left_shoulder").qposadr[0]
    with HumanoidRobot(environment, speed=None) as robot:
        walk(robot, 1.0)
        turn(robot, 90)
        assert robot.pose().x_m == pytest.approx(1.0, abs=1e-4)
        assert robot.state()["simulation"] == "kinematic"
    angles = []
    for _ in range(100):
        environment.step(WalkingCommand(0.5))
        angles.append(float(environment.data.qpos[shoulder]))
    assert np.ptp(angles) > 0.3


def test_a_ball_is_no_humanoid_but_it_moves(tmp_path) -> None:
    with HumanoidRobot(MujocoHumanoidEnvironment(custom(tmp_path, BALL)), speed=None) as robot:
        walk(robot, 0.5)
        assert robot.pose().x_m == pytest.approx(0.5, abs=1e-4)


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        (TABLE, "free joint"),
        ("<mujoco><worldbody/></mujoco>", "free joint"),
        ("<robot name='urdf-that-is-none'", "MJCF"),
        ("hello", "MJCF"),
        (BALL.replace("<freejoint/>", "<freejoint/><joint type='no such joint'/>"), "MJCF"),
    ],
)
def test_a_file_that_is_no_robot_is_refused_with_what_was_expected(
    tmp_path, text, expected
) -> None:
    with pytest.raises(InvalidValue, match=expected) as refused:
        MujocoHumanoidEnvironment(custom(tmp_path, text))

    assert refused.value.field == "mjcf"


def test_a_file_that_is_not_there_is_refused() -> None:
    with pytest.raises(InvalidValue, match="mjcf: got '/no/such/file.xml', expected a file that"):
        MujocoHumanoidEnvironment(Path("/no/such/file.xml"))


def test_a_policy_for_another_robot_is_refused_with_the_joint_it_wants() -> None:
    policy = g1().policy

    with pytest.raises(InvalidValue, match="policy: got 'left_hip_pitch_joint', expected a hinge"):
        MujocoHumanoidEnvironment(locate("unitree-h1"), policy)
