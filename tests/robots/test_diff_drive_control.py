"""Who may steer, and how everything stops."""

import json
import logging
import math
import threading
from collections.abc import Callable

import numpy as np
import phrases
import pytest
from engines import meddled
from guards import HUNG_S
from held_time import STEP_S, HeldSkill
from support.clock import HeldClock
from waiting import wait_until

from edgevox.agent.skills import SkillFailed
from edgevox.core.cancel import Cancelled, CancelToken
from edgevox.core.errors import InvalidValue
from edgevox.core.transforms import Pose2D
from edgevox.robots.capabilities import Twist2D
from edgevox.robots.flat.diff_drive import DiffDriveRobot
from edgevox.robots.flat.engine import MotionState
from edgevox.robots.world.load import load_world, parse_world

BRAKE_TIME_S = 0.1
BLUE = (37, 99, 235)
NEARSIGHTED = """
world: {width: 8, height: 4}
robot:
  kinematics: {name: diff}
  state: [1, 2, 0]
  sensors: [{name: lidar2d, number: 91, angle_range: 6.2832, range_max: 3}]
"""


def stands(robot: DiffDriveRobot) -> bool:
    twist = robot.velocity()
    return abs(twist.linear_m_s) < 0.01 and abs(twist.angular_rad_s) < 0.01


def test_a_cancelled_drive_stops_at_once(held_robot) -> None:
    going = HeldSkill(held_robot, held_robot.drive_to, *held_robot.places["bedroom"])
    held_robot.advance(3.0)
    assert not stands(held_robot)

    going.token.cancel("never mind")
    held_robot.advance(BRAKE_TIME_S)

    assert stands(held_robot)
    assert str(going.ended()) == "never mind"
    assert held_robot.state()["goal"] is None


def test_a_drive_keeps_to_the_speed_that_somebody_else_permits(held_robot) -> None:
    """The limit may change while it drives, as a policy does, and it arrives all the same."""
    most_m_s = 0.2
    held_robot.limit_speed(
        lambda twist: slowed(twist, most_m_s) if abs(twist.linear_m_s) > most_m_s else twist
    )
    going = HeldSkill(held_robot, held_robot.drive_to, *held_robot.places["living_room"])
    fastest_m_s = 0.0
    for _ in range(150):
        held_robot.advance(STEP_S)
        fastest_m_s = max(fastest_m_s, abs(held_robot.velocity().linear_m_s))
    assert 0.1 < fastest_m_s < most_m_s + 0.01
    most_m_s = 10.0
    going.until(lambda: held_robot.velocity().linear_m_s > 0.3)
    assert going.end() is None


def slowed(twist: Twist2D, most_m_s: float) -> Twist2D:
    """The same arc at this speed."""
    over = abs(twist.linear_m_s) / most_m_s
    return Twist2D(twist.linear_m_s / over, twist.angular_rad_s / over)


def test_a_token_that_is_cancelled_already_starts_nothing(robot) -> None:
    token = CancelToken()
    robot.drive_to(3.0, 3.0, token=token, report=lambda **f: None)
    token.cancel()

    with pytest.raises(Cancelled):
        robot.drive_to(1.5, 4.0, token=token, report=lambda **f: None)


@pytest.mark.parametrize(
    ("act", "reason"),
    [
        (lambda robot: robot.halt("the stop word"), "the stop word"),
        (lambda robot: robot.set_velocity(Twist2D(0.0, 0.0)), "somebody else steers"),
        (lambda robot: robot.reset(), "the world was reset"),
        (lambda robot: robot.close(), "the robot was switched off"),
    ],
)
def test_what_ends_a_drive_is_its_reason(held_robot, act, reason) -> None:
    going = HeldSkill(held_robot, held_robot.drive_to, *held_robot.places["bedroom"])

    act(held_robot)

    error = going.ended()
    assert isinstance(error, Cancelled)
    assert str(error) == reason


