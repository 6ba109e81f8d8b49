"""The G1 walks in physics: as far as it is told, without falling, and stands when it is told."""

import random
from collections.abc import Iterator

import pytest
from humanoid_rig import along, apart, g1, stand, turn, turned_deg, walk, walking

from edgevox.core.cancel import Cancelled
from edgevox.core.errors import InvalidValue
from edgevox.core.transforms import Pose2D
from edgevox.models import locate
from edgevox.robots.capabilities import (
    DrivesTo,
    HasCamera,
    HasPicture,
    HasPose,
    TakesVelocity,
    Twist2D,
)
from edgevox.robots.humanoid import (
    HumanoidRobot,
    MujocoHumanoidEnvironment,
    OnnxWalkingPolicy,
    WalkingCommand,
)

SETTLE_S = 1.5


@pytest.fixture(scope="module")
def unitree() -> Iterator[HumanoidRobot]:
    with HumanoidRobot(g1(), speed=None) as robot:
        yield robot


@pytest.fixture
def robot(unitree) -> HumanoidRobot:
    unitree.reset()
    return unitree


@pytest.fixture
def held_g1(held) -> HumanoidRobot:
    """Its time stands still until it is told."""
    return held(HumanoidRobot, g1())


def stream(robot: HumanoidRobot, twist: Twist2D, seconds: float) -> None:
    for _ in range(round(seconds / 0.25)):
        robot.set_velocity(twist)
        robot.advance(0.25)


def test_half_a_metre_is_half_a_metre_wherever_it_looks(robot) -> None:
    for degrees in (0, 90, -45, 170, -20):
        turn(robot, degrees) if degrees else None
        before = robot.pose()

        walk(robot, 0.5)

        assert along(before, robot.pose()) == pytest.approx(0.5, abs=0.1)
        assert apart(before, robot.pose()) == pytest.approx(0.5, abs=0.1)


@pytest.mark.parametrize("distance_m", [0.1, 2.0, -0.5, -2.0])
def test_it_walks_as_far_as_it_is_told_and_stays_straight(robot, distance_m) -> None:
    before = robot.pose()

    walk(robot, distance_m)

    assert along(before, robot.pose()) == pytest.approx(distance_m, abs=0.1)
    assert abs(turned_deg(before, robot.pose())) < 5


@pytest.mark.parametrize("degrees", [90, -90, 180, 30, -15])
def test_a_turn_is_as_far_as_it_is_told_and_on_the_spot(robot, degrees) -> None:
    before = robot.pose()

    turn(robot, degrees)

    off = (turned_deg(before, robot.pose()) - degrees + 180) % 360 - 180
    assert abs(off) < 5
    assert apart(before, robot.pose()) < 0.15


def test_four_walks_and_four_turns_close_a_square_of_three_metres(robot) -> None:
    start, corners = robot.pose(), []
    for _ in range(4):
        walk(robot, 3.0)
        corners.append(robot.pose())
        turn(robot, 90)

    assert apart(start, robot.pose()) < 0.3
    assert apart(start, corners[1]) == pytest.approx(3 * 2**0.5, abs=0.3)
    assert abs(turned_deg(start, robot.pose())) < 5


@pytest.mark.parametrize("minutes", [1, pytest.param(10, marks=pytest.mark.long)])
def test_minutes_of_random_velocities_do_not_make_it_fall(robot, minutes) -> None:
    chance = random.Random(7)
    began_s = robot.time_s
    while robot.time_s < began_s + 60 * minutes:
        twist = Twist2D(chance.uniform(-1, 1), chance.uniform(-1.2, 1.2))
        stream(
            robot, twist if chance.random() < 0.85 else Twist2D(0, 0), chance.choice((0.5, 1, 3))
        )
        assert not robot.state()["fallen"]


def test_a_stream_of_velocities_is_followed_nearly_as_fast_as_asked(robot) -> None:
    stream(robot, Twist2D(0.4, 0.0), 1.0)
    before, from_s = robot.pose(), robot.time_s
    stream(robot, Twist2D(0.4, 0.0), 5.0)

    assert along(before, robot.pose()) / (robot.time_s - from_s) == pytest.approx(0.4, rel=0.2)


def test_a_stream_that_stops_makes_it_stand_after_half_a_second(robot) -> None:
    stream(robot, Twist2D(0.5, 0.0), 2.0)
    assert robot.state()["activity"] == "walking"

    robot.advance(0.5 + SETTLE_S)
    before = robot.pose()
    robot.advance(2.0)

    assert robot.state()["activity"] == "standing"
    assert apart(before, robot.pose()) < 0.03


