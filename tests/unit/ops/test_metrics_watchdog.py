"""A stream of velocities that stops is counted if it left the robot moving."""

from edgevox.robots.capabilities import CountsHalts, Twist2D
from edgevox.robots.command_mux import WATCHDOG_S
from edgevox.robots.flat.apartment import ApartmentRobot
from edgevox.robots.world.load import load_world

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