def test_a_new_drive_ends_the_one_before(held_robot) -> None:
    first = HeldSkill(held_robot, held_robot.drive_to, *held_robot.places["bedroom"])
    second = HeldSkill(held_robot, held_robot.drive_to, 4.3, 1.5)

    assert isinstance(first.ended(), Cancelled)
    assert second.end() is None
    assert held_robot.pose().y_m == pytest.approx(1.5, abs=0.15)


def test_halt_stops_a_stream_of_velocities_and_says_whether_it_did(held_robot) -> None:
    held_robot.set_velocity(Twist2D(0.8, 0.0))
    held_robot.advance(0.4)

    assert held_robot.halt("enough")
    held_robot.advance(BRAKE_TIME_S)

    assert stands(held_robot)
    assert not held_robot.halt("again")


def test_a_stream_that_falls_silent_halts_the_robot_after_half_a_second(in_hall) -> None:
    robot = in_hall()

    robot.set_velocity(Twist2D(0.6, 0.0))
    robot.advance(2.0)

    speeding_up_m = 0.6**2 / (2 * 1.5)
    assert stands(robot)
    assert robot.pose().x_m - 1.0 == pytest.approx(speeding_up_m + 0.1 * 0.6, abs=0.04)


def test_a_velocity_is_followed_and_kept_within_the_limits(in_hall) -> None:
    robot = in_hall()
    for _ in range(15):
        robot.set_velocity(Twist2D(100.0, -100.0))
        robot.advance(0.1)
    twist = robot.velocity()

    assert twist.linear_m_s == pytest.approx(0.8, abs=0.05)
    assert twist.angular_rad_s == pytest.approx(-2.0, abs=0.05)


@pytest.mark.parametrize("bad", [math.nan, math.inf, -math.inf])
@pytest.mark.parametrize("field", ["linear_m_s", "angular_rad_s"])
def test_a_velocity_that_is_no_number_is_refused_and_harms_nothing(robot, field, bad) -> None:
    twist = Twist2D(**{"linear_m_s": 0.1, "angular_rad_s": 0.1, field: bad})

    with pytest.raises(InvalidValue, match=field):
        robot.set_velocity(twist)

    robot.advance(0.1)
    assert stands(robot)
    assert math.isfinite(robot.pose().x_m)


def test_a_motion_that_becomes_no_number_is_logged_and_the_world_goes_on(make, caplog) -> None:
    robot, engine = meddled(make, load_world(), speed=None)

    def break_once(command: Twist2D, step: Callable[[Twist2D], MotionState]) -> MotionState:
        engine.meddle = None
        return MotionState(Pose2D(math.nan, 0.0, 0.0), Twist2D(0.0, 0.0), frozenset())

    with caplog.at_level(logging.ERROR), robot:
        engine.meddle = break_once
        with pytest.raises(SkillFailed, check=phrases.because("broke")):
            robot.drive_to(3.4, 2.9, token=CancelToken(), report=lambda **f: None)
        robot.drive_to(3.4, 2.9, token=CancelToken(), report=lambda **f: None)

    assert "became" in caplog.text
    assert robot.state()["room"] == "living_room"


def test_the_state_is_json_and_says_where_it_goes(held_robot) -> None:
    going = HeldSkill(held_robot, held_robot.drive_to, *held_robot.places["bedroom"])
    held_robot.advance(2.0)

    state = json.loads(json.dumps(held_robot.state(), allow_nan=False))

    assert list(state) == [
        "name",
        "time",
        "simulation",
        "pose",
        "velocity",
        "room",
        "battery",
        "goal",
        "touching",
        "collisions",
    ]
    assert state["goal"].keys() == {"x", "y", "progress", "distance"}
    assert 0 < state["goal"]["progress"] < 1
    held_robot.halt("the test is over")
    going.ended()


