"""`robot-apartment`: a robot on two wheels in a 2D apartment, simulated with pymunk.

`PymunkEngine` has a driven robot, solid walls, and furniture that slides when pushed. Wheels and
friction are joints with a limited force, as pymunk asks for in a view from above: one joint pulls
the robot to the velocity of a kinematic body that follows the command, one pulls each movable thing
to rest. So contacts win over the command and nothing sinks into a wall. No joint corrects a
position (`max_bias` is 0), so it does not matter where that kinematic body is. Not safe to use from
two threads at a time.

`Lidar` is a 2D lidar by ray casting, all beams against all sides at once in NumPy.
"""

import math
from collections.abc import Iterable, Sequence

import numpy as np
import pymunk
from numpy.typing import NDArray

from edgevox.core.clock import Clock
from edgevox.core.transforms import Pose2D, rotate, to_map
from edgevox.robots.capabilities import LidarScan, Twist2D
from edgevox.robots.flat.diff_drive import DiffDriveRobot
from edgevox.robots.flat.engine import BRAKE_M_S2, STEP_S, STILL_M_S, MotionState
from edgevox.robots.shapes import (
    Circle,
    Floats,
    Line,
    Polygon,
    Shape,
    edges,
    is_convex,
    place,
    reach,
)
from edgevox.robots.world.load import load_world
from edgevox.robots.world.model import Thing, World

_PARALLEL = 1e-12


def cast(
    origin: tuple[float, float], angles_rad: Floats, segments: Floats, discs: Floats
) -> Floats:
    """Return the lengths of rays up to the first hit, (n,); infinite without one.

    `angles_rad` (n,) in the frame of the others; `segments` (m, 4) as x1, y1, x2, y2; `discs` (k,
    3) as x, y, radius. A ray that starts inside a disc hits its far side.
    """
    rays = np.stack([np.cos(angles_rad), np.sin(angles_rad)], axis=1)
    return np.minimum(_to_segments(origin, rays, segments), _to_discs(origin, rays, discs))


class Lidar:
    """The scanner of one world: what stands still is prepared once."""

    def __init__(self, world: World) -> None:
        self._spec = world.robot.lidar
        self._movable = world.movable
        segments, discs = _outlines((t, t.pose) for t in world.fixed)
        self._segments, self._discs = np.vstack([world.border, segments]), discs
        first_rad = -self._spec.angle_range_rad / 2
        numbers = np.arange(self._spec.beams, dtype=np.float64)
        self._angles: Floats = first_rad + self._spec.increment_rad * numbers

    def scan(self, time_s: float, robot: Pose2D, movable: Sequence[Pose2D]) -> LidarScan:
        """Return a sweep from these poses of the robot and the pushable things."""
        segments, discs = _outlines(zip(self._movable, movable, strict=True))
        x, y = to_map((self._spec.mount.x_m, self._spec.mount.y_m), robot)
        far = cast(
            (x, y),
            self._angles + robot.yaw_rad + self._spec.mount.yaw_rad,
            np.vstack([self._segments, segments]),
            np.vstack([self._discs, discs]),
        )
        far = np.where(
            far > self._spec.range_max_m, np.inf, np.maximum(far, self._spec.range_min_m)
        )
        return LidarScan(
            time_s=time_s,
            angle_min_rad=-self._spec.angle_range_rad / 2,
            angle_increment_rad=self._spec.increment_rad,
            range_min_m=self._spec.range_min_m,
            range_max_m=self._spec.range_max_m,
            ranges_m=far.astype(np.float32),
            mount=self._spec.mount,
        )


def _outlines(things: Iterable[tuple[Thing, Pose2D]]) -> tuple[Floats, Floats]:
    sides: list[Floats] = [np.empty((0, 4))]
    discs: list[tuple[float, float, float]] = []
    for thing, pose in things:
        for part in thing.parts:
            placed: Shape = place(part, pose)
            if isinstance(placed, Circle):
                discs.append((*placed.center, placed.radius_m))
            else:
                sides.append(edges(placed))
    return np.vstack(sides), np.array(discs, dtype=np.float64).reshape(-1, 3)


