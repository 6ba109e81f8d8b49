"""A stream of velocities that stops is counted if it left the robot moving."""

from edgevox.core.cancel import Cancelled
from edgevox.core.transforms import Pose2D
from edgevox.robots.apartment import ApartmentRobot
from edgevox.robots.capabilities import CountsHalts, Twist2D
from edgevox.robots.humanoid.pilot import WATCHDOG_S, Pilot
from edgevox.robots.humanoid.walker import Limits
from edgevox.robots.world import load_world

AHEAD, STILL = Twist2D(0.2, 0.0), Twist2D(0.0, 0.0)
AGES_S = 2 * WATCHDOG_S


def test_a_wheeled_robot_counts_streams_that_stopped_and_forgets_none_when_it_is_reset() -> None:
    with ApartmentRobot(load_world(), speed=0.0) as robot:
        assert isinstance(robot, CountsHalts)
        robot.set_velocity(AHEAD)
        robot.advance(AGES_S)
        assert robot.watchdog_halts == 1

        robot.set_velocity(AHEAD)
        robot.set_velocity(STILL)
        robot.advance(AGES_S)
        assert robot.watchdog_halts == 1, "it was asked to stand"

        robot.set_velocity(AHEAD)
        robot.halt("enough")
        robot.advance(AGES_S)
        assert robot.watchdog_halts == 1, "somebody else halted it"

        robot.reset()
        assert robot.watchdog_halts == 1
        robot.set_velocity(AHEAD)
        robot.advance(AGES_S)
        assert robot.watchdog_halts == 2


def test_a_walking_robot_counts_them_too() -> None:
    pilot, here = Pilot(Limits(0.5, 0.2, 0.5), 0.02), Pose2D(0.0, 0.0, 0.0)
    for twist in (AHEAD, STILL):
        pilot.take(twist, 0.0)
        pilot.command(AGES_S, here)
        pilot.command(AGES_S, here)
    assert pilot.watchdog_halts == 1

    pilot.take(AHEAD, 0.0)
    pilot.stand(Cancelled("enough"))
    pilot.command(AGES_S, here)
    assert pilot.watchdog_halts == 1
