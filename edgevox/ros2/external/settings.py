"""Settings for driving a robot: limits, patience, the bounds of plausible data, and its places.

A YAML file that its people write names the places:

    dock: {x: 0.0, y: 0.0, yaw: 3.14, aliases: [home, charger]}
    front_door: {x: 4.5, y: -1.2, names: {de: die Haustür, fr: [la porte d'entrée, la porte]}}

Metres and radians (counter-clockwise from x) in the map frame; `yaw` is the way to look there.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from types import MappingProxyType
from typing import Annotated

from pydantic import AfterValidator, Field, RootModel

from edgevox.agent.policy import Policy
from edgevox.agent.skills import OwnName
from edgevox.agent.text.reasons import because
from edgevox.core.files.user_file import read_text
from edgevox.core.files.yaml_file import YamlFile
from edgevox.core.reason import Reason
from edgevox.core.transforms import Pose2D, distance_on_floor, turn_between
from edgevox.robots.capabilities import Twist2D
from edgevox.robots.names import LONGEST_PLACE, LocalNames, check_told_apart, read_name
from edgevox.robots.world.fields import Finite, WorldPart, called, listed, within

FURTHEST_M = 10_000.0
"""No goal, place or pose is further from the map's origin, along either axis."""
FASTEST_M_S, FASTEST_RAD_S = 50.0, 50.0
"""No robot that is spoken to says that it is faster."""
SPEED_M_S, SPEED_RAD_S = 5.0, 2 * math.pi
"""Motion up to this speed is never a jump, whatever the robot's own limits are."""
SLACK_M, SLACK_RAD = 0.5, 1.0
"""The error of odometry between two messages that is not a jump."""
MOST_CORRECTION_M = 10.0
"""The most by which localisation may correct a robot's place while it drives."""
_MOST_STAMPED_S = 1.0
_MOST_BEAMS = 100_000


@dataclass(frozen=True, slots=True)
class Jump:
    """The distance and turn between two poses that follow each other."""

    distance_m: float
    turned_rad: float

    @classmethod
    def between(cls, one: Pose2D, other: Pose2D) -> "Jump":
        return cls(distance_on_floor(one, other), abs(turn_between(one.yaw_rad, other.yaw_rad)))

    @property
    def reason(self) -> Reason:
        """The reason to end the drive after it."""
        degrees = math.degrees(self.turned_rad)
        return because("jumped", distance=f"{self.distance_m:.1f}", degrees=f"{degrees:.0f}")


@dataclass(frozen=True, slots=True)
class Speeds:
    """Top speeds: faster motion is a jump and no drive."""

    linear_m_s: float = SPEED_M_S
    angular_rad_s: float = SPEED_RAD_S

    def jump(self, one: Pose2D, other: Pose2D, seconds: float) -> Jump | None:
        """Return the jump between two poses, if it is larger than a drive in this time."""
        jump = Jump.between(one, other)
        far = jump.distance_m > SLACK_M + self.linear_m_s * seconds
        round_ = jump.turned_rad > SLACK_RAD + self.angular_rad_s * seconds
        return jump if far or round_ else None


def seconds_between(heard_s: float, stamped_s: float) -> float:
    """Return the time between two messages: a burst of messages was not sent in one moment.

    Stamps come from the robot, and count for a second at most.
    """
    return max(heard_s, min(stamped_s, _MOST_STAMPED_S), 0.0)


def on_the_map(pose: Pose2D) -> bool:
    """Return whether a robot can be there."""
    return pose.finite and max(abs(pose.x_m), abs(pose.y_m)) <= FURTHEST_M


def drivable(twist: Twist2D) -> bool:
    """Return whether a robot can move so."""
    linear, angular = abs(twist.linear_m_s), abs(twist.angular_rad_s)
    return twist.finite and linear <= FASTEST_M_S and angular <= FASTEST_RAD_S


def sweeps(
    beams: int, angle_min_rad: float, increment_rad: float, near_m: float, far_m: float
) -> bool:
    """Return whether a lidar can have made such a sweep.

    A lidar that could see nothing does not prove that the way is clear.
    """
    angles = (angle_min_rad, increment_rad, increment_rad * beams)
    fits = all(abs(angle) <= 2 * math.tau for angle in angles)  # which no NaN is
    return fits and 0.0 <= near_m < far_m and 0 < beams <= _MOST_BEAMS


