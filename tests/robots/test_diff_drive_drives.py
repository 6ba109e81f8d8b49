"""The robot reaches what can be reached, touches nothing, and says why it cannot."""

import itertools
import math
from dataclasses import astuple

import phrases
import pytest
from held_time import STEP_S, HeldSkill, carry_out

from edgevox.agent.skills import SkillFailed
from edgevox.core.cancel import Cancelled, CancelToken
from edgevox.core.errors import InvalidValue
from edgevox.core.transforms import Pose2D
from edgevox.robots.capabilities import (
    Body,
    DrivesTo,
    HasBattery,
    HasLidar,
    HasMap,
    HasPicture,
    HasPlaces,
    HasPose,
    TakesVelocity,
    Twist2D,
)
from edgevox.robots.flat.apartment import ApartmentRobot
from edgevox.robots.flat.diff_drive import DiffDriveRobot
from edgevox.robots.flat.engine import MotionState
from edgevox.robots.flat.irsim import IrsimRobot

ROOMS = ("kitchen", "bedroom", "living_room", "office")


def drive(robot: DiffDriveRobot, x_m: float, y_m: float) -> list[dict[str, float]]:
    reports: list[dict[str, float]] = []
    robot.drive_to(x_m, y_m, token=CancelToken(), report=lambda **f: reports.append(f))
    return reports


def test_it_is_a_body_with_everything_it_claims(robot: DiffDriveRobot) -> None:
    body: Body = robot
    kinds = (DrivesTo, HasBattery, HasLidar, HasMap, HasPicture, HasPlaces, HasPose, TakesVelocity)

    assert all(isinstance(body, kind) for kind in kinds)


@pytest.mark.parametrize(
    "make",
    [ApartmentRobot, pytest.param(IrsimRobot, marks=pytest.mark.long)],
    indirect=True,
    ids=["apartment", "irsim"],
)
def test_every_room_is_reached_from_every_other_without_a_touch(robot) -> None:
    tour = ["kitchen", "bedroom", "kitchen", "living_room", "kitchen", "office", "bedroom"]
    tour += ["living_room", "bedroom", "office", "living_room", "office", "kitchen"]
    assert set(itertools.pairwise(tour)) == set(itertools.permutations(ROOMS, 2))

    for room in tour:
        reports = drive(robot, *robot.places[room])

        pose, twist, state = robot.pose(), robot.velocity(), robot.state()
        assert math.dist((pose.x_m, pose.y_m), robot.places[room]) < 0.15
        assert abs(twist.linear_m_s) < 0.03
        assert state["room"] == room
        assert state["collisions"] == 0, f"on the way to the {room}"
        assert state["goal"] is None
        assert reports[-1]["progress"] == 1.0


def test_it_drives_no_faster_and_speeds_up_no_harder_than_its_limits(in_hall) -> None:
    robot = in_hall("", speed=0.0)
    going = HeldSkill(robot, robot.drive_to, 7.0, 2.0)
    speeds = [robot.velocity().linear_m_s]
    while robot.state()["goal"]:
        robot.advance(STEP_S)
        speeds.append(robot.velocity().linear_m_s)

    assert going.ended() is None
    assert max(speeds) == pytest.approx(0.8, abs=0.02)
    assert robot.time_s > 6 / 0.8, "6 m take longer than at full speed all the way"


def test_it_turns_around_on_the_spot_before_it_leaves(in_hall) -> None:
    robot = in_hall()

    drive(robot, 0.5, 2.0)

    assert max(y for _, y in robot.trail()) - min(y for _, y in robot.trail()) < 0.1


@pytest.mark.parametrize(
    ("x_m", "y_m", "reason"),
    [
        (11, 5, phrases.because("outside", place="apartment")),
        (5.8, 1, phrases.because("taken", thing="a wall")),
        (0.7, 2.6, phrases.because("taken", thing="a sofa")),
    ],
)
def test_a_goal_that_cannot_be_is_refused_and_nothing_moves(robot, x_m, y_m, reason) -> None:
    before = robot.pose()

    with pytest.raises(SkillFailed, check=reason):
        drive(robot, x_m, y_m)

    robot.advance(0.5)
    assert astuple(robot.pose()) == pytest.approx(astuple(before))


@pytest.mark.parametrize("x_m", [math.nan, math.inf])
def test_a_goal_that_is_no_number_is_invalid(robot, x_m) -> None:
    with pytest.raises(InvalidValue, match="x: got"):
        drive(robot, x_m, 1.0)


def test_a_refused_goal_leaves_the_running_one_alone(held_robot) -> None:
    going = HeldSkill(held_robot, held_robot.drive_to, *held_robot.places["bedroom"])

    with pytest.raises(SkillFailed):
        drive(held_robot, 50, 50)

    assert held_robot.state()["goal"] is not None
    going.token.cancel()
    assert isinstance(going.ended(), Cancelled)


