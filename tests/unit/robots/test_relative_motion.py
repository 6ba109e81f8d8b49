"""Straight drives and turns by odometry alone, at 20 Hz, on wheels that answer late."""

import math
import random
from collections import deque

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from edgevox.agent.skills import SkillFailed
from edgevox.core.transforms import Pose2D
from edgevox.robots.capabilities import LidarScan, Twist2D
from edgevox.robots.command_mux import STILL, clamped
from edgevox.robots.relative_motion import (
    Caution,
    RelativeMotion,
    StraightCourse,
    TurnCourse,
    blocked,
    sees,
)
from edgevox.robots.world.model import RobotSpec

TICK_S = 0.05
LIMITS = RobotSpec(
    radius_m=0.3, start=Pose2D(0, 0, 0), max_linear_m_s=0.3, max_angular_rad_s=0.8,
    max_linear_m_s2=0.5, max_angular_rad_s2=2.0,
)  # fmt: skip
CAUTION = Caution(half_width_m=0.3, stop_ahead_m=0.5, wait_s=2.0, patience_s=3.0, sighted=False)


def scan(*seen: tuple[float, float], span_deg: float = 360.0, mount_deg: float = 0.0) -> LidarScan:
    """A lidar of one beam a degree over `span_deg`; `seen` are (metres, degrees) of its own."""
    beams = int(span_deg)
    ranges = np.full(beams, np.inf, np.float32)
    for range_m, degrees in seen:
        ranges[round(degrees + span_deg / 2) % beams] = range_m
    return LidarScan(
        time_s=0.0, angle_min_rad=-math.radians(span_deg) / 2,
        angle_increment_rad=math.radians(1.0), range_min_m=0.05, range_max_m=10.0, ranges_m=ranges,
        mount=Pose2D(0.0, 0.0, math.radians(mount_deg)),
    )  # fmt: skip


class LateWheels:
    """A robot that follows velocities a tenth of a second late, with odometry that is noisy."""

    def __init__(self, start: Pose2D, noise_m: float = 0.0, seed: int = 0) -> None:
        self.pose, self.twist = start, STILL
        self._noise_m, self._random = noise_m, random.Random(seed)
        self._asked = deque([STILL, STILL])

    def odometry(self) -> Pose2D:
        off = [self._random.uniform(-self._noise_m, self._noise_m) for _ in range(3)]
        return Pose2D(self.pose.x_m + off[0], self.pose.y_m + off[1], self.pose.yaw_rad + off[2])

    def follow(self, asked: Twist2D) -> None:
        self._asked.append(asked)
        wanted, now, at = self._asked.popleft(), self.twist, self.pose
        linear = now.linear_m_s + clamped(wanted.linear_m_s - now.linear_m_s, 0.5 * TICK_S)
        angular = now.angular_rad_s + clamped(wanted.angular_rad_s - now.angular_rad_s, 2 * TICK_S)
        self.twist = Twist2D(linear, angular)
        yaw = at.yaw_rad + angular * TICK_S
        along = linear * TICK_S
        self.pose = Pose2D(
            at.x_m + along * math.cos(yaw), at.y_m + along * math.sin(yaw),
            math.remainder(yaw, math.tau),
        )  # fmt: skip


def carried_out(wheels: LateWheels, motion: RelativeMotion) -> float:
    """Let it go on until it is over; the seconds that it took."""
    ticks = 0
    while not motion.done:
        wheels.follow(motion.go_on(ticks * TICK_S, wheels.odometry(), wheels.twist))
        ticks += 1
    return ticks * TICK_S


