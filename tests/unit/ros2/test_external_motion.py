"""What is concluded from odometry and scans: silence, standing, getting on, something ahead."""

import math

import numpy as np
import phrases
import pytest
from hypothesis import given
from hypothesis import strategies as st
from support.clock import HeldClock

from edgevox.agent.phrases.load import phrasebook
from edgevox.agent.skills import SkillFailed
from edgevox.core.transforms import Pose2D
from edgevox.robots.capabilities import LidarScan, Twist2D
from edgevox.robots.relative_motion import blocked
from edgevox.ros2.external.navigation import ProgressWatch
from edgevox.ros2.external.odometry import OdometryHistory, OdometrySample
from edgevox.ros2.external.settings import Patience, Speeds, sweeps

MIDDLE = Pose2D(0, 0, 0)


@pytest.fixture
def clock() -> HeldClock:
    return HeldClock()


def see(
    odometry_history: OdometryHistory,
    clock: HeldClock,
    x_m: float = 0.0,
    speed_m_s: float = 0.0,
    *,
    yaw_rad: float = 0.0,
    stamp_s: float = 0.0,
    height_m: float = 0.0,
) -> bool:
    return odometry_history.add(
        OdometrySample(
            pose=Pose2D(x_m, 0.0, yaw_rad),
            twist=Twist2D(speed_m_s, 0.0),
            frame="odom",
            child_frame="base_link",
            stamp_ns=round(stamp_s * 1e9),
            heard_s=clock.now_s,
            height_m=height_m,
        )
    )


def test_odometry_of_more_than_a_second_ago_is_no_position(clock) -> None:
    odometry_history = OdometryHistory(clock)
    assert odometry_history.fresh() is None
    see(odometry_history, clock)
    clock.now_s = 1.0
    assert odometry_history.fresh() is not None
    clock.now_s = 1.1
    assert odometry_history.fresh() is None
    assert odometry_history.newest() is not None


@pytest.mark.parametrize(
    ("how", "moves"),
    [
        ({}, False),
        ({"speed_m_s": 0.3}, True),
        ({"x_m": 0.1}, True),
        ({"yaw_rad": 0.1}, True),
        ({"height_m": 0.1}, True),
    ],
)
def test_a_robot_moves_by_its_velocity_or_by_its_poses(clock, how, moves) -> None:
    odometry_history = OdometryHistory(clock)
    assert not odometry_history.moves()
    see(odometry_history, clock)
    clock.now_s += 0.1
    see(odometry_history, clock, **how)
    assert odometry_history.moves() is moves
    clock.now_s += 2.0
    assert not odometry_history.moves(), "a silent robot shows no motion"


@pytest.mark.parametrize("wrong", [math.nan, math.inf, 1e300, -1e300, 1e12, -10_001.0])
def test_odometry_that_cannot_be_true_is_not_taken(clock, wrong) -> None:
    odometry_history = OdometryHistory(clock)

    assert not see(odometry_history, clock, x_m=wrong)
    assert not see(odometry_history, clock, speed_m_s=wrong)
    assert odometry_history.newest() is None
    assert odometry_history.refused == 2
    assert odometry_history.absurd


def test_a_robot_is_believed_again_with_the_first_thing_that_can_be_true(clock) -> None:
    odometry_history = OdometryHistory(clock)
    see(odometry_history, clock)
    see(odometry_history, clock, x_m=1e300)
    assert odometry_history.absurd
    assert odometry_history.doubt.jump is None
    see(odometry_history, clock, x_m=0.01)
    assert not odometry_history.absurd
    assert odometry_history.fresh().pose.x_m == 0.01
    assert odometry_history.doubt.number == 1


