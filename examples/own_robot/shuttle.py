"""`robot-shuttle`: a carriage on a rail, as an example of a body of your own.

Its methods decide what it can do: a pose, velocities, places, a drive to a point.
`edgevox.robots.capabilities` lists all such methods.
"""

import math
import threading
from collections.abc import Mapping
from types import MappingProxyType
from typing import Any

from edgevox.agent.skills import Skill, SkillFailed
from edgevox.core.cancel import Cancelled, CancelToken
from edgevox.core.settings import Settings
from edgevox.core.transforms import Pose2D
from edgevox.robots.capabilities import Report, Twist2D
from edgevox.robots.command_mux import CommandMux
from edgevox.robots.motion import Motion, Progress
from edgevox.robots.navigation import LOCATION, navigation_skills
from edgevox.robots.plugin import Robot
from edgevox.robots.sim_loop import SimLoop

STEP_S = 0.02
RAIL_M = 12.0
STATIONS = MappingProxyType({"dock": (0.0, 0.0), "press": (5.0, 0.0), "warehouse": (11.0, 0.0)})
NEAR_M, THERE_M = 0.5, 0.005
ACCELERATION_M_S2 = 2.0


class Trip(Motion):
    """A drive to a point of the rail."""

    def __init__(self, goal_m: float, start_m: float) -> None:
        super().__init__()
        self.goal_m = goal_m
        self._left_m = self._length_m = max(abs(goal_m - start_m), THERE_M)

    def go_on(self, x_m: float) -> None:
        """Take in where the shuttle is now."""
        self._left_m = abs(self.goal_m - x_m)
        if self._left_m < THERE_M:
            self.end()

    def progress(self) -> Progress:
        return Progress(1.0 - self._left_m / max(self._length_m, self._left_m), self._left_m, "m")


class Shuttle:
    """Moves along the x axis; any thread may call any method."""

    name = "robot-shuttle"
    max_linear_m_s = 1.0
    max_angular_rad_s = 0.0
    places: Mapping[str, tuple[float, float]] = STATIONS

    def __init__(self, speed: float | None = 1.0) -> None:
        self._lock = threading.RLock()
        self._mux: CommandMux[Trip] = CommandMux(self._lock, max_linear_m_s=self.max_linear_m_s)
        self._x_m = self._speed_m_s = 0.0
        self._ticks = 0
        self._sim_loop = SimLoop(self._step, period_s=STEP_S, speed=speed, name=self.name)
        self._skills = navigation_skills(self, word=LOCATION)

    @property
    def skills(self) -> tuple[Skill, ...]:
        return self._skills

    @property
    def time_s(self) -> float:
        return self._ticks * STEP_S

    @property
    def stalled_s(self) -> float:
        return self._sim_loop.stalled_s

    @property
    def watchdog_halts(self) -> int:
        return self._mux.watchdog_halts

    def start(self) -> None:
        self._sim_loop.start()

    def close(self) -> None:
        self.halt("the shuttle was switched off")
        self._sim_loop.close()

    @property
    def in_motion(self) -> bool:
        return self._mux.motion is not None

    def advance(self, seconds: float) -> None:
        self._sim_loop.advance(seconds)

    def reset(self) -> None:
        with self._lock:
            self._mux.halt(Cancelled("the world was reset"))
            self._x_m = self._speed_m_s = 0.0

    def pose(self) -> Pose2D:
        return Pose2D(self._x_m, 0.0, 0.0)

    def velocity(self) -> Twist2D:
        return Twist2D(self._speed_m_s, 0.0)

    def place_at(self, x_m: float, y_m: float) -> str | None:
        near = (name for name, at in STATIONS.items() if math.dist(at, (x_m, y_m)) < NEAR_M)
        return next(near, None)

    def state(self) -> Mapping[str, Any]:
        with self._lock:
            x_m, speed_m_s, trip = self._x_m, self._speed_m_s, self._mux.motion
            left_m = trip.progress().left if trip else 0.0
        return {
            "name": self.name,
            "time": round(self.time_s, 3),
            "pose": {"x": round(x_m, 4), "y": 0.0, "yaw": 0.0},
            "velocity": {"linear": round(speed_m_s, 4), "angular": 0.0},
            "location": self.place_at(x_m, 0.0),
            "goal": {"x": trip.goal_m, "distance": round(left_m, 3)} if trip else None,
        }

    def set_velocity(self, twist: Twist2D) -> None:
        with self._lock:
            self._mux.stream(twist, self.time_s)
        self._sim_loop.wake()

    def halt(self, reason: str) -> bool:
        with self._lock:
            return self._mux.halt(Cancelled(reason)) or self._speed_m_s != 0.0

    def drive_to(self, x_m: float, y_m: float, *, token: CancelToken, report: Report) -> None:
        if y_m != 0.0 or not 0.0 <= x_m <= RAIL_M:
            raise SkillFailed(f"My rail goes from x 0 to x {RAIL_M:g}, with y at 0.")
        trip = self._mux.start(lambda: Trip(x_m, self._x_m))
        self._sim_loop.wake()
        self._mux.carry_out(trip, token, lambda: report(progress=round(trip.progress().part, 3)))

    def _step(self) -> bool:
        """Let 0.02 s pass, on the sim loop's thread. True if more is to come."""
        with self._lock:
            self._ticks += 1
            change = ACCELERATION_M_S2 * STEP_S
            self._speed_m_s += min(max(self._wanted_m_s() - self._speed_m_s, -change), change)
            self._x_m = min(max(self._x_m + self._speed_m_s * STEP_S, 0.0), RAIL_M)
            trip = self._mux.motion
            if trip is not None:
                trip.go_on(self._x_m)
                if trip.done:
                    self._speed_m_s = 0.0
            return self._mux.motion is not None or self._speed_m_s != 0.0

    def _wanted_m_s(self) -> float:
        self._mux.tick(self.time_s)
        trip, velocity = self._mux.motion, self._mux.velocity
        if trip is not None:
            left_m = trip.goal_m - self._x_m
            braking_m_s = math.sqrt(ACCELERATION_M_S2 * abs(left_m))
            return math.copysign(min(self.max_linear_m_s, braking_m_s), left_m)
        return velocity.linear_m_s if velocity else 0.0


def _build(_settings: Settings, speed: float | None) -> Shuttle:
    return Shuttle(speed)


SHUTTLE = Robot(
    "a carriage on a rail between dock, press and warehouse",
    _build,
    "You are EdgeVox, the voice of a carriage on a rail in a factory. Be brief: one short sentence."
    " Only promise what your skills can do.",
)
