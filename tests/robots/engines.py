"""A 2D simulator that a test gives to a body, and can reach by itself as well."""

from collections.abc import Callable

from wrapped_engine import WrappedEngine

from edgevox.robots.capabilities import Twist2D
from edgevox.robots.flat.apartment import ApartmentRobot, PymunkEngine
from edgevox.robots.flat.diff_drive import DiffDriveRobot
from edgevox.robots.flat.engine import Engine, MotionState
from edgevox.robots.flat.irsim import IrsimEngine, IrsimRobot
from edgevox.robots.world.model import World

ENGINES: dict[type[DiffDriveRobot], Callable[[World], Engine]] = {
    ApartmentRobot: PymunkEngine,
    IrsimRobot: IrsimEngine,
}
"""What each 2D body is simulated by."""


class MeddledEngine(WrappedEngine):
    """Does what the real engine does, but that each step goes through `meddle` once there is one.

    `meddle` is given the command and the real step.
    """

    def __init__(self, engine: Engine) -> None:
        super().__init__(engine)
        self.meddle: Callable[[Twist2D, Callable[[Twist2D], MotionState]], MotionState] | None = (
            None
        )

    def step(self, command: Twist2D) -> MotionState:
        if self.meddle:
            return self.meddle(command, super().step)
        return super().step(command)


def meddled(
    kind: type[DiffDriveRobot], world: World, speed: float | None
) -> tuple[DiffDriveRobot, MeddledEngine]:
    """A body like those of this kind, and the engine under it."""
    engine = MeddledEngine(ENGINES[kind](world))
    return DiffDriveRobot("robot", world, engine, speed=speed), engine
