"""`robot-apartment`: a robot on two wheels in a 2D apartment, simulated with pymunk."""

from edgevox.core.clock import Clock
from edgevox.robots.flat.diff_drive import DiffDriveRobot
from edgevox.robots.flat.pymunk_engine import PymunkEngine
from edgevox.robots.world.load import load_world
from edgevox.robots.world.model import World


class ApartmentRobot(DiffDriveRobot):
    """A `DiffDriveRobot` in pymunk, in the apartment or any other world.

    It is deterministic: the same world and the same requests give the same run. `load_world` and
    its seed decide the random parts of a world file.
    """

    def __init__(
        self, world: World | None = None, *, speed: float | None = 1.0, clock: Clock | None = None
    ) -> None:
        world = world or load_world()
        super().__init__("robot-apartment", world, PymunkEngine(world), speed=speed, clock=clock)
