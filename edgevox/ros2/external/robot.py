"""`robot-external`: any robot that speaks a few ROS 2 topics, driven over them."""

import math
import threading
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from types import MappingProxyType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from edgevox.agent.skills import STOP, GoalHandle, OneOf, Result, Skill, SkillFailed
from edgevox.agent.text.reasons import because, called_off
from edgevox.core.cancel import Cancelled, CancelToken
from edgevox.core.clock import Clock, SystemClock
from edgevox.core.errors import finite
from edgevox.core.log import get_logger
from edgevox.core.reason import NO_REASON, Reason
from edgevox.core.transforms import MAP, Pose2D
from edgevox.robots.capabilities import OccupancyMap, Report, SpeedLimit, Twist2D
from edgevox.robots.limits import Bounds
from edgevox.robots.navigation import LOCATION, TURN_TOWARDS, navigation_skills
from edgevox.robots.places.memory import PlaceMemory
from edgevox.robots.relative_motion import Course, StraightCourse, TurnCourse
from edgevox.robots.relative_skills import driving_skills, where
from edgevox.ros2.agent_node_handle import AgentNodeHandle
from edgevox.ros2.clients import interface_reason
from edgevox.ros2.external.inputs import incredible
from edgevox.ros2.external.motion import (
    MotionBackend,
    OwnSteering,
    PoseEstimate,
    Target,
    describe,
)
from edgevox.ros2.external.navigation import (
    ExternalMotion,
    ExternalNavigation,
    ExternalRelativeMotion,
    LocalisationCheck,
    ZeroVelocity,
)
from edgevox.ros2.external.robot_node import RobotNode
from edgevox.ros2.external.settings import (
    FURTHEST_M,
    DescribedRobot,
    ExternalSettings,
    Location,
    SteeringLimits,
)
from edgevox.ros2.robot_file.format import BATTERY
from edgevox.ros2.robot_file.skills import DescribedSkill
from edgevox.ros2.robot_file.state import NO_STATES, RobotStates
from edgevox.ros2.stamps import NS_PER_S

log = get_logger(__name__)

AT_LOCATION_M = 1.0
"""A robot this near to a location is at it."""
_CLOSING_S = 1.0
_WORLD = Bounds.around(MAP, FURTHEST_M)


