"""`robot-external`: any robot that speaks a few ROS 2 topics, driven over them."""

import math
import threading
from collections.abc import Mapping
from dataclasses import replace
from types import MappingProxyType
from typing import Any

from edgevox.agent.reasons import because
from edgevox.agent.skills import STOP, GoalHandle, OneOf, Result, Skill, SkillFailed
from edgevox.core.cancel import Cancelled, CancelToken
from edgevox.core.clock import Clock, SystemClock
from edgevox.core.errors import finite
from edgevox.core.frame_names import MAP
from edgevox.core.log import get_logger
from edgevox.core.transforms import Pose2D
from edgevox.robots.bounds import Bounds
from edgevox.robots.capabilities import STOP_ASKED, Report, SpeedLimit, Twist2D
from edgevox.robots.navigation import LOCATION, navigation_skills
from edgevox.robots.places.memory import PlaceMemory
from edgevox.ros2.external.control_loop import Hold
from edgevox.ros2.external.link import Link
from edgevox.ros2.external.locations import Location
from edgevox.ros2.external.navigation import ExternalNavigation
from edgevox.ros2.external.plausible import FURTHEST_M
from edgevox.ros2.external.senses import incredible
from edgevox.ros2.external.settings import ExternalSettings
from edgevox.ros2.external.target import Fix, Target
from edgevox.ros2.external.trust import Trust
from edgevox.ros2.stamps import NS_PER_S

log = get_logger(__name__)

AT_LOCATION_M = 1.0
"""A robot this near to a location is at it."""
_CLOSING_S = 1.0
_WORLD = Bounds.around(MAP, FURTHEST_M)