def test_progress_is_reported_while_it_drives(held_robot) -> None:
    going = HeldSkill(held_robot, held_robot.drive_to, *held_robot.places["bedroom"])

    for _ in range(3):
        assert going.report()["progress"] < 1.0
        held_robot.advance(1.0)

    assert going.end() is None
    told = [report["progress"] for report in going.reports]
    assert told[2] > told[0]
    assert told == sorted(told)
    assert told[-1] == 1.0


def test_furniture_pushed_into_the_way_is_driven_around(meddled_hall) -> None:
    robot, engine = meddled_hall(
        "obstacle: [{name: box, shape: {name: rectangle, length: 0.4, width: 0.4}, "
        "state: [4, 3.4, 0], mass: 2, friction: 0.3}]"
    )
    going = HeldSkill(robot, robot.drive_to, 7.0, 2.0)
    engine.put(robot.pose(), [Pose2D(4.0, 2.0, 0.0)])

    assert going.end() is None
    assert max(abs(y - 2.0) for _, y in robot.trail()) > 0.25
    assert robot.state()["collisions"] == 0


def test_a_robot_that_cannot_move_says_that_it_is_stuck(meddled_hall) -> None:
    robot, engine = meddled_hall()
    going = HeldSkill(robot, robot.drive_to, 7.0, 2.0)
    stands = MotionState(robot.pose(), Twist2D(0.0, 0.0), frozenset())
    engine.meddle = lambda command, step: stands

    error = going.end()

    assert isinstance(error, SkillFailed)
    assert "I am stuck" in str(error)
    assert robot.state()["goal"] is None


def test_an_empty_battery_ends_the_drive_with_that_reason(in_hall) -> None:
    robot = in_hall(
        "custom: {edgevox: {battery: {capacity_wh: 0.01, linear_w_per_m_s: 20, dock: [7, 3]}}}",
        speed=0.0,
    )

    with pytest.raises(SkillFailed, check=phrases.because("battery_empty")):
        carry_out(robot, robot.drive_to, 7.0, 1.0)
    with pytest.raises(SkillFailed, check=phrases.because("battery_empty")):
        carry_out(robot, robot.drive_to, 7.0, 1.0)

    assert robot.battery() == 0.0
    robot.reset()
    assert robot.battery() == 1.0


def test_the_battery_drains_with_time_and_more_with_motion_and_charges_at_its_dock(robot) -> None:
    drive(robot, *robot.places["kitchen"])
    moved = robot.battery()
    start = robot.time_s
    robot.advance(20.0)
    stood = robot.battery()

    assert 1.0 - moved > 2 * (moved - stood) * start / 20.0
    assert stood < moved
    drive(robot, robot.world.robot.start.x_m, robot.world.robot.start.y_m)
    robot.advance(60.0)
    assert robot.battery() == 1.0


def test_a_robot_that_was_switched_off_says_so(robot) -> None:
    robot.close()

    with pytest.raises(SkillFailed, check=phrases.because("switched_off")):
        drive(robot, 3.0, 3.0)


def test_a_chair_is_pushed_and_slides_to_rest_and_the_wall_holds(in_hall) -> None:
    robot = in_hall(
        "obstacle: [{name: chair, shape: {name: circle, radius: 0.2}, state: [2, 2, 0], "
        "mass: 4, friction: 0.3}]"
    )
    for _ in range(40):
        robot.set_velocity(Twist2D(0.8, 0.0))
        robot.advance(0.1)
    robot.advance(1.0)
    (chair,) = robot.movable_poses()

    assert chair.x_m > 3.5
    assert robot.state()["collisions"] >= 1
    for _ in range(60):
        robot.set_velocity(Twist2D(0.8, 0.0))
        robot.advance(0.1)
    (chair,) = robot.movable_poses()
    assert chair.x_m <= 7.81, "the chair is at the wall"
    assert robot.pose().x_m <= 7.82 - 0.2


def test_a_wall_stops_the_robot_and_counts_as_a_touch(in_hall) -> None:
    robot = in_hall()
    for _ in range(100):
        robot.set_velocity(Twist2D(0.8, 0.0))
        robot.advance(0.1)

    assert robot.pose().x_m == pytest.approx(7.8, abs=0.02)
    assert robot.state()["touching"] == ["edge"]
    assert robot.state()["collisions"] == 1


def test_reset_puts_everything_back_but_time(robot) -> None:
    start = robot.pose()
    drive(robot, *robot.places["kitchen"])
    time_s = robot.time_s

    robot.reset()

    assert astuple(robot.pose()) == pytest.approx(astuple(start))
    assert robot.state()["collisions"] == 0
    assert robot.trail() == ((start.x_m, start.y_m),)
    assert robot.time_s >= time_s
