"""Robots on wheels go straight by a distance and turn by an angle, and say what came of it."""

import math
from dataclasses import astuple, replace

import phrases
import pytest
from guards import HUNG_S
from held_time import STEP_S, HeldSkill, carry_out
from spoken_robot import SpokenRobot, trod

from edgevox.agent.phrases.load import phrasebook
from edgevox.agent.skills import SkillFailed, SkillSet
from edgevox.agent.text import reasons
from edgevox.core.agent_events import GoalStatus
from edgevox.core.cancel import Cancelled, CancelToken
from edgevox.core.errors import InvalidValue
from edgevox.core.transforms import Pose2D
from edgevox.robots.capabilities import Twist2D
from edgevox.robots.flat.engine import MotionState

BOX = (
    "obstacle: [{name: box, shape: {name: rectangle, length: 0.4, width: 0.4}, "
    "state: [5, 3.7, 0], mass: 2, friction: 0.3}]"
)
WALL = "obstacle: [{name: wall, shape: {name: rectangle, length: 0.1, width: 3}, state: [3, 2, 0]}]"
SEES_AHEAD = "  sensors: [{name: lidar2d, number: 180, angle_range: 3.14159, range_max: 10}]\n"
SEES_BACK = (
    "  sensors: [{name: lidar2d, number: 180, angle_range: 3.14159, range_max: 10, "
    "offset: [0, 0, 3.14159]}]\n"
)
START = (1.0, 2.0)


def told(robot, error: BaseException | None) -> str:
    """What a failure is said as."""
    assert isinstance(error, SkillFailed)
    return phrasebook("en").failure(error.reason)


def call(robot, name: str, **arguments: float):
    """A skill as a goal calls it, its result or what it raised, once the robot stands."""
    one = SkillSet(robot.skills)[name]

    def run(*, token, report):
        goal = type("Goal", (), {"token": token, "report": staticmethod(report)})()
        return one.function(goal, **one.validate(arguments))

    return carry_out(robot, run)


@pytest.mark.parametrize("distance", [0.05, 0.3, 2.0, 6.0, -0.5])
def test_it_drives_straight_by_the_distance_and_tells_it(in_hall, distance) -> None:
    robot = in_hall(speed=0.0)

    name = "drive_forward" if distance > 0 else "drive_backward"
    result = call(robot, name, distance=abs(distance))

    pose = robot.pose()
    assert pose.x_m == pytest.approx(START[0] + distance, abs=0.02)
    assert max(abs(y - START[1]) for _, y in robot.trail()) < 0.01
    assert pose.yaw_rad == pytest.approx(0.0, abs=0.01)
    assert result["driven"] == pytest.approx(abs(distance), abs=0.02)
    assert robot.state()["goal"] is None


@pytest.mark.parametrize("degrees", [1.0, 45.0, 90.0, 180.0, 270.0, 720.0])
@pytest.mark.parametrize("side", ["left", "right"])
def test_it_turns_on_the_spot_by_the_angle_and_tells_it(in_hall, side, degrees) -> None:
    robot = in_hall(speed=0.0)

    result = call(robot, f"turn_{side}", degrees=degrees)

    wanted = math.radians(degrees if side == "left" else -degrees)
    off = math.remainder(robot.pose().yaw_rad - wanted, math.tau)
    assert abs(off) < 0.03
    assert (robot.pose().x_m, robot.pose().y_m) == pytest.approx(START, abs=0.01)
    assert result["turned"] == pytest.approx(degrees, abs=1.5)


def test_it_comes_back_onto_its_line_when_it_is_pushed_aside(meddled_hall) -> None:
    robot, engine = meddled_hall()
    going = HeldSkill(robot, robot.drive_straight, 4.0)
    going.until(lambda: robot.pose().x_m > 1.5)
    at = robot.pose()
    engine.put(Pose2D(at.x_m, at.y_m + 0.15, at.yaw_rad + 0.1), [])

    assert going.end() is None
    assert (robot.pose().x_m, robot.pose().y_m) == pytest.approx((5.0, 2.0), abs=0.04)