def test_velocities_beyond_its_limits_are_clamped_and_nonsense_is_refused(robot) -> None:
    stream(robot, Twist2D(50.0, 0.0), 3.0)
    assert not robot.state()["fallen"]
    assert robot.velocity().linear_m_s < 1.0

    for twist in (Twist2D(float("nan"), 0.0), Twist2D(0.0, float("inf"))):
        with pytest.raises(InvalidValue, match="a finite number"):
            robot.set_velocity(twist)


@pytest.mark.parametrize(
    "after_s",
    [1.0, 1.3, *(pytest.param(one, marks=pytest.mark.long) for one in (1.1, 1.2, 1.4, 1.5))],
)
def test_halted_in_whatever_step_it_comes_to_a_stand_on_its_feet(held_g1, after_s) -> None:
    going = walking(held_g1, 5.0)
    held_g1.advance(after_s)

    assert held_g1.halt("the stop word")

    assert isinstance(going.ended(), Cancelled)
    held_g1.advance(SETTLE_S)
    before = held_g1.pose()
    held_g1.advance(2.0)
    assert held_g1.state()["activity"] == "standing"
    assert not held_g1.state()["fallen"]
    assert apart(before, held_g1.pose()) < 0.05
    assert not held_g1.halt("again")


class Listening(MujocoHumanoidEnvironment):
    """Knows what it was asked for last."""

    asked = WalkingCommand()

    def step(self, wanted: WalkingCommand) -> None:
        self.asked = wanted
        super().step(wanted)


def test_a_halt_asks_for_no_velocity_within_a_tenth_of_a_second(held) -> None:
    policy = OnnxWalkingPolicy(locate("g1-walking-policy"))
    environment = Listening(locate("unitree-g1"), policy)
    held_g1 = held(HumanoidRobot, environment)
    going = walking(held_g1, 5.0)
    held_g1.advance(3.0)
    fast = held_g1.velocity().linear_m_s

    going.token.cancel("never mind")
    held_g1.advance(0.1)

    assert fast > 0.4
    assert str(going.ended()) == "never mind"
    assert held_g1.state()["goal"] is None
    assert environment.asked.stands


def test_a_new_request_ends_the_one_before(held_g1) -> None:
    first = walking(held_g1, 3.0)
    held_g1.advance(0.5)
    second = walking(held_g1, 0.5)
    assert isinstance(first.ended(), Cancelled)

    held_g1.set_velocity(Twist2D(0.2, 0.0))
    assert str(second.ended()) == "somebody else steers"


def test_a_walk_tells_how_far_it_is(held_g1) -> None:
    going = walking(held_g1, 1.0)
    held_g1.advance(1.5)
    goal = held_g1.state()["goal"]

    assert going.end() is None
    assert goal["kind"] == "walk"
    assert 0.05 < goal["progress"] < 0.9
    assert goal["left"] == pytest.approx(1.0 - goal["progress"], abs=0.01)
    assert going.reports[-1]["progress"] > 0.9
    assert held_g1.state()["goal"] is None


def test_the_state_says_what_it_is_and_does(robot) -> None:
    state = robot.state()

    assert state["name"] == "robot-humanoid"
    assert state["simulation"] == "physics"
    assert "g1" in state["gait"]
    assert state["height"] == pytest.approx(0.76, abs=0.03)
    assert state["fallen"] is False
    assert state["activity"] == "standing"
    assert set(state["velocity"]) == {"linear", "angular"}


def test_it_offers_what_it_can_do_and_nothing_else(robot) -> None:
    for can in (HasPose, TakesVelocity, HasCamera, HasPicture):
        assert isinstance(robot, can)
    assert not isinstance(robot, DrivesTo)
    names = [skill.name for skill in robot.skills]
    for name in ("walk_forward", "walk_backward", "turn_left", "turn_right", "stand", "get_pose"):
        assert name in names


def test_the_same_seed_makes_the_same_walk_and_another_one_another() -> None:
    ends = []
    for seed in (1, 1, 2):
        with HumanoidRobot(g1(seed), speed=None) as robot:
            walk(robot, 0.5)
            ends.append(robot.pose())

    assert ends[0] == ends[1]
    assert ends[0] != ends[2]


def test_reset_puts_it_back_upright_at_the_start_and_time_goes_on(robot) -> None:
    walk(robot, 0.5)
    was_s = robot.time_s

    robot.reset()

    assert apart(robot.pose(), Pose2D(0, 0, 0)) < 1e-6
    assert robot.time_s >= was_s
    stand(robot)
    assert apart(robot.pose(), Pose2D(0, 0, 0)) < 0.05