def _to_segments(origin: tuple[float, float], rays: Floats, segments: Floats) -> Floats:
    start = segments[:, :2] - origin
    side = segments[:, 2:] - segments[:, :2]
    across = rays[:, :1] * side[:, 1] - rays[:, 1:] * side[:, 0]
    parallel = np.abs(across) < _PARALLEL
    across[parallel] = 1.0
    far = (start[:, 0] * side[:, 1] - start[:, 1] * side[:, 0]) / across
    along = (rays[:, 1:] * start[:, 0] - rays[:, :1] * start[:, 1]) / across
    miss = parallel | (far < 0.0) | (along < 0.0) | (along > 1.0)
    far[miss] = np.inf
    return _nearest(far)


def _to_discs(origin: tuple[float, float], rays: Floats, discs: Floats) -> Floats:
    center = discs[:, :2] - origin
    toward = rays @ center.T
    short = discs[:, 2] ** 2 - (np.sum(center**2, axis=1) - toward**2)
    half = np.sqrt(np.maximum(short, 0.0))
    near, far = toward - half, toward + half
    hit = np.where(near >= 0.0, near, far)
    hit[(short < 0.0) | (far < 0.0)] = np.inf
    return _nearest(hit)


def _nearest(distances: NDArray[np.float64]) -> Floats:
    nearest: Floats = distances.min(axis=1, initial=math.inf)
    return nearest


_SUBSTEPS = 2
_ITERATIONS = 15
_GRAVITY_M_S2 = 9.81
_LINE_RADIUS_M = 0.005
_NOTHING: frozenset[str] = frozenset()