def test_a_drive_under_a_speed_limit_keeps_to_it(in_hall) -> None:
    robot = in_hall(speed=0.0)
    robot.limit_speed(lambda twist: replace(twist, linear_m_s=min(twist.linear_m_s, 0.2)))
    going = HeldSkill(robot, robot.drive_straight, 1.0)
    speeds = []
    going.until(lambda: speeds.append(robot.velocity().linear_m_s) or robot.pose().x_m > 1.9)

    assert going.end() is None
    assert max(speeds) <= 0.21
    assert robot.pose().x_m == pytest.approx(2.0, abs=0.02)


def test_what_comes_into_its_way_stops_it_and_it_says_how_far_it_came(meddled_hall) -> None:
    robot, engine = meddled_hall(BOX)
    going = HeldSkill(robot, lambda **goal: call_with(robot, "drive_forward", 5.0, **goal))
    going.until(lambda: robot.pose().x_m > 2.0)
    engine.put(robot.pose(), [Pose2D(3.4, 2.0, 0.0)])

    error = going.end()

    driven = robot.pose().x_m - START[0]
    assert 1.0 < driven < 2.0
    assert told(robot, error) == phrases.failed(
        "stopped_short", driven=reasons.number(driven), why=reasons.because("in_my_way")
    )
    assert robot.state()["collisions"] == 0
    assert max(abs(y - START[1]) for _, y in robot.trail()) < 0.02, "it goes round nothing"


def call_with(robot, name, distance, *, token, report):
    goal = type("Goal", (), {"token": token, "report": staticmethod(report)})()
    return SkillSet(robot.skills)[name].function(goal, distance)


def test_what_leaves_its_way_in_time_lets_it_go_on(meddled_hall) -> None:
    robot, engine = meddled_hall(BOX)
    going = HeldSkill(robot, robot.drive_straight, 3.0)
    going.until(lambda: robot.pose().x_m > 1.5)
    engine.put(robot.pose(), [Pose2D(2.4, 2.0, 0.0)])
    going.until(lambda: robot.velocity() == Twist2D(0.0, 0.0))
    engine.put(robot.pose(), [Pose2D(5.0, 3.7, 0.0)])

    assert going.end() is None
    assert robot.pose().x_m == pytest.approx(4.0, abs=0.02)


def test_what_is_in_its_way_already_refuses_the_drive_and_it_does_not_move(in_hall) -> None:
    robot = in_hall(WALL.replace("state: [3", "state: [1.4"), speed=0.0)
    before = robot.pose()

    with pytest.raises(SkillFailed, check=phrases.because("in_my_way")):
        call(robot, "drive_forward", distance=1.0)

    robot.advance(0.5)
    assert astuple(robot.pose()) == astuple(before)


def test_what_stands_behind_its_goal_is_not_in_its_way(in_hall) -> None:
    robot = in_hall(WALL, speed=0.0)

    call(robot, "drive_forward", distance=1.6)

    assert robot.pose().x_m == pytest.approx(2.6, abs=0.02)
    assert robot.state()["collisions"] == 0


@pytest.mark.parametrize(
    ("sensors", "distance", "why"),
    [
        (SEES_AHEAD, -0.5, "blind_behind"),
        (SEES_AHEAD, 0.5, None),
        (SEES_BACK, 0.5, "blind_ahead"),
        (SEES_BACK, -0.5, None),
    ],
)
def test_it_goes_only_where_its_lidar_sees(in_hall, sensors, distance, why) -> None:
    robot = in_hall(sensors, speed=0.0)

    if why is None:
        carry_out(robot, robot.drive_straight, distance)
        assert robot.pose().x_m == pytest.approx(START[0] + distance, abs=0.02)
    else:
        with pytest.raises(SkillFailed, check=lambda error: error.reason.code == why):
            carry_out(robot, robot.drive_straight, distance)
        assert robot.pose().x_m == START[0]


def test_a_robot_that_does_not_get_on_gives_up(meddled_hall) -> None:
    robot, engine = meddled_hall()
    going = HeldSkill(robot, robot.drive_straight, 2.0)
    stands = MotionState(robot.pose(), Twist2D(0.0, 0.0), frozenset())
    engine.meddle = lambda command, step: stands

    error = going.end()

    assert told(robot, error) == phrases.failed("no_further")