@pytest.mark.parametrize(
    ("seconds", "stamped_s", "x_m", "yaw_rad", "jumped"),
    [
        (0.05, 0.05, 0.3, 0.0, False),
        (0.05, 0.05, 0.5, 1.0, False),
        (0.05, 0.05, 1.0, 0.0, True),
        (0.05, 0.05, 0.0, 2.0, True),
        (0.05, 0.05, 5000.0, 0.0, True),
        (1.0, 1.0, 2.0, 3.1, False),
        (1.0, 1.0, 6.0, 0.0, True),
        (0.0, 0.2, 1.2, 0.0, False),  # a burst: sent one by one, heard at once
        (0.05, 1e9, 6.0, 0.0, True),  # a stamp is only the robot's word
        (0.05, -5.0, 1.0, 0.0, True),
        (0.0, 0.0, 0.4, 0.5, False),
    ],
)
def test_what_is_further_than_a_robot_can_have_come_is_a_jump(
    clock, seconds, stamped_s, x_m, yaw_rad, jumped
) -> None:
    odometry_history = OdometryHistory(clock)
    see(odometry_history, clock, stamp_s=100.0)
    clock.now_s += seconds
    assert see(odometry_history, clock, x_m, yaw_rad=yaw_rad, stamp_s=100.0 + stamped_s)

    assert (odometry_history.doubt is not None) is jumped
    assert odometry_history.newest().pose.x_m == x_m, "it is where the robot is from now on"


def test_a_jump_is_said_with_how_far_it_was(clock) -> None:
    odometry_history = OdometryHistory(clock)
    see(odometry_history, clock)
    see(odometry_history, clock, x_m=5.04, yaw_rad=math.pi / 2)
    said = odometry_history.doubt.jump.reason
    assert (said.code, said.values) == ("jumped", {"distance": "5.0", "degrees": "90"})
    assert (
        phrasebook("de")
        .reason(said)
        .startswith("die Position des Roboters ist um 5 Meter und 90 Grad")
    )


def test_a_fast_robot_does_not_jump_by_being_fast(clock) -> None:
    fast = OdometryHistory(clock, Speeds(linear_m_s=20.0))
    for step in range(10):
        see(fast, clock, x_m=1.0 * step, stamp_s=0.05 * step)
        clock.now_s += 0.05
    assert fast.doubt is None


@given(st.lists(st.tuples(st.floats(), st.floats(), st.floats(allow_nan=True)), max_size=20))
def test_whatever_is_heard_only_what_can_be_is_a_position(heard) -> None:
    odometry_history = OdometryHistory(HeldClock())
    for x_m, speed_m_s, yaw_rad in heard:
        see(odometry_history, HeldClock(), x_m, speed_m_s, yaw_rad=yaw_rad)
    newest = odometry_history.newest()
    assert newest is None or (abs(newest.pose.x_m) <= 10_000 and newest.pose.finite)


@pytest.mark.parametrize(
    ("beams", "angle_min", "increment", "near_m", "far_m", "can_be"),
    [
        (360, -math.pi, math.tau / 360, 0.05, 10.0, True),
        (360, math.pi, -math.tau / 360, 0.0, math.inf, True),
        (0, 0.0, 0.1, 0.05, 10.0, False),
        (360, math.nan, 0.01, 0.05, 10.0, False),
        (360, 0.0, math.nan, 0.05, 10.0, False),
        (360, 0.0, 1e30, 0.05, 10.0, False),
        (360, 1e30, 0.01, 0.05, 10.0, False),
        (360, 0.0, 0.01, math.nan, 10.0, False),
        (360, 0.0, 0.01, 0.05, math.nan, False),
        (360, 0.0, 0.01, 0.0, 0.0, False),
        (360, 0.0, 0.01, 10.0, 0.05, False),
        (10**6, 0.0, 1e-6, 0.05, 10.0, False),
    ],
)
def test_a_sweep_in_which_nothing_could_be_seen_is_none(
    beams, angle_min, increment, near_m, far_m, can_be
) -> None:
    assert sweeps(beams, angle_min, increment, near_m, far_m) is can_be


def test_a_robot_stands_when_it_was_seen_not_to_move_for_a_while(clock) -> None:
    odometry_history = OdometryHistory(clock)
    see(odometry_history, clock, speed_m_s=0.3)
    for _ in range(3):
        clock.now_s += 0.1
        see(odometry_history, clock)
    assert not odometry_history.stands(0.0)
    clock.now_s += 0.15
    see(odometry_history, clock)
    assert odometry_history.stands(0.0)
    assert not odometry_history.stands(0.2)


