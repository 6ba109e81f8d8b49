"""Footsteps, speeds that rise evenly, and walks that end: without any simulator."""

import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from edgevox.agent.skills import SkillFailed
from edgevox.core.errors import InvalidValue
from edgevox.core.transforms import Pose2D
from edgevox.robots.humanoid.environment import RISE_M_S2, eased
from edgevox.robots.humanoid.gait import LIFT_M, FootstepPlanner, ahead
from edgevox.robots.humanoid.walk_control import PATIENCE_S, MotionPrimitive
from edgevox.robots.humanoid.walker import WalkerLimits
from edgevox.robots.humanoid.walking_policy import STAND, WalkingCommand, WalkingPlan

PERIOD_S = 0.02
LIMITS = WalkerLimits(0.6, 0.3, 0.9, settle_s=0.1)
START = Pose2D(1.0, -2.0, 0.7)
HOMES = (Pose2D(0.0, 0.1, 0.0), Pose2D(0.0, -0.1, 0.0))
speeds = st.floats(-0.6, 0.6)


@settings(max_examples=30, deadline=None)
@given(speeds, st.floats(-0.9, 0.9))
def test_of_two_feet_at_least_one_stands_and_what_stands_stays(forward, turn) -> None:
    base, steps = START, FootstepPlanner(HOMES, START)
    velocity = WalkingCommand(forward, 0.0, turn)
    for _ in range(120):
        before = steps.feet[:]
        base = ahead(base, velocity, PERIOD_S)
        steps.advance(PERIOD_S, base, velocity)
        standing = [number for number in (0, 1) if steps.feet[number].swing is None]
        assert standing
        for number in standing:
            assert steps.feet[number].height_m == 0.0
            if before[number].swing is None:
                assert steps.feet[number].place == before[number].place
        assert all(0.0 <= foot.height_m <= LIFT_M for foot in steps.feet)


@settings(max_examples=30, deadline=None)
@given(speeds, st.floats(-0.9, 0.9), st.integers(1, 100))
def test_when_the_base_stands_the_feet_come_home_and_rest(forward, turn, ticks) -> None:
    base, steps = START, FootstepPlanner(HOMES, START)
    velocity = WalkingCommand(forward, 0.0, turn)
    for _ in range(ticks):
        base = ahead(base, velocity, PERIOD_S)
        steps.advance(PERIOD_S, base, velocity)
    for _ in range(100):
        steps.advance(PERIOD_S, base, STAND)

    assert not steps.stepping
    assert steps.phase == 0.0
    middle_x = sum(foot.place.x_m for foot in steps.feet) / 2
    assert middle_x == pytest.approx(base.x_m, abs=2e-3)


def test_a_quarter_circle_ends_where_it_should() -> None:
    end = ahead(Pose2D(0.0, 0.0, 0.0), WalkingCommand(math.pi / 2, 0.0, math.pi / 2), 1.0)

    assert (end.x_m, end.y_m, end.yaw_rad) == pytest.approx((1.0, 1.0, math.pi / 2))


@given(speeds, speeds)
def test_a_speed_rises_evenly_and_falls_at_once(now, wanted) -> None:
    after = eased(WalkingCommand(now), WalkingCommand(wanted), 0.1).forward_m_s

    assert abs(after) <= abs(wanted) + 1e-12
    assert abs(after) <= abs(now) + RISE_M_S2 * 0.1 + 1e-12
    assert after * wanted >= 0.0
    if now * wanted >= 0 and abs(wanted) <= abs(now):
        assert after == wanted


@settings(max_examples=40, deadline=None)
@given(st.floats(-5.0, 5.0).filter(lambda metres: abs(metres) >= 0.05))
def test_a_walk_of_an_obedient_robot_ends_exactly_where_it_should(distance_m) -> None:
    pose, motion = START, MotionPrimitive(START, LIMITS, PERIOD_S, distance_m=distance_m)
    fastest = 0.0
    for _ in range(3000):
        command = motion.steer(pose)
        fastest = max(fastest, abs(command.forward_m_s))
        pose = ahead(pose, command, PERIOD_S)
        if motion.done:
            break

    assert motion.error is None
    assert fastest <= LIMITS.forward_m_s
    assert pose.x_m == pytest.approx(START.x_m + distance_m * math.cos(0.7), abs=1e-5)
    assert pose.y_m == pytest.approx(START.y_m + distance_m * math.sin(0.7), abs=1e-5)
    assert motion.progress().part == pytest.approx(1.0, abs=1e-5 / abs(distance_m))


@pytest.mark.parametrize("degrees", [1, 90, -180, 360, -720])
def test_a_turn_goes_all_the_way_round(degrees) -> None:
    pose, turned = START, 0.0
    motion = MotionPrimitive(START, LIMITS, PERIOD_S, angle_rad=math.radians(degrees))
    while not motion.done:
        command = motion.steer(pose)
        turned += command.turn_rad_s * PERIOD_S
        after = ahead(pose, command, PERIOD_S)
        pose = Pose2D(after.x_m, after.y_m, math.remainder(after.yaw_rad, math.tau))

    assert math.degrees(turned) == pytest.approx(degrees, abs=0.01)


def test_a_robot_that_does_not_get_on_says_so() -> None:
    motion = MotionPrimitive(START, LIMITS, PERIOD_S, distance_m=2.0)
    for _ in range(round(2 * PATIENCE_S / PERIOD_S)):
        motion.steer(START)

    assert isinstance(motion.error, SkillFailed)
    assert motion.error.reason.code == "no_further"


def test_a_plan_whose_vectors_or_rates_do_not_fit_is_refused() -> None:
    import numpy as np

    two, three = np.zeros(2), np.zeros(3)
    with pytest.raises(InvalidValue, match=r"damping: got \(3,\), expected a vector of shape \(2,"):
        WalkingPlan(("a", "b"), two, two, three, two)
    with pytest.raises(InvalidValue, match="period_s: got 0.021, expected a whole multiple"):
        WalkingPlan(("a", "b"), two, two, two, two, period_s=0.021)