@dataclass(frozen=True, slots=True)
class SteeringLimits:
    """Limits for steering, where no node takes goals."""

    max_linear_m_s: float = 0.3
    max_angular_rad_s: float = 0.8
    max_linear_m_s2: float = 0.5
    half_width_m: float = 0.3
    stop_ahead_m: float = 0.5
    """Something this near ahead of the robot's middle makes it wait."""
    wait_s: float = 10.0
    """Seconds to wait for an obstacle to go."""


@dataclass(frozen=True, slots=True)
class Patience:
    """Seconds that a drive may go on without moving, and without coming nearer.

    Its slowest pace.
    """

    unmoved_s: float
    no_nearer_s: float
    first_s: float = 60.0
    slowest_m_s: float = 0.02
    """After `first_s` seconds, a drive that was slower than this as the crow flies has failed."""


@dataclass(frozen=True, slots=True)
class ExternalSettings:
    """Settings of `ExternalRobot` besides its namespace and locations."""

    steering: SteeringLimits = field(default_factory=SteeringLimits)
    steering_patience: Patience = Patience(unmoved_s=5.0, no_nearer_s=20.0)
    # What plans by itself may think, take a detour and recover.
    goal_patience: Patience = Patience(unmoved_s=15.0, no_nearer_s=60.0, first_s=600.0)
    discovery_s: float = 3.0
    """Seconds after the start in which the robot may still be undiscovered."""
    remappings: tuple[str, ...] = ()
    """ROS arguments that give the contract's topics the names that the robot has."""
    obey_s: float = 5.0
    """Seconds that a halted robot may take to stand."""


MOST_LOCATIONS = 200

Metres = Annotated[Finite, within(-FURTHEST_M, FURTHEST_M)]
Name = Annotated[str, called(partial(read_name, longest=LONGEST_PLACE))]


@dataclass(frozen=True, slots=True)
class Location:
    """A point of the map.

    Metres, and the heading in radians, if it has one. `names` are its names by language.
    """

    x_m: float
    y_m: float
    yaw_rad: float | None = None
    aliases: tuple[str, ...] = ()
    names: Mapping[str, OwnName] = field(default_factory=dict)


class LocationEntry(WorldPart):
    """A location of a locations file."""

    x: Metres | None = None
    y: Metres | None = None
    yaw: Annotated[Finite, within(-math.tau, math.tau)] | None = None
    aliases: Annotated[tuple[Name, ...], listed("a list of texts", 0)] = ()
    names: LocalNames = Field(default_factory=dict)


def _home(entries: dict[str, LocationEntry]) -> dict[str, LocationEntry]:
    if not 1 <= len(entries) <= MOST_LOCATIONS:
        raise ValueError(f"1 to {MOST_LOCATIONS} locations")
    check_told_apart({name: (one.aliases, one.names) for name, one in entries.items()})
    return entries


class LocationsFile(RootModel[Annotated[dict[Name, LocationEntry], AfterValidator(_home)]]):
    """A locations file."""


def load_locations(path: Path) -> Mapping[str, Location]:
    """Read and check a locations file.

    Raises `InvalidValue` naming the file, the field, its value and the expected value.
    """
    return parse_locations(read_text(path, "locations"), path.name)


def parse_locations(text: str, name: str) -> Mapping[str, Location]:
    """The locations that this YAML text describes; `name` is the file's name in messages."""
    return read_locations(YamlFile(text, name))


def read_locations(file: YamlFile) -> Mapping[str, Location]:
    """The locations of a file, or of a part of one. Raises as `load_locations`."""
    entries = file.read(LocationsFile, file.data).root
    return {key: _location(file, key, entry) for key, entry in entries.items()}


def _location(file: YamlFile, name: str, entry: LocationEntry) -> Location:
    if entry.x is None or entry.y is None:
        raise file.wrong((name, "x" if entry.x is None else "y"), None, "metres, map frame")
    return Location(entry.x, entry.y, entry.yaw, entry.aliases, entry.names)


class DescribedRobot:
    """What every `robot-external` has of its robot file, if it has one."""

    name = "robot-external"
    about = ""
    """Its name and purpose, if its robot file gives them."""
    own_policy: Path | Policy | None = None
    """The policy that its file names or holds, for where no setting names one."""
    skills_off: Mapping[str, str] = MappingProxyType({})
    file_sentences: Mapping[tuple[str, str, str], str] = MappingProxyType({})
    file_notes: Sequence[str] = ()
    """What it has of a file; see `FromFile`."""