class ExternalRobot(DescribedRobot):
    """A body in other processes: it is heard on topics and driven over them.

    Poses, goals and locations are in the map frame if /tf has one, else in the odometry's frame.
    When a drive starts, it chooses its way once: Nav2's action or `goal_pose` if a node takes one,
    else `cmd_vel`. Every method may be called from any thread; only `drive_to`, the skill `stop`
    and `close` block.
    """

    def __init__(
        self,
        namespace: str = "/",
        locations: Mapping[str, Location] | None = None,
        settings: ExternalSettings | None = None,
        *,
        described: Sequence[DescribedSkill] = (),
        states: RobotStates = NO_STATES,
        clock: Clock | None = None,
    ) -> None:
        self._namespace = namespace
        self._locations = dict(locations or {})
        self._settings = settings or ExternalSettings()
        self._clock = clock or SystemClock()
        self._lock = threading.RLock()
        self._robot_node: RobotNode | None = None
        self._limit: SpeedLimit = lambda twist: twist
        self._stops = 0
        self._places = MappingProxyType(
            {name: (one.x_m, one.y_m) for name, one in self._locations.items()}
        )
        aliases = {said: name for name, one in self._locations.items() for said in one.aliases}
        names = {name: one.names for name, one in self._locations.items()}
        known = OneOf(tuple(self._places), aliases, names=names)
        self.place_memory = PlaceMemory(namespace, known)
        if "battery" not in {one.name for one in described}:  # else it says it itself
            states = states.with_battery()
        self._described, self._states = described, states
        self.conditions = states.conditions()
        """What its states let orders wait for."""
        if states.has_battery:
            self.battery = self._charge
        self.ros = AgentNodeHandle(self._clock)
        """Access to its node, for skills."""
        own = navigation_skills(
            self, aliases=aliases, word=LOCATION, memory=self.place_memory, names=names
        )
        its = [one.skill() for one in described]
        taken = {one.name for one in its}
        self._skills = (
            # Before ours: its owner's sentences count first, unless they take any words.
            *(one for one in its if not one.free_text),
            *(
                replace(one, function=self._stop_and_see)
                if one.name == STOP
                else self._looking_ahead(one, turns=one.name == TURN_TOWARDS)
                for one in own
            ),
            *(one for one in its if one.free_text),
            *(
                self._looking_ahead(one, turns=True)
                for one in driving_skills(self)
                if one.name not in taken
            ),
        )

    @property
    def skills(self) -> tuple[Skill, ...]:
        return self._skills

    @property
    def time_s(self) -> float:
        """The robot's own time: the stamp of its newest odometry, 0 before the first."""
        seen = self._robot_node.senses.odometry_history.newest() if self._robot_node else None
        return seen.stamp_ns / NS_PER_S if seen else 0.0

    @property
    def stalled_s(self) -> float:
        """Seconds for which it has neither taken in messages nor sent a velocity."""
        robot_node = self._robot_node
        return robot_node.stalled_s if robot_node else 0.0

    @property
    def fault(self) -> str:
        """The reason why it can neither be driven nor located; empty if its odometry is heard."""
        robot_node = self._robot_node
        if robot_node is None:
            return ""
        if robot_node.senses.distrusted:
            return f"what is heard on {robot_node.senses.distrusted} cannot be true"
        if robot_node.senses.odometry_history.fresh() is not None:
            return ""
        if robot_node.senses.odometry_history.newest() is None:
            return robot_node.odometry_fault
        return f"nothing more is heard on {robot_node.senses.odom_topic}"

    @property
    def unheard(self) -> Reason:
        """Why it is not known whether it stands after a stop; empty if it is."""
        robot_node = self._robot_node
        if robot_node is None or not self.fault:
            return NO_REASON
        unseen = because("stop_unseen", topic=robot_node.senses.odom_topic)
        return replace(unseen, is_sentence=True)

    @property
    def doubts(self) -> Sequence[str]:
        """What is not as it should be with the types of its topics, each in a few words."""
        return self._robot_node.types.doubts if self._robot_node else []

    @property
    def refusals(self) -> Mapping[tuple[str, ...], int]:
        """The number of the robot's implausible messages, by topic and reason."""
        return self._robot_node.senses.refusals if self._robot_node else {}

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
        self._robot_node = RobotNode(
            self._namespace,
            self._settings,
            self._clock,
            self._lock,
            described=(*self._described, self._states),
            handle=self.ros,
            check_driven=self._states.check_driven,
        )
        self._robot_node.control.mux.limit = self._limit
        self._robot_node.start()

    def close(self) -> None:
        """Stop the robot, as far as it obeys within a second, and leave the graph."""
        robot_node = self._robot_node
        if robot_node is None:
            return
        moved, hold = self._stand(robot_node, str(called_off("edgevox_off")))
        if moved:
            hold.wait_for(_CLOSING_S)
        self._robot_node = None
        robot_node.close()

    def limit_speed(self, limit: SpeedLimit) -> None:
        """Steer it no faster than this permits; what takes goals has limits of its own."""
        self._limit = limit
        if self._robot_node:
            self._robot_node.control.mux.limit = limit

    def halt(self, reason: str) -> bool:
        """Zero velocity leaves before this returns, and is held until the robot stands."""
        robot_node = self._robot_node
        if robot_node is None:
            return False
        moved, _ = self._stand(robot_node, reason)
        return moved

    def reset(self) -> None:
        """A real robot cannot be put back; it stops."""
        self.halt(str(called_off("reset")))

    def pose(self) -> Pose2D:
        """Return its pose. Raises `SkillFailed` while its odometry is silent."""
        return self._estimate().pose

    def located(self) -> tuple[Pose2D, str]:
        """The pose, and the frame that it is in."""
        estimate = self._estimate()
        return estimate.pose, estimate.frame

    def velocity(self) -> Twist2D:
        return self._estimate().twist

    def state(self) -> Mapping[str, Any]:
        """Return its state, as every body does.

        `pose` and `velocity` are None while odometry is silent.
        """
        robot_node = self._robot_node
        seen = robot_node.senses.odometry_history.newest() if robot_node else None
        estimate = (
            robot_node.senses.estimate()
            if robot_node and not robot_node.senses.distrusted
            else None
        )
        with self._lock:
            drive = robot_node.control.mux.motion if robot_node else None
            goal = drive.describe() if drive else None
        return {
            "name": self.name,
            "time": round(self.time_s, 3),
            **describe(estimate),
            "location": self.place_at(estimate.pose.x_m, estimate.pose.y_m) if estimate else None,
            "goal": goal,
            "odom_age": round(robot_node.senses.odometry_history.age_s(seen), 3)
            if robot_node and seen
            else None,
            "lidar": bool(robot_node and robot_node.senses.scans),
            "camera": bool(robot_node and robot_node.senses.camera.sees),
        }

    def newest_picture(self) -> NDArray[np.uint8] | None:
        """Return its camera's picture. See `ReceivesPictures`."""
        robot_node = self._robot_node
        return robot_node.senses.camera.pixels() if robot_node else None

    def newest_map(self) -> OccupancyMap | None:
        """Return the map of its surroundings. See `ReceivesMap`."""
        robot_node = self._robot_node
        return robot_node.senses.newest_map() if robot_node else None

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
        robot_node = self._switched_on()

        def make(estimate: PoseEstimate, backend: MotionBackend) -> ExternalMotion:
            if backend.name == OwnSteering.name:
                robot_node.check_wheels()
            trust = LocalisationCheck(robot_node.senses, estimate)
            return ExternalNavigation(target, backend, estimate, trust, self._clock.now())

        drive = self._begin(robot_node, make, token)
        robot_node.control.mux.carry_out(drive, token, lambda: self._report(drive, report))

    def drive_straight(self, distance_m: float, *, token: CancelToken, report: Report) -> None:
        """Block until that far ahead, or back if negative; raises as `drive_to` does.

        EdgeVox steers this on ``cmd_vel``, and round nothing, also where Nav2 takes goals.
        """
        distance_m = finite("distance", distance_m)
        self._go(lambda pose, limits: StraightCourse(pose, distance_m, limits), token, report)

    def turn(self, angle_rad: float, *, token: CancelToken, report: Report) -> None:
        """Block until turned by that to the left, right if negative; as `drive_straight`."""
        angle_rad = finite("angle", angle_rad)
        self._go(lambda pose, limits: TurnCourse(pose, angle_rad, limits), token, report)

    def drive_to_place(self, place: str, *, token: CancelToken, report: Report) -> None:
        """Drive to a location, and look along its yaw."""
        there = self._locations[place]
        self.drive_to(there.x_m, there.y_m, token=token, report=report, yaw_rad=there.yaw_rad)

    def drive_to_pose(self, pose: Pose2D, *, token: CancelToken, report: Report) -> None:
        """Drive to its point, and look its way."""
        self.drive_to(pose.x_m, pose.y_m, token=token, report=report, yaw_rad=pose.yaw_rad)

    def _go(
        self,
        course: Callable[[Pose2D, SteeringLimits], Course],
        token: CancelToken,
        report: Report,
    ) -> None:
        robot_node = self._switched_on()

        def make(estimate: PoseEstimate, backend: MotionBackend) -> ExternalMotion:  # noqa: ARG001
            robot_node.check_wheels()
            return self._relative(course, robot_node, estimate)

        motion = self._begin(robot_node, make, token)
        mux = robot_node.control.mux
        mux.carry_out(motion, token, lambda: self._report_relative(motion, report))

    def _relative(
        self,
        course: Callable[[Pose2D, SteeringLimits], Course],
        robot_node: RobotNode,
        estimate: PoseEstimate,
    ) -> ExternalRelativeMotion:
        """A motion that has not begun. Raises `SkillFailed` where it cannot begin."""
        motion = ExternalRelativeMotion(
            course,
            robot_node.senses,
            self._settings,
            estimate,
            now_s=self._clock.now(),
            turn=robot_node.control.steer,
            recall=robot_node.recall,
            sighted=robot_node.takes_goals,  # Nav2 would see what no lidar here does
        )
        self.check_goal(motion.target.x_m, motion.target.y_m)
        return motion

    def _looking_ahead(self, one: Skill, *, turns: bool) -> Skill:
        """The skill, which looks whether it could drive now before it ends another motion.

        `turns`: EdgeVox always turns the wheels for it.
        """

        def ready(token: CancelToken, most_s: float, /, **arguments: Any) -> None:
            robot_node = self._switched_on()
            self._states.check_driving(token, most_s)
            robot_node.until_heard(token, most_s, turns=turns)
            estimate = self._estimate()
            if turns or not robot_node.takes_goals:
                robot_node.check_wheels()
            if turns and "distance" in arguments:  # it may not see its way
                ahead = math.copysign(arguments["distance"], math.cos(one.towards_rad))
                with self._lock:
                    self._relative(
                        lambda pose, limits: StraightCourse(pose, ahead, limits),
                        robot_node,
                        estimate,
                    )

        return replace(one, ready=ready) if one.drives else one

    def _begin(
        self,
        robot_node: RobotNode,
        make: Callable[[PoseEstimate, MotionBackend], ExternalMotion],
        token: CancelToken,
    ) -> ExternalMotion:
        """Begin a motion, unless a stop came before; what takes goals is known by then."""
        stops = self._stops
        self._states.check_driving(token)
        backend = robot_node.choose(token)
        with self._lock:
            if self._stops != stops:
                raise Cancelled(called_off("not_begun"))
            token.check()
            estimate = self._estimate()
            motion = make(estimate, backend)
            robot_node.control.start(motion, estimate)
        robot_node.senses.say_frame_once(estimate)
        x_m, y_m = round(motion.target.x_m, 2), round(motion.target.y_m, 2)
        log.info("driving", x_m=x_m, y_m=y_m, backend=motion.by)
        return motion

    def _stop_and_see(self, goal: GoalHandle) -> Result:
        """The skill `stop`: ends when the robot stands, and fails when it does not obey."""
        goal.token.check()
        robot_node = self._switched_on()
        moved, hold = self._stand(robot_node, str(called_off("stop_asked")))
        if moved:
            hold.wait_for(self._settings.obey_s + 1.0)
        hold.check()
        if self.unheard:
            raise SkillFailed(self.unheard)
        return {"was_moving": moved}

    def _stand(self, robot_node: RobotNode, reason: str) -> tuple[bool, ZeroVelocity]:
        """Stop; return whether the robot moved or drove, and the hold that it is under now."""
        with self._lock:
            self._stops += 1
            moving = robot_node.senses.odometry_history.moves()
            drove = robot_node.control.mux.halt(Cancelled(reason))
            return moving or drove, robot_node.control.hold

    def _charge(self) -> float:
        """Its charge, from 0 to 1. Raises `SkillFailed`: a silent robot may have a battery."""
        try:
            return self._states.battery()
        except SkillFailed as error:
            named = any(one.startswith("battery_state:=") for one in self._settings.remappings)
            if error.reason.code == "no_battery" and (named or self.unheard):
                raise SkillFailed(interface_reason("unheard", what=BATTERY)) from None
            raise

    def _switched_on(self) -> RobotNode:
        if self._robot_node is None:
            raise SkillFailed(because("switched_off"))
        return self._robot_node

    def _estimate(self) -> PoseEstimate:
        robot_node = self._switched_on()
        if robot_node.senses.distrusted:
            raise incredible(robot_node.senses.distrusted)
        estimate = robot_node.senses.estimate()
        if estimate is not None:
            return estimate
        if robot_node.senses.odometry_history.newest() is None:
            raise SkillFailed(robot_node.odometry_missing)
        raise SkillFailed(because("lost", topic=robot_node.senses.odom_topic))

    def _report(self, drive: ExternalMotion, report: Report) -> None:
        with self._lock:
            progress = drive.progress()
        at = self._at()
        at.pop("yaw_deg", None)
        report(progress=round(progress.part, 3), distance_m=round(progress.left, 3), **at)

    def _report_relative(self, motion: ExternalMotion, report: Report) -> None:
        with self._lock:
            progress = motion.progress()
        report(**progress.as_values(), **self._at())

    def _at(self) -> dict[str, float]:
        """Where it is, for a report; empty while that is unknown."""
        robot_node = self._robot_node
        estimate = robot_node.senses.estimate() if robot_node else None
        return where(estimate.pose) if estimate else {}
