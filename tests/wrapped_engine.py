"""A 2D simulator that passes everything on to another one, for what comes between them."""

from collections.abc import Sequence

from edgevox.core.transforms import Pose2D
from edgevox.robots.capabilities import LidarScan, Twist2D
from edgevox.robots.flat.engine import Engine, MotionState


class WrappedEngine:
    """Does what the engine under it does."""

    def __init__(self, engine: Engine) -> None:
        self._engine = engine

    def step(self, command: Twist2D) -> MotionState:
        return self._engine.step(command)

    def motion(self) -> MotionState:
        return self._engine.motion()

    @property
    def still(self) -> bool:
        return self._engine.still

    def movable_poses(self) -> tuple[Pose2D, ...]:
        return self._engine.movable_poses()

    def scan(self, time_s: float) -> LidarScan:
        return self._engine.scan(time_s)

    def put(self, robot: Pose2D, movable: Sequence[Pose2D]) -> None:
        self._engine.put(robot, movable)