class PymunkEngine:
    """An `Engine` in pymunk; the lidar is our own."""

    def __init__(self, world: World) -> None:
        self._world = world
        self._lidar = Lidar(world)
        self._build(world.robot.start, [thing.pose for thing in world.movable])

    def put(self, robot: Pose2D, movable: Sequence[Pose2D]) -> None:
        """Build a new space: nothing of the old one is left, however it broke."""
        self._build(robot, movable)

    def _build(self, robot: Pose2D, movable: Sequence[Pose2D]) -> None:
        world = self._world
        self._space = pymunk.Space()
        self._space.iterations = _ITERATIONS
        self._names: dict[pymunk.Shape, str] = {}
        for thing in world.fixed:
            self._add_fixed(thing)
        for x1, y1, x2, y2 in world.border:
            self._add_solid(
                pymunk.Segment(self._space.static_body, (x1, y1), (x2, y2), 0.0), "edge"
            )
        self._movable = [
            self._add_movable(thing, pose)
            for thing, pose in zip(world.movable, movable, strict=True)
        ]
        self._robot = self._add_robot(world, robot)
        self._wheels = self._add_wheels(world)

    def step(self, command: Twist2D) -> MotionState:
        robot, wheels, space = self._robot, self._wheels, self._space
        wheels.angular_velocity = command.angular_rad_s
        for _ in range(_SUBSTEPS):
            wheels.velocity = rotate(command.linear_m_s, 0.0, robot.angle)
            space.step(STEP_S / _SUBSTEPS)
        return self.motion()

    def motion(self) -> MotionState:
        robot = self._robot
        x, y = robot.position
        vx, vy = robot.velocity
        yaw_rad = robot.angle
        ahead_m_s, _ = rotate(vx, vy, -yaw_rad)
        return MotionState(
            Pose2D(x, y, math.remainder(yaw_rad, math.tau)),
            Twist2D(ahead_m_s, robot.angular_velocity),
            self._touching(),
        )

    @property
    def still(self) -> bool:
        return all(
            body.velocity.length < STILL_M_S and abs(body.angular_velocity) < STILL_M_S
            for body in (self._robot, *self._movable)
        )

    def movable_poses(self) -> tuple[Pose2D, ...]:
        return tuple(_pose(body) for body in self._movable)

    def scan(self, time_s: float) -> LidarScan:
        return self._lidar.scan(time_s, _pose(self._robot), self.movable_poses())

    def _touching(self) -> frozenset[str]:
        names: set[str] = set()
        self._robot.each_arbiter(self._note, names)
        return frozenset(names) if names else _NOTHING

    def _note(self, arbiter: pymunk.Arbiter, names: set[str]) -> None:
        names.update(self._names[s] for s in arbiter.shapes if s in self._names)

    def _add_fixed(self, thing: Thing) -> None:
        for part in thing.parts:
            for shape in _solid(self._space.static_body, place(part, thing.pose)):
                self._add_solid(shape, thing.name)

    def _add_solid(self, shape: pymunk.Shape, name: str) -> None:
        shape.friction = 0.3
        self._names[shape] = name
        self._space.add(shape)

    def _add_movable(self, thing: Thing, pose: Pose2D) -> pymunk.Body:
        body = pymunk.Body()
        body.position = (pose.x_m, pose.y_m)
        body.angle = pose.yaw_rad
        self._space.add(body)
        for part in thing.parts:
            for shape in _solid(body, part):
                shape.mass = thing.mass_kg / len(thing.parts)
                self._add_solid(shape, thing.name)
        grip_n = thing.friction * thing.mass_kg * _GRAVITY_M_S2
        slide = pymunk.PivotJoint(self._space.static_body, body, (0, 0), body.center_of_gravity)
        turn = pymunk.GearJoint(self._space.static_body, body, 0.0, 1.0)
        self._add_joints(slide, grip_n, turn, grip_n * reach(thing.parts) * 2 / 3)
        return body

    def _add_robot(self, world: World, pose: Pose2D) -> pymunk.Body:
        spec = world.robot
        body = pymunk.Body(spec.mass_kg, pymunk.moment_for_circle(spec.mass_kg, 0.0, spec.radius_m))
        body.position = (pose.x_m, pose.y_m)
        body.angle = pose.yaw_rad
        disc = pymunk.Circle(body, spec.radius_m)
        disc.friction = 0.1
        self._space.add(body, disc)
        return body

    def _add_wheels(self, world: World) -> pymunk.Body:
        wheels = pymunk.Body(body_type=pymunk.Body.KINEMATIC)
        self._space.add(wheels)
        force_n = world.robot.mass_kg * BRAKE_M_S2 * 1.25
        drive = pymunk.PivotJoint(wheels, self._robot, (0, 0), (0, 0))
        turn = pymunk.GearJoint(wheels, self._robot, 0.0, 1.0)
        self._add_joints(drive, force_n, turn, force_n * world.robot.radius_m * 3)
        return wheels

    def _add_joints(
        self, slide: pymunk.Constraint, force_n: float, turn: pymunk.Constraint, torque_nm: float
    ) -> None:
        slide.max_force, turn.max_force = force_n, torque_nm
        for joint in (slide, turn):
            joint.max_bias = 0.0
            self._space.add(joint)


def _solid(body: pymunk.Body, shape: Shape) -> list[pymunk.Shape]:
    match shape:
        case Circle(center, radius_m):
            return [pymunk.Circle(body, radius_m, center)]
        case Polygon(vertices) if is_convex(shape):
            return [pymunk.Poly(body, vertices)]
        case Polygon() | Line():
            return [
                pymunk.Segment(body, (x1, y1), (x2, y2), _LINE_RADIUS_M)
                for x1, y1, x2, y2 in edges(shape)
            ]


def _pose(body: pymunk.Body) -> Pose2D:
    x, y = body.position
    return Pose2D(x, y, math.remainder(body.angle, math.tau))


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
