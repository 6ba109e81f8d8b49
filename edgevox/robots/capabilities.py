"""What a body can do, as small protocols. The ROS 2 adapter offers exactly those that a body has.

Units and frames: metres, radians, seconds; REP 103 axes (x forward, y left, z up, counter-clockwise
positive); poses in the ``map`` frame, whose x is east and y is north (REP 105). All methods may be
called from any thread.
"""

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from math import isfinite
from typing import Any, Literal, Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from edgevox.agent.known import StateCondition
from edgevox.agent.skills import Skill, SkillFailed
from edgevox.core.cancel import CancelToken
from edgevox.core.reason import Reason
from edgevox.core.transforms import IDENTITY, ORIGIN, Pose2D, Pose3D, to_map
from edgevox.robots.places.memory import PlaceMemory
from edgevox.robots.shapes import Point

UNKNOWN, FREE, OCCUPIED = 0, 1, 2
"""The larger one wins where several cells become one: no wall is lost."""


@dataclass(frozen=True, slots=True, eq=False)
class OccupancyMap:
    """A grid in the map frame."""

    cells: NDArray[np.uint8]
    """Shape (rows, columns), row 0 at the lower edge."""
    resolution_m: float
    """The width of a cell."""
    origin: Pose2D
    """The lower left corner of cell (0, 0), map frame; rows run along its x axis."""

    def cropped(self) -> "OccupancyMap":
        """Return the known part; a map without cells if nothing is known."""
        rows = np.flatnonzero(self.cells.any(axis=1))
        columns = np.flatnonzero(self.cells.any(axis=0))
        if not len(rows):
            return replace(self, cells=self.cells[:0, :0])
        cells = self.cells[rows[0] : rows[-1] + 1, columns[0] : columns[-1] + 1]
        corner = int(columns[0]) * self.resolution_m, int(rows[0]) * self.resolution_m
        origin = Pose2D(*to_map(corner, self.origin), self.origin.yaw_rad)
        return replace(self, cells=cells, origin=origin)

    def reduced(self, most_cells: int) -> "OccupancyMap":
        """Return a map with at most this many cells along each side, merging cells as needed."""
        every = -(-max(self.cells.shape) // most_cells)
        if every <= 1:
            return self
        rows, columns = self.cells.shape
        padded = np.pad(self.cells, ((0, -rows % every), (0, -columns % every)))
        high, wide = padded.shape[0] // every, padded.shape[1] // every
        cells = padded.reshape(high, every, wide, every).max(axis=(1, 3))
        return replace(self, cells=cells, resolution_m=self.resolution_m * every)

    def corners(self) -> list[Point]:
        """Return the four corners, metres, map frame."""
        high, wide = (cells * self.resolution_m for cells in self.cells.shape)
        ends = ((0.0, 0.0), (wide, 0.0), (wide, high), (0.0, high))
        return [to_map(end, self.origin) for end in ends]


@dataclass(frozen=True, slots=True)
class Twist2D:
    """Forward speed (m/s) and turn rate (rad/s, counter-clockwise) in the body's own frame."""

    linear_m_s: float
    angular_rad_s: float

    @property
    def finite(self) -> bool:
        """Whether both numbers are."""
        return isfinite(self.linear_m_s) and isfinite(self.angular_rad_s)


@dataclass(frozen=True, slots=True)
class LidarScan:
    """One sweep: `ranges_m` of shape (n,), from `angle_min_rad` in steps of `angle_increment_rad`.

    A beam that hits nothing within `range_max_m` is infinite. `time_s` is the body's time. Angles
    are those of the lidar's own frame, which sits at `mount` on the body and does not move there.
    """

    time_s: float
    angle_min_rad: float
    angle_increment_rad: float
    range_min_m: float
    range_max_m: float
    ranges_m: NDArray[np.float32]
    mount: Pose2D = ORIGIN

    def ends(self, ranges_m: NDArray[np.floating]) -> NDArray[np.float64]:
        """Where its beams would end if they were so long, (n, 2) metres, in the body's frame."""
        angles = self.angle_min_rad + self.angle_increment_rad * np.arange(len(ranges_m))
        angles += self.mount.yaw_rad
        ahead = self.mount.x_m + ranges_m * np.cos(angles)
        return np.stack([ahead, self.mount.y_m + ranges_m * np.sin(angles)], axis=1)


@dataclass(frozen=True, slots=True)
class CameraSpec:
    """A pinhole camera with square pixels and no distortion, looking along its own x axis.

    `mount` is where it sits in `parent` and does not change: on the body, on the end effector, or
    standing in the room.
    """

    width_px: int
    height_px: int
    vertical_fov_rad: float
    mount: Pose3D = IDENTITY
    parent: Literal["body", "end_effector", "map"] = "body"


@dataclass(frozen=True, slots=True)
class CameraImage:
    """One picture: `pixels` of shape (height, width, 3), RGB, taken at the body's time `time_s`."""

    time_s: float
    pixels: NDArray[np.uint8]


Report = Callable[..., None]
"""Feedback of a running goal, as keyword arguments; `GoalHandle.report` is one."""


class Body(Protocol):
    """Whatever moves."""

    name: str

    @property
    def skills(self) -> tuple[Skill, ...]:
        """What it can be asked to do."""

    @property
    def time_s(self) -> float:
        """The body's own time."""

    def state(self) -> Mapping[str, Any]:
        """A JSON-ready snapshot: what the `robot_state` topic carries."""

    def halt(self, reason: str) -> bool:
        """Stop all motion now, whoever asked for it. True if anything was moving or driving."""

    def reset(self) -> None:
        """Back to how the world was at the start."""

    def start(self) -> None: ...

    def close(self) -> None: ...


@runtime_checkable
class HasPose(Protocol):
    """Knows where it is and how it moves: `/tf`, `pose`, `odom`."""

    def pose(self) -> Pose2D: ...

    def velocity(self) -> Twist2D: ...


@runtime_checkable
class TakesVelocity(Protocol):
    """Follows `cmd_vel`, a stream of velocities; halts when the stream stops for 0.5 s."""

    max_linear_m_s: float
    max_angular_rad_s: float

    def set_velocity(self, twist: Twist2D) -> None:
        """Clamp to the limits and follow. Raises `InvalidValue` if not finite. Ends a drive."""


SpeedLimit = Callable[[Twist2D], Twist2D]
"""What of a velocity may be asked for: it, or a slower one. Quick; what it answers may change."""


@runtime_checkable
class LimitsSpeed(Protocol):
    """Keeps to the speed limit of a policy when it drives by itself."""

    def limit_speed(self, limit: SpeedLimit) -> None:
        """From now on, steer drives by no velocity but what this permits."""


@runtime_checkable
class AvoidsPlaces(Protocol):
    """Plans its own ways, and none through a place that a policy forbids."""

    def avoid_places(self, forbidden: Callable[[], Collection[str]]) -> None:
        """From now on, drive round the places that this names; it is asked again and again."""


@runtime_checkable
class CountsHalts(Protocol):
    """Counts the halts by its watchdog, for the metrics."""

    @property
    def watchdog_halts(self) -> int:
        """So often it was halted for it."""


@runtime_checkable
class DrivesTo(Protocol):
    """Plans and drives to a point by itself: `goal_pose`."""

    def drive_to(self, x_m: float, y_m: float, *, token: CancelToken, report: Report) -> None:
        """Block until there. Raises `SkillFailed` with a reason, `Cancelled` if the token is."""


@runtime_checkable
class ChecksGoals(Protocol):
    """Rejects a goal outside of its world at once."""

    def check_goal(self, x_m: float, y_m: float) -> None:
        """Raise `SkillFailed` with the reason. Quick, and nothing happens."""


@runtime_checkable
class TellsAbout(Protocol):
    """Tells the language model its name and its purpose."""

    @property
    def about(self) -> str:
        """Sentences for people and for the language model; may be empty."""


@runtime_checkable
class HasPlaces(Protocol):
    """Knows places by name: "go to the press", "where are you"."""

    @property
    def places(self) -> Mapping[str, tuple[float, float]]:
        """Name to (x, y), metres, map frame."""

    def place_at(self, x_m: float, y_m: float) -> str | None:
        """The place that this point is in."""


@runtime_checkable
class KnowsFrame(Protocol):
    """Has poses in the frame of a map, or in that of odometry while there is none."""

    def located(self) -> tuple[Pose2D, str]:
        """Where it is, and in which frame. Raises `SkillFailed` while that is unknown."""


@runtime_checkable
class RemembersPlaces(Protocol):
    """Can be told what a place is called. A file is opened before the body is started, if any."""

    @property
    def place_memory(self) -> PlaceMemory:
        """What it remembers; `navigation_skills` makes the skills of it."""


@runtime_checkable
class HasLidar(Protocol):
    """Measures distances all around: `scan`, and its frame on `/tf_static`."""

    def scan(self) -> LidarScan: ...


@runtime_checkable
class HasEndEffector(Protocol):
    """Has a hand whose place it knows: `ee_link` on `/tf`."""

    def end_effector(self) -> Pose3D:
        """The hand in the map frame."""


@runtime_checkable
class HasCamera(Protocol):
    """Has a camera: `image_raw`, `camera_info`."""

    @property
    def camera_spec(self) -> CameraSpec:
        """What the camera is and where it sits; it stays so."""

    def camera(self) -> CameraImage:
        """Take a picture. May take long (rendering), so call it from one thread of your own."""


@runtime_checkable
class ReceivesPictures(Protocol):
    """Receives the pictures of a camera outside EdgeVox, for the console."""

    def newest_picture(self) -> NDArray[np.uint8] | None:
        """Shape (height, width, 3), RGB; None if none came in the last second.

        Raises `InvalidValue` for one that cannot be shown.
        """


@runtime_checkable
class ReceivesMap(Protocol):
    """Receives a map from outside EdgeVox, for the console."""

    def newest_map(self) -> OccupancyMap | None:
        """In the frame of its pose; None while there is none. May take long where it is another.

        Until then its `cells` are the same array.
        """


@runtime_checkable
class HasPicture(Protocol):
    """Draws itself in its surroundings, for `--snapshot` and the window."""

    def picture(self) -> NDArray[np.uint8]:
        """The scene as it is now, shape (height, width, 3), RGB."""


@runtime_checkable
class Advances(Protocol):
    """Lets its time pass faster than real time, for scenarios."""

    def advance(self, seconds: float) -> None:
        """Block until this much of the body's time has passed, or it is closed."""


@runtime_checkable
class TellsMotions(Protocol):
    """Knows whether it carries out a motion for a goal, which then waits for nothing but time."""

    @property
    def in_motion(self) -> bool:
        """Whether it does."""


@runtime_checkable
class HasBattery(Protocol):
    """Knows its charge: "how full is your battery"."""

    def battery(self) -> float:
        """Charge left, 0 to 1. Raises `SkillFailed` while a robot does not tell it."""


def charge_of(body: Body) -> float | None:
    """Return the charge, from 0 to 1; None without a battery, or while it is not known."""
    try:
        return body.battery() if isinstance(body, HasBattery) else None
    except SkillFailed:
        return None


@runtime_checkable
class KnowsPowerDraw(Protocol):
    """Knows how long its charge lasts."""

    def battery_lasts_s(self) -> float:
        """Seconds until the charge is used up, driving all the time; infinite if it draws none."""


@runtime_checkable
class MeasuresWays(Protocol):
    """Knows how long its way to a point is: "how far is the press"."""

    def way_m(self, x_m: float, y_m: float) -> float:
        """Metres of the way to a point, from here. Raises `SkillFailed` where no way leads."""


@runtime_checkable
class FromFile(Protocol):
    """Is described by a file; `--check` names the skills and sentences in it that cannot work."""

    @property
    def skills_off(self) -> Mapping[str, str]:
        """The skills of the file that it cannot do, each with the reason."""

    @property
    def file_sentences(self) -> Mapping[tuple[str, str, str], str]:
        """The skill, the language and the template of each sentence; and its place in the file."""

    @property
    def file_notes(self) -> Sequence[str]:
        """What may not be as its owner thinks."""


@runtime_checkable
class TellsFacts(Protocol):
    """Answers questions about itself and its world that only a body of its kind can answer."""

    @property
    def facts(self) -> tuple[Skill, ...]:
        """Skills that move nothing: their templates are the questions, their `done` the answers.

        Programs cannot call them.
        """


@runtime_checkable
class MayBeUnheard(Protocol):
    """Moves elsewhere, so that nothing may be heard of it."""

    @property
    def unheard(self) -> Reason:
        """The sentence that a stop was sent and nothing is heard; empty while it is heard."""


@runtime_checkable
class TellsConditions(Protocol):
    """Tells of itself what orders can wait for: "when you are docked, beep"."""

    @property
    def conditions(self) -> Mapping[str, StateCondition]:
        """Conditions by name; a name is only told to programs."""


@runtime_checkable
class HasMap(Protocol):
    """Draws its surroundings as text, for `/map`."""

    def draw_map(self, columns: int) -> str:
        """The world and the robot as text, this many columns wide."""


@runtime_checkable
class KeepsPace(Protocol):
    """Lives in a world of its own, whose time passes step by step."""

    @property
    def real_time_factor(self) -> float:
        """Seconds that pass in it each second; 0 until that is known."""

    @property
    def pace(self) -> float | None:
        """Which part of the speed that was asked for it keeps; None where none was, or not yet."""

    @property
    def breaks(self) -> int:
        """How often a step failed, or its numbers broke and it was put back."""


@runtime_checkable
class TellsStalls(Protocol):
    """Knows when what it depends on has stopped working."""

    @property
    def stalled_s(self) -> float:
        """How long its world, or what connects it to one, has stood still though it should not."""
