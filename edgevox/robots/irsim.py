"""`robot-irsim`: the same robot in the same apartment, simulated with IR-SIM."""

from edgevox.core.clock import Clock
from edgevox.robots.diff_drive import DiffDriveRobot
from edgevox.robots.irsim_engine import IrsimEngine
from edgevox.robots.world import load_world
from edgevox.robots.world_model import World


class IrsimRobot(DiffDriveRobot):
    """A `DiffDriveRobot` in IR-SIM, in the apartment or any other world.

    Walls are solid and furniture with a mass can be pushed, by IR-SIM's own law of contacts.
    IR-SIM's goals and behaviours are not used: the drives are ours. Nothing in it is random;
    what a world file leaves to chance is decided by `load_world` and its seed.
    Raises `EdgeVoxError` where IR-SIM is not installed.
    """

    def __init__(
        self, world: World | None = None, *, speed: float | None = 1.0, clock: Clock | None = None
    ) -> None:
        world = world or load_world()
        super().__init__("robot-irsim", world, IrsimEngine(world), speed=speed, clock=clock)
