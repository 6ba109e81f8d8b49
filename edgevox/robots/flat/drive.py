"""The motions of a robot in a flat world: a drive to a point, and a short one straight or round.

A drive to a point plans, follows, and plans again around an obstacle. A relative motion plans
nothing and goes round nothing.
"""

from abc import abstractmethod
from collections.abc import Callable, Sequence

from edgevox.agent.skills import SkillFailed
from edgevox.agent.text.reasons import because
from edgevox.core.transforms import Pose2D, distance_on_floor, turn_between
from edgevox.robots.capabilities import LidarScan, Twist2D
from edgevox.robots.command_mux import STILL
from edgevox.robots.flat.engine import MotionState
from edgevox.robots.flat.planner import PathPlanner
from edgevox.robots.motion import Motion, Progress
from edgevox.robots.path_follower import PathFollower
from edgevox.robots.relative_motion import Caution, Course, RelativeMotion
from edgevox.robots.shapes import Point
from edgevox.robots.world.model import RobotSpec, Room

PATIENCE_S = 2.0
"""Seconds without motion on the way, after which the robot plans again."""
TRIES = 3
"""Plans from one place, after which the robot is stuck."""
_LOOK_EVERY_S = 0.5
_SCAN_EVERY_S = 0.1
_ASIDE_M, _AHEAD_M = 0.03, 0.1
_SHIFTED_M = 0.03
_PROGRESS_M = 0.1
_STOPPED_M_S = 0.02


class FlatMotion(Motion):
    """Lives from the request to its end, for whatever reason."""

    goal: Point
    """Where it leads."""

    @abstractmethod
    def steer(self, time_s: float, motion: MotionState, movable: Sequence[Pose2D]) -> Twist2D:
        """The velocity to ask for now; ends the motion on arrival or when it is stuck."""

    @abstractmethod
    def way(self) -> tuple[Point, ...]:
        """The path that is still to come."""

    def avoid(self, forbidden: Sequence[Room]) -> None:
        """Drive round these from now on, if it drives round anything."""


class RelativeFlatMotion(FlatMotion):
    """A course from where the robot stands, by what its lidar sees ten times a second."""

    def __init__(
        self,
        course: Course,
        limits: RobotSpec,
        scan: Callable[[], LidarScan],
        *,
        time_s: float,
        pose: Pose2D,
    ) -> None:
        """Raises `SkillFailed` where it cannot see its way, or something is in it."""
        super().__init__()
        self._pose, self._take_scan = pose, scan
        self._seen, self._look_at_s = scan(), time_s + _SCAN_EVERY_S
        self._relative = RelativeMotion(course, _caution(limits), lambda: self._seen, time_s)
        self.goal = course.goal.x_m, course.goal.y_m

    def steer(self, time_s: float, motion: MotionState, movable: Sequence[Pose2D]) -> Twist2D:  # noqa: ARG002 - its lidar sees them
        self._pose = motion.pose
        if time_s >= self._look_at_s:
            self._seen, self._look_at_s = self._take_scan(), time_s + _SCAN_EVERY_S
        try:
            twist = self._relative.go_on(time_s, motion.pose, motion.twist)
        except SkillFailed as failure:
            self.end(failure)
            return STILL
        if self._relative.done:
            self.end()
        return twist

    def progress(self) -> Progress:
        return self._relative.progress()

    def way(self) -> tuple[Point, ...]:
        return (self._pose.x_m, self._pose.y_m), self.goal


def _caution(limits: RobotSpec) -> Caution:
    """Room enough to brake before what is seen late, and not to scrape along a wall."""
    fastest = limits.max_linear_m_s
    brake_m = fastest * _SCAN_EVERY_S + fastest**2 / (2 * limits.max_linear_m_s2)
    return Caution(
        half_width_m=limits.radius_m + _ASIDE_M,
        stop_ahead_m=limits.radius_m + _AHEAD_M + brake_m,
        wait_s=PATIENCE_S,
        patience_s=PATIENCE_S,
    )


class NavigationMotion(FlatMotion):
    """A drive to a point of the map, by the way that the planner finds."""

    def __init__(
        self,
        goal: Point,
        planner: PathPlanner,
        limits: RobotSpec,
        *,
        cruise_m_s: float,
        time_s: float,
        pose: Pose2D,
        movable: Sequence[Pose2D],
        forbidden: Sequence[Room] = (),
    ) -> None:
        """Plan the path. Raises `SkillFailed` if there is none.

        `cruise_m_s` is the expected speed, `forbidden` are rooms to avoid.
        """
        super().__init__()
        self.goal = goal
        self._planner, self._limits = planner, limits
        self._forbidden, self._detour = tuple(forbidden), False
        self._follow(pose, movable)
        self._whole_m = max(self._follower.length_m, 1e-6)
        self._last_try_s = time_s + 60.0 + 4.0 * self._whole_m / cruise_m_s
        self._place, self._since_s, self._tries_left = pose, time_s, TRIES
        self._look_at_s = time_s + _LOOK_EVERY_S

    def steer(self, time_s: float, motion: MotionState, movable: Sequence[Pose2D]) -> Twist2D:
        if self._detour or time_s >= self._look_at_s:
            self._look_at_s = time_s + _LOOK_EVERY_S
            self._look(time_s, motion.pose, movable)
        if self.done:
            return STILL
        twist = self._follower.steer(motion.pose)
        if self._follower.arrived and abs(motion.twist.linear_m_s) < _STOPPED_M_S:
            self.end(None)
        return twist

    def avoid(self, forbidden: Sequence[Room]) -> None:
        if tuple(room.name for room in forbidden) != tuple(one.name for one in self._forbidden):
            self._forbidden, self._detour = tuple(forbidden), True

    def progress(self) -> Progress:
        """Return the progress of the drive."""
        left = 0.0 if self._follower.arrived else self._follower.remaining_m
        part = 1.0 if self._follower.arrived else 1.0 - left / self._whole_m
        return Progress(min(max(part, 0.0), 1.0), left, "m")

    def way(self) -> tuple[Point, ...]:
        return self._follower.ahead()

    def _follow(self, pose: Pose2D, movable: Sequence[Pose2D]) -> None:
        path = self._planner.plan((pose.x_m, pose.y_m), self.goal, movable, self._forbidden)
        self._follower = PathFollower(path, self._limits)
        self._planned_with = tuple(movable)

    def _look(self, time_s: float, pose: Pose2D, movable: Sequence[Pose2D]) -> None:
        """Plan again if furniture was pushed or the robot does not get on; give up in time."""
        if self._moved(pose):
            self._place, self._since_s, self._tries_left = pose, time_s, TRIES
        stalled = time_s - self._since_s >= PATIENCE_S
        if (stalled and self._tries_left == 0) or time_s > self._last_try_s:
            self.end(SkillFailed(because("stuck")))
            return
        if stalled:
            self._tries_left -= 1
            self._since_s = time_s
        if stalled or self._detour or self._shifted(movable):
            self._detour = False
            try:
                self._follow(pose, movable)
            except SkillFailed as refusal:
                self.end(refusal)

    def _moved(self, pose: Pose2D) -> bool:
        turned = abs(turn_between(self._place.yaw_rad, pose.yaw_rad))
        return distance_on_floor(pose, self._place) > _PROGRESS_M or turned > 1.0

    def _shifted(self, movable: Sequence[Pose2D]) -> bool:
        pairs = zip(movable, self._planned_with, strict=True)
        return any(distance_on_floor(now, then) > _SHIFTED_M for now, then in pairs)