def test_a_robot_that_does_not_tell_its_speed_stands_only_if_it_stays(clock) -> None:
    odometry_history = OdometryHistory(clock)
    for step in range(20):
        clock.now_s += 0.1
        see(odometry_history, clock, x_m=0.02 * step)
    assert not odometry_history.stands(0.0)
    for _ in range(5):
        clock.now_s += 0.1
        see(odometry_history, clock, x_m=0.38)
    assert odometry_history.stands(0.0)


def test_a_silent_robot_is_not_seen_to_stand(clock) -> None:
    odometry_history = OdometryHistory(clock)
    for _ in range(10):
        clock.now_s += 0.1
        see(odometry_history, clock)
    clock.now_s += 2.0
    assert not odometry_history.stands(0.0)


def watch() -> ProgressWatch:
    return ProgressWatch(Patience(unmoved_s=5.0, no_nearer_s=20.0), Pose2D(0, 0, 0), 4.0, 0.0)


def test_a_robot_that_does_not_move_has_failed_after_a_while() -> None:
    one = watch()
    one.look(5.0, Pose2D(0, 0, 0), 4.0)
    with pytest.raises(SkillFailed, check=phrases.because("not_moving", left="4.0")):
        one.look(5.1, Pose2D(0.01, 0, 0), 4.0)


def test_a_robot_that_turns_gets_on_but_not_for_ever() -> None:
    one = watch()
    for second in range(20):
        one.look(second, Pose2D(0, 0, second % 3), 4.0)
    with pytest.raises(SkillFailed, check=phrases.because("not_closer", left="4.0")):
        one.look(20.5, Pose2D(0, 0, 2), 4.0)


def test_a_robot_that_comes_nearer_slowly_gets_on() -> None:
    one = watch()
    for second in range(60):
        one.look(second, Pose2D(0.05 * second, 0, 0), 4.0 - 0.05 * second)


def test_a_robot_that_waits_is_not_blamed_for_standing() -> None:
    one = watch()
    one.look(30.0, Pose2D(0, 0, 0), 4.0, waiting=True)
    one.look(34.0, Pose2D(0, 0, 0), 4.0)


def look_on(looks) -> None:
    one = watch()
    for now_s, pose, left_m, waiting in looks:
        one.look(now_s, pose, left_m, waiting=waiting)


def test_a_robot_that_waits_and_turns_by_turns_is_given_up() -> None:
    with pytest.raises(SkillFailed, check=phrases.because("not_closer")):
        look_on((0.05 * tick, Pose2D(0, 0, tick % 7), 4.0, bool(tick % 2)) for tick in range(2000))


def test_a_drive_that_comes_nearer_by_a_hair_ends_all_the_same() -> None:
    with pytest.raises(SkillFailed, check=phrases.because("not_moving")):
        look_on((19.0 * n, Pose2D(0, 0, n % 7), 4.0 - 0.11 * n, False) for n in range(30))


def scan(*points: tuple[float, float], mount: Pose2D = MIDDLE) -> LidarScan:
    ranges = np.full(360, np.inf, dtype=np.float32)
    for distance_m, angle_deg in points:
        ranges[int(angle_deg) % 360] = distance_m
    return LidarScan(
        time_s=0.0,
        angle_min_rad=0.0,
        angle_increment_rad=math.tau / 360,
        range_min_m=0.05,
        range_max_m=10.0,
        ranges_m=ranges,
        mount=mount,
    )


@pytest.mark.parametrize(
    ("seen", "in_the_way"),
    [
        (scan((0.4, 0)), True),
        (scan((0.4, 20)), True),
        (scan((0.6, 0)), False),
        (scan((0.4, 90)), False),
        (scan((0.4, 180)), False),
        (scan((0.01, 0)), False),
        (scan((math.nan, 0)), False),
        (scan((-math.inf, 0)), True),
        (scan((-math.inf, 180)), False),
        (scan((-1e30, 0)), False),
        (scan((1e30, 0)), False),
        (scan((0.4, 180), mount=Pose2D(0, 0, math.pi)), True),
        (scan((0.4, 0), mount=Pose2D(0.2, 0, 0)), False),
        (scan(), False),
        (None, False),
    ],
)
def test_only_what_is_ahead_and_near_is_in_the_way(seen, in_the_way) -> None:
    assert blocked(seen, 0.5, 0.3) is in_the_way