class ExternalRobot:
    """A body that lives in other processes: it is heard on topics and driven over them.

    Its poses, goals and locations are in the map frame where /tf has one, else in that of its
    odometry. A drive is a goal of Nav2's action or a `goal_pose` where anything there takes one,
    and is steered by `cmd_vel` where nothing does; that is decided once, when it starts. Every
    method may be called from any thread; only `drive_to`, the skill `stop` and `close` block.
    """

    name = "robot-external"

    def __init__(
        self,
        namespace: str = "/",
        locations: Mapping[str, Location] | None = None,
        settings: ExternalSettings | None = None,
        *,
        clock: Clock | None = None,
    ) -> None:
        self._namespace = namespace
        self._locations = dict(locations or {})
        self._settings = settings or ExternalSettings()
        self._clock = clock or SystemClock()
        self._lock = threading.RLock()
        self._link: Link | None = None
        self._limit: SpeedLimit = lambda twist: twist
        self._stops = 0
        self._places = MappingProxyType(
            {name: (one.x_m, one.y_m) for name, one in self._locations.items()}
        )
        aliases = {said: name for name, one in self._locations.items() for said in one.aliases}
        self.place_memory = PlaceMemory(namespace, OneOf(tuple(self._places), aliases))
        self._skills = tuple(
            replace(one, function=self._stop_and_see) if one.name == STOP else one
            for one in navigation_skills(
                self, aliases=aliases, word=LOCATION, memory=self.place_memory
            )
        )

    @property
    def skills(self) -> tuple[Skill, ...]:
        return self._skills

    @property
    def time_s(self) -> float:
        """The robot's own time: the stamp of its newest odometry, 0 before the first."""
        seen = self._link.senses.sightings.newest() if self._link else None
        return seen.stamp_ns / NS_PER_S if seen else 0.0

    @property
    def stalled_s(self) -> float:
        """For how long nothing it hears is taken in, nor a velocity sent."""
        link = self._link
        return link.stalled_s if link else 0.0

    @property
    def trouble(self) -> str:
        """Why it can neither be driven nor asked where it is; empty if its odometry is heard."""
        link = self._link
        if link is None:
            return ""
        if link.senses.distrusted:
            return f"what is heard on {link.senses.distrusted} cannot be true"
        if link.senses.sightings.fresh() is not None:
            return ""
        never = link.senses.sightings.newest() is None
        return f"{'nothing' if never else 'nothing more'} is heard on {link.senses.odom_topic}"

    @property
    def refusals(self) -> Mapping[tuple[str, ...], int]:
        """How many of the robot's messages could not be true, by topic and reason."""
        return self._link.senses.refusals if self._link else {}

    @property
    def places(self) -> Mapping[str, tuple[float, float]]:
        return self._places

    def place_at(self, x_m: float, y_m: float) -> str | None:
        """The nearest location, if it is near."""
        near = {name: math.dist((x_m, y_m), point) for name, point in self._places.items()}
        nearest = min(near, key=lambda name: near[name], default=None)
        return nearest if nearest and near[nearest] <= AT_LOCATION_M else None

    def start(self) -> None:
        """Join the graph. Raises `RosBridgeFailed` where that cannot be done."""
        self._link = Link(self._namespace, self._settings, self._clock, self._lock)
        self._link.control.mux.limit = self._limit
        self._link.start()

    def close(self) -> None:
        """Stop the robot, as far as it obeys within a second, and leave the graph."""
        link = self._link
        if link is None:
            return
        moved, hold = self._stand(link, "EdgeVox was switched off")
        if moved:
            hold.done.wait(_CLOSING_S)
        self._link = None
        link.close()

    def limit_speed(self, limit: SpeedLimit) -> None:
        """Steer it no faster than this permits; what takes goals has limits of its own."""
        self._limit = limit
        if self._link:
            self._link.control.mux.limit = limit

    def halt(self, reason: str) -> bool:
        """Zero velocity leaves before this returns, and is held until the robot stands."""
        link = self._link
        if link is None:
            return False
        moved, _ = self._stand(link, reason)
        return moved

    def reset(self) -> None:
        """A real robot cannot be put back; it stops."""
        self.halt("reset")

    def pose(self) -> Pose2D:
        """Where it is. Raises `SkillFailed` while its odometry is silent."""
        return self._fix().pose

    def located(self) -> tuple[Pose2D, str]:
        """The pose, and the frame that it is in."""
        fix = self._fix()
        return fix.pose, fix.frame

    def velocity(self) -> Twist2D:
        return self._fix().twist

    def state(self) -> Mapping[str, Any]:
        """As every body's; `pose` and `velocity` are None while the odometry is silent."""
        link = self._link
        seen = link.senses.sightings.newest() if link else None
        fix = link.senses.fix() if link and not link.senses.distrusted else None
        with self._lock:
            drive = link.control.mux.motion if link else None
            goal = drive.describe() if drive else None
        return {
            "name": self.name,
            "time": round(self.time_s, 3),
            **_describe(fix),
            "location": self.place_at(fix.pose.x_m, fix.pose.y_m) if fix else None,
            "goal": goal,
            "odom_age": round(link.senses.sightings.age_s(seen), 3) if link and seen else None,
            "lidar": bool(link and link.senses.scan()),
            "camera": bool(link and link.senses.sees),
        }

    def check_goal(self, x_m: float, y_m: float) -> None:
        """Raise `SkillFailed` for a point further from the map's origin than any robot drives."""
        _WORLD.check(x_m, y_m)

    def drive_to(
        self,
        x_m: float,
        y_m: float,
        *,
        token: CancelToken,
        report: Report,
        yaw_rad: float | None = None,
    ) -> None:
        """Block until there, looking along `yaw_rad` if given. See `DrivesTo` for what it raises.

        A halt or another drive ends it.
        """
        target = Target(finite("x", x_m), finite("y", y_m), yaw_rad)
        self.check_goal(x_m, y_m)
        link = self._switched_on()
        stops = self._stops
        driver = link.choose(token)
        with self._lock:
            if self._stops != stops:
                raise Cancelled("it was stopped before it began")
            token.check()
            fix = self._fix()
            trust = Trust(link.senses, fix)
            drive = ExternalNavigation(target, driver, fix, trust, self._clock.now())
            link.control.start(drive, fix)
        link.senses.say_frame_once(fix)
        log.info("driving", x_m=round(x_m, 2), y_m=round(y_m, 2), driver=driver.name)
        link.control.mux.carry_out(drive, token, lambda: self._report(drive, report))

    def drive_to_place(self, place: str, *, token: CancelToken, report: Report) -> None:
        """Drive to a location, and look along its yaw."""
        there = self._locations[place]
        self.drive_to(there.x_m, there.y_m, token=token, report=report, yaw_rad=there.yaw_rad)

    def drive_to_pose(self, pose: Pose2D, *, token: CancelToken, report: Report) -> None:
        """Drive to its point, and look its way."""
        self.drive_to(pose.x_m, pose.y_m, token=token, report=report, yaw_rad=pose.yaw_rad)

    def _stop_and_see(self, goal: GoalHandle) -> Result:
        """The skill `stop`: ends when the robot stands, and fails when it does not obey."""
        goal.token.check()
        link = self._switched_on()
        moved, hold = self._stand(link, STOP_ASKED)
        if moved:
            hold.done.wait(self._settings.obey_s + 1.0)
        if hold.problem:
            raise SkillFailed(hold.problem)
        return {"was_moving": moved}

    def _stand(self, link: Link, reason: str) -> tuple[bool, Hold]:
        """Whether the robot moved or drove, and the hold that it is under now."""
        with self._lock:
            self._stops += 1
            moving = not link.senses.sightings.still()
            drove = link.control.mux.halt(Cancelled(reason))
            return moving or drove, link.control.hold

    def _switched_on(self) -> Link:
        if self._link is None:
            raise SkillFailed(because("switched_off"))
        return self._link

    def _fix(self) -> Fix:
        link = self._switched_on()
        if link.senses.distrusted:
            raise incredible(link.senses.distrusted)
        fix = link.senses.fix()
        if fix is not None:
            return fix
        topic = link.senses.odom_topic
        if link.senses.sightings.newest() is None:
            raise SkillFailed(because("robot_unheard", topic=topic))
        raise SkillFailed(because("lost", topic=topic))

    def _report(self, drive: ExternalNavigation, report: Report) -> None:
        link = self._link
        fix = link.senses.fix() if link else None
        with self._lock:
            progress = drive.progress()
        where = {"x": round(fix.pose.x_m, 3), "y": round(fix.pose.y_m, 3)} if fix else {}
        report(progress=round(progress.part, 3), distance_m=round(progress.left, 3), **where)


def _describe(fix: Fix | None) -> dict[str, Any]:
    if fix is None:
        return {"frame": None, "pose": None, "velocity": None}
    pose, twist = fix.pose, fix.twist
    return {
        "frame": fix.frame,
        "pose": {"x": round(pose.x_m, 4), "y": round(pose.y_m, 4), "yaw": round(pose.yaw_rad, 4)},
        "velocity": {
            "linear": round(twist.linear_m_s, 4),
            "angular": round(twist.angular_rad_s, 4),
        },
    }
