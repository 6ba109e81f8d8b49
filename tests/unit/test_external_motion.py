"""What is concluded from odometry and scans: silence, standing, getting on, something ahead."""

import math

import numpy as np
import pytest

from edgevox.agent.skills import SkillFailed
from edgevox.robots.capabilities import LidarScan, Pose2D, Twist2D
from edgevox.ros2.external.drive import Watch
from edgevox.ros2.external.settings import Patience
from edgevox.ros2.external.sightings import Sighting, Sightings
from edgevox.ros2.external.steering import blocked

MIDDLE = Pose2D(0, 0, 0)


class HandClock:
    def __init__(self) -> None:
        self.time_s = 0.0

    def now(self) -> float:
        return self.time_s


@pytest.fixture
def clock() -> HandClock:
    return HandClock()


def see(sightings: Sightings, clock: HandClock, x_m: float = 0.0, speed_m_s: float = 0.0) -> bool:
    return sightings.add(
        Sighting(
            pose=Pose2D(x_m, 0.0, 0.0),
            twist=Twist2D(speed_m_s, 0.0),
            frame="odom",
            child_frame="base_link",
            stamp_ns=0,
            heard_s=clock.time_s,
        )
    )


def test_odometry_of_more_than_a_second_ago_is_no_position(clock) -> None:
    sightings = Sightings(clock)
    assert sightings.fresh() is None
    see(sightings, clock)
    clock.time_s = 1.0
    assert sightings.fresh() is not None
    clock.time_s = 1.1
    assert sightings.fresh() is None
    assert sightings.newest() is not None


@pytest.mark.parametrize("wrong", [math.nan, math.inf])
def test_odometry_that_is_no_number_is_not_taken(clock, wrong) -> None:
    sightings = Sightings(clock)

    assert not see(sightings, clock, x_m=wrong)
    assert not see(sightings, clock, speed_m_s=wrong)
    assert sightings.newest() is None


def test_a_robot_stands_when_it_was_seen_not_to_move_for_a_while(clock) -> None:
    sightings = Sightings(clock)
    see(sightings, clock, speed_m_s=0.3)
    for _ in range(3):
        clock.time_s += 0.1
        see(sightings, clock)
    assert not sightings.stands(0.0)
    clock.time_s += 0.15
    see(sightings, clock)
    assert sightings.stands(0.0)
    assert not sightings.stands(0.2)


def test_a_robot_that_does_not_tell_its_speed_stands_only_if_it_stays(clock) -> None:
    sightings = Sightings(clock)
    for step in range(20):
        clock.time_s += 0.1
        see(sightings, clock, x_m=0.02 * step)
    assert not sightings.stands(0.0)
    for _ in range(5):
        clock.time_s += 0.1
        see(sightings, clock, x_m=0.38)
    assert sightings.stands(0.0)


def test_a_silent_robot_is_not_seen_to_stand(clock) -> None:
    sightings = Sightings(clock)
    for _ in range(10):
        clock.time_s += 0.1
        see(sightings, clock)
    clock.time_s += 2.0
    assert not sightings.stands(0.0)


def watch() -> Watch:
    return Watch(Patience(unmoved_s=5.0, no_nearer_s=20.0), Pose2D(0, 0, 0), 4.0, 0.0)


def test_a_robot_that_does_not_move_has_failed_after_a_while() -> None:
    one = watch()
    one.look(5.0, Pose2D(0, 0, 0), 4.0)
    with pytest.raises(SkillFailed, match="the robot does not move, with 4.0 metres left"):
        one.look(5.1, Pose2D(0.01, 0, 0), 4.0)


def test_a_robot_that_turns_gets_on_but_not_for_ever() -> None:
    one = watch()
    for second in range(20):
        one.look(second, Pose2D(0, 0, second % 3), 4.0)
    with pytest.raises(SkillFailed, match="I am not getting closer, with 4.0 metres left"):
        one.look(20.5, Pose2D(0, 0, 2), 4.0)


def test_a_robot_that_comes_nearer_slowly_gets_on() -> None:
    one = watch()
    for second in range(60):
        one.look(second, Pose2D(0.05 * second, 0, 0), 4.0 - 0.05 * second)


def test_a_robot_that_waits_is_not_blamed_for_standing() -> None:
    one = watch()
    one.look(30.0, Pose2D(0, 0, 0), 4.0, waiting=True)
    one.look(34.0, Pose2D(0, 0, 0), 4.0)


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
        (scan((0.4, 180), mount=Pose2D(0, 0, math.pi)), True),
        (scan((0.4, 0), mount=Pose2D(0.2, 0, 0)), False),
        (scan(), False),
        (None, False),
    ],
)
def test_only_what_is_ahead_and_near_is_in_the_way(seen, in_the_way) -> None:
    assert blocked(seen, 0.5, 0.3) is in_the_way