def test_the_map_shows_the_rooms_the_way_and_the_robot(held_robot) -> None:
    going = HeldSkill(held_robot, held_robot.drive_to, *held_robot.places["bedroom"])
    drawn = held_robot.draw_map(60)
    held_robot.halt("the test is over")
    going.ended()

    lines = drawn.splitlines()
    assert len(lines) == 30
    assert max(map(len, lines)) <= 60
    for name in ("kitchen", "living room", "bedroom", "office"):
        assert name in drawn
    assert sum(drawn.count(arrow) for arrow in "→↗↑↖←↙↓↘") == 1
    assert "·" in drawn
    assert drawn.count("◎") == 1


def test_a_scan_sees_the_walls_of_the_hall(in_hall) -> None:
    robot = in_hall()

    scan = robot.scan()
    to_angle = {0.0: 7.0, math.pi / 2: 2.0, -math.pi / 2: 2.0, -math.pi: 1.0}

    assert len(scan.ranges_m) == 360
    for angle_rad, wall_m in to_angle.items():
        beam = round((angle_rad - scan.angle_min_rad) / scan.angle_increment_rad)
        assert float(scan.ranges_m[beam]) == pytest.approx(wall_m, abs=2e-3)


def test_a_beam_that_meets_nothing_within_its_reach_is_infinite(make) -> None:
    robot = make(parse_world(NEARSIGHTED, "hall.yaml"))

    ranges = robot.scan().ranges_m

    assert np.isinf(ranges[45])
    assert ranges.min() == pytest.approx(1.0, abs=1e-3)


def test_a_picture_shows_where_the_robot_is(robot) -> None:
    before = robot.picture()
    for _ in range(10):
        robot.set_velocity(Twist2D(0.8, 0.0))
        robot.advance(0.1)
    after = robot.picture()

    assert before.shape == after.shape == (800, 800, 3)
    assert before.dtype == np.uint8
    rows = [np.argwhere((image == BLUE).all(axis=2))[:, 0].mean() for image in (before, after)]
    assert 30 < rows[0] - rows[1] < 80, "it drove up, 75 pixels a metre"


def test_at_rest_as_much_time_passes_and_charge_goes_as_in_a_world_that_is_stepped(make) -> None:
    clock = HeldClock(100.0)
    with make(speed=1.0, clock=clock) as robot, make(speed=0.0) as stepped:
        for tenths in range(1, 101):
            clock.now_s += 0.1
            wait_until(lambda: robot.time_s > tenths / 10 - STEP_S / 2)  # noqa: B023
        stepped.advance(robot.time_s)

        assert robot.time_s == pytest.approx(10.0, abs=1.5 * STEP_S)
        assert robot.time_s == stepped.time_s
        assert robot.battery() == stepped.battery()


def test_real_time_passes_as_the_clock_does(make) -> None:
    clock = HeldClock(100.0)
    with make(speed=1.0, clock=clock) as robot:
        for turns in (1, 2, 3):
            passed_s = 0.2 * turns
            clock.now_s += 0.2
            wait_until(lambda: robot.time_s > passed_s - STEP_S / 2)  # noqa: B023
            assert robot.time_s < passed_s + 1.5 * STEP_S


def test_after_close_no_thread_is_left_and_closing_twice_is_fine(make) -> None:
    before = set(threading.enumerate())
    robot = make()
    robot.start()
    assert set(threading.enumerate()) - before

    robot.close()
    robot.close()

    assert set(threading.enumerate()) == before


def test_many_threads_may_ask_and_steer_at_once(robot) -> None:
    errors: list[BaseException] = []

    def ask() -> None:
        try:
            for i in range(30):
                robot.state()
                robot.scan()
                robot.set_velocity(Twist2D(0.3, 0.1 * (i % 3)))
                if i % 10 == 0:
                    robot.drive_to(3.0, 3.0, token=CancelToken(), report=lambda **f: None)
        except (Cancelled, SkillFailed):
            pass
        except BaseException as error:  # noqa: BLE001 - the test looks at it
            errors.append(error)

    threads = [threading.Thread(target=ask) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join(HUNG_S)

    assert not any(thread.is_alive() for thread in threads)
    assert errors == []