def test_a_goal_outside_the_world_is_refused_with_its_edges(in_hall) -> None:
    robot = in_hall(speed=0.0)

    with pytest.raises(SkillFailed, check=phrases.because("outside")):
        call(robot, "drive_forward", distance=8.0)


@pytest.mark.parametrize(
    ("skill", "amount"),
    [
        ("drive_forward", {"distance": 0.01}),
        ("drive_forward", {"distance": 50.0}),
        ("drive_backward", {"distance": -1.0}),
        ("turn_left", {"degrees": 0.5}),
        ("turn_right", {"degrees": 1000.0}),
    ],
)
def test_an_amount_out_of_bounds_is_refused(robot, skill, amount) -> None:
    with pytest.raises(InvalidValue):
        SkillSet(robot.skills)[skill].validate(amount)


@pytest.mark.parametrize("how", ["stop", "cancel", "velocity", "drive"])
def test_whatever_ends_a_drive_ends_this_one(in_hall, how) -> None:
    robot = in_hall(speed=0.0)
    going = HeldSkill(robot, robot.drive_straight, 5.0)
    going.until(lambda: robot.pose().x_m > 1.5)

    match how:
        case "stop":
            robot.halt("asked")
        case "cancel":
            going.token.cancel()
        case "velocity":
            robot.set_velocity(Twist2D(0.0, 0.0))
        case "drive":
            later = HeldSkill(robot, robot.turn, 1.0)
    error = going.ended()

    assert isinstance(error, Cancelled)
    if how == "drive":
        assert later.end() is None
    robot.advance(0.8)
    assert abs(robot.velocity().linear_m_s) < 0.02
    assert robot.pose().x_m < 1.8


def test_progress_is_reported_while_it_drives_and_turns(in_hall) -> None:
    robot = in_hall(speed=0.0)
    going = HeldSkill(robot, robot.drive_straight, 3.0)
    going.until(lambda: robot.pose().x_m > 2.0)
    said = going.report()

    assert said["unit"] == "m"
    assert 0.2 < said["progress"] < 0.6
    assert robot.state()["goal"]["x"] == pytest.approx(4.0)
    assert going.end() is None

    turning = HeldSkill(robot, robot.turn, math.pi)
    turning.until(lambda: robot.pose().yaw_rad > 1.0)
    said = turning.report()
    assert said["unit"] == "deg"
    assert 0.2 < said["progress"] < 0.8
    assert turning.end() is None


@pytest.mark.parametrize(
    ("policy", "code"),
    [
        ("limits: {distance_m: 1}", "policy_distance"),
        ("limits: {goals: {y: {max: 2.5}}}", "policy_area"),
        ("limits: {places: {never: [living_room]}}", "policy_place"),
        ("limits: {places: {never: [bedroom]}}", None),
        ("rules: {'*': {drive_forward: deny}}", "policy_denied"),
    ],
)
def test_the_policy_bounds_how_far_and_where(tmp_path, policy, code) -> None:
    with SpokenRobot(tmp_path, policy=policy) as one:
        before = one.body.pose()
        one.say("drive forward two metres")

        assert one.told("code")[-1:] == ([code] if code else [])
        moved = math.dist(astuple(before)[:2], astuple(one.body.pose())[:2])
        assert moved == pytest.approx(0.0 if code else 2.0, abs=0.05)


def test_the_policy_forbids_a_straight_way_into_a_room(tmp_path) -> None:
    with SpokenRobot(tmp_path, policy="limits: {places: {never: [bedroom]}}") as one:
        one.say("go to x 3.2, y 4")
        north = math.pi / 2 - one.body.pose().yaw_rad
        one.body.turn(north, token=CancelToken(), report=lambda **_: None)
        one.say("drive forward three metres")

        assert one.told("code")[-1:] == ["policy_place"]
        assert "bedroom" not in trod(one)


def test_a_new_policy_ends_a_drive_that_it_forbids(tmp_path) -> None:
    with SpokenRobot(tmp_path, speed=0.0) as one:
        goal = one.conversation.start_goal("drive_forward", {"distance": 2.0})
        one.body.advance(STEP_S)
        one.under("rules: {'*': {drive_forward: deny}}")

        assert goal.wait(HUNG_S)
        assert (goal.status, goal.reason.code) == (GoalStatus.FAILED, "policy_denied")
        assert not one.body.in_motion