@settings(deadline=None, max_examples=40)
@given(
    distance=st.floats(0.05, 6.0),
    back=st.booleans(),
    yaw=st.floats(-math.pi, math.pi),
    noise_m=st.sampled_from([0.0, 0.003]),
    seed=st.integers(0, 99),
)
def test_a_straight_drive_ends_where_it_should_whichever_way_it_looks(
    distance, back, yaw, noise_m, seed
) -> None:
    start = Pose2D(3.0, -2.0, yaw)
    wheels = LateWheels(start, noise_m, seed)
    course = StraightCourse(start, -distance if back else distance, LIMITS)

    motion = RelativeMotion(course, CAUTION, scan, 0.0)
    carried_out(wheels, motion)

    goal = course.goal
    assert math.hypot(wheels.pose.x_m - goal.x_m, wheels.pose.y_m - goal.y_m) < 0.04
    assert abs(math.remainder(wheels.pose.yaw_rad - yaw, math.tau)) < 0.1
    assert motion.progress().part == 1.0


@settings(deadline=None, max_examples=40)
@given(degrees=st.floats(1.0, 720.0), left=st.booleans(), yaw=st.floats(-math.pi, math.pi))
def test_a_turn_of_any_size_goes_all_the_way_round(degrees, left, yaw) -> None:
    start = Pose2D(0.0, 0.0, yaw)
    wheels, angle = LateWheels(start), math.radians(degrees if left else -degrees)

    took_s = carried_out(
        wheels, RelativeMotion(TurnCourse(start, angle, LIMITS), CAUTION, lambda: None, 0.0)
    )

    assert abs(math.remainder(wheels.pose.yaw_rad - yaw - angle, math.tau)) < 0.05
    assert took_s > abs(angle) / LIMITS.max_angular_rad_s - 0.1, "all of it, not the rest of it"


@pytest.mark.parametrize(("distance", "degrees"), [(4.0, 0.0), (-4.0, 180.0)])
def test_it_stands_before_what_appears_in_its_way(distance, degrees) -> None:
    start = Pose2D(0.0, 0.0, 0.0)
    wheels = LateWheels(start)

    def seen() -> LidarScan:
        left = 2.0 - abs(wheels.pose.x_m)
        return scan((left, degrees)) if abs(wheels.pose.x_m) > 1.0 else scan()

    motion = RelativeMotion(StraightCourse(start, distance, LIMITS), CAUTION, seen, 0.0)
    with pytest.raises(SkillFailed) as failed:
        carried_out(wheels, motion)

    assert failed.value.reason.code == "in_my_way"
    assert wheels.twist.linear_m_s == 0.0
    assert 1.45 < abs(wheels.pose.x_m) < 1.7


def test_a_lidar_that_falls_silent_on_the_way_back_ends_it() -> None:
    start = Pose2D(0.0, 0.0, 0.0)
    wheels = LateWheels(start)
    motion = RelativeMotion(
        StraightCourse(start, -2.0, LIMITS), CAUTION,
        lambda: scan() if wheels.pose.x_m > -0.5 else None, 0.0,
    )  # fmt: skip

    with pytest.raises(SkillFailed) as failed:
        carried_out(wheels, motion)

    assert failed.value.reason.code == "blind_behind"


@pytest.mark.parametrize(
    ("seen", "ahead", "behind"),
    [
        (scan(), True, True),
        (scan(span_deg=180), True, False),
        (scan(span_deg=180, mount_deg=180), False, True),
        (scan(span_deg=40), False, False),
        (scan(*((math.nan, degrees) for degrees in range(-180, -140))), True, False),
        (scan(*((0.01, degrees) for degrees in range(20))), False, True),
        (scan((math.nan, 0), (math.nan, 180)), True, True),
        (scan((2.0, 0), (-math.inf, 180)), True, True),
        (None, False, False),
    ],
)
def test_a_way_is_seen_where_the_beams_cover_it(seen, ahead, behind) -> None:
    assert sees(seen) is ahead
    assert sees(seen, behind=True) is behind


@pytest.mark.parametrize(
    ("seen", "in_the_way"),
    [
        (scan((0.4, 180)), True),
        (scan((0.4, 0)), False),
        (scan((0.6, 180)), False),
        (scan((0.4, 90)), False),
        (scan((0.4, 0), mount_deg=180), True),
    ],
)
def test_what_is_behind_is_in_the_way_back(seen, in_the_way) -> None:
    assert blocked(seen, 0.5, 0.3, behind=True) is in_the_way
