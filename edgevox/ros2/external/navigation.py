"""A drive to a target or by an amount, the check of localisation, and the control loop.

At 20 Hz the loop tells the robot to go on with a drive, to stand, or nothing. Velocities leave from
the loop and from a drive that steers, never from both, and none leaves while the robot drives by
itself.

EdgeVox steers a drive by some metres or degrees itself, in the odometry's frame: what takes goals
could lead the robot round an obstacle, and localisation could move its line.
"""

import math
from abc import abstractmethod
from collections.abc import Callable
from contextlib import AbstractContextManager
from typing import Any

from edgevox.agent.skills import SkillFailed
from edgevox.agent.text.reasons import because
from edgevox.core.clock import Clock
from edgevox.core.log import get_logger
from edgevox.core.reason import Reason
from edgevox.core.transforms import Pose2D, compose_on_floor, distance_on_floor, turn_between
from edgevox.robots.capabilities import Twist2D
from edgevox.robots.command_mux import STILL, CommandMux
from edgevox.robots.motion import Motion, Progress
from edgevox.robots.relative_motion import Caution, Course, RelativeMotion
from edgevox.ros2.external.inputs import SensorInputs, incredible
from edgevox.ros2.external.motion import (
    GoalTopicBackend,
    MotionBackend,
    OwnSteering,
    PoseEstimate,
    Target,
    VelocityPublisher,
)
from edgevox.ros2.external.settings import (
    MOST_CORRECTION_M,
    ExternalSettings,
    Jump,
    Patience,
    SteeringLimits,
    on_the_map,
)

log = get_logger(__name__)


class LocalisationCheck:
    """Watches localisation during a drive; created when the drive begins.

    Odometry runs smoothly; localisation may correct it by some metres. A larger jump ends the
    drive; the next drive starts from the new pose.
    """

    def __init__(self, senses: SensorInputs, estimate: PoseEstimate) -> None:
        self._senses = senses
        self._before = estimate
        doubt = senses.odometry_history.doubt
        self._doubts = doubt.number if doubt else 0

    def check(self, estimate: PoseEstimate) -> None:
        """Raises `SkillFailed` with the reason why the robot must not go on by this."""
        doubt = self._senses.odometry_history.doubt
        if doubt and doubt.number > self._doubts:
            if doubt.jump is None:
                raise incredible(self._senses.odom_topic)
            raise self._jumped(doubt.jump, self._senses.odom_topic)
        if not on_the_map(estimate.pose):
            raise incredible(self._senses.tf_topic)
        before, self._before = self._before, estimate
        jump = Jump.between(before.pose, estimate.pose)
        if jump.distance_m > MOST_CORRECTION_M or before.frame != estimate.frame:
            raise self._jumped(jump, self._senses.tf_topic)

    def _jumped(self, jump: Jump, topic: str) -> SkillFailed:
        log.warning(
            "pose_jumped",
            topic=topic,
            distance_m=round(jump.distance_m, 2),
            turned_rad=round(jump.turned_rad, 2),
        )
        return SkillFailed(jump.reason)


_NEARER_M = 0.1
_MOVED_M, _TURNED_RAD = 0.1, 0.35


class ExternalMotion(Motion):
    """A motion of a robot that is moved by others, as far as it is heard.

    The body's lock is held for all of its methods.
    """

    by: str
    """The means that drives it."""
    target: Target

    def begin(self, estimate: PoseEstimate) -> None:
        """Set it going."""

    def cancel(self, estimate: PoseEstimate | None) -> None:
        """Forget the target. The body holds zero velocity beside this."""

    def replaces(self, before: "ExternalMotion") -> bool:  # noqa: ARG002 - most do not
        """Whether to begin it makes the one before end by itself."""
        return False

    @abstractmethod
    def tick(self, now_s: float, estimate: PoseEstimate) -> None:
        """Go on; ends on arrival. Raises `SkillFailed` where it cannot."""

    def describe(self) -> dict[str, Any]:
        """The goal, JSON-ready, for `robot_state`."""
        progress = self.progress()
        return {
            "x": round(self.target.x_m, 3),
            "y": round(self.target.y_m, 3),
            "progress": round(progress.part, 3),
            "distance": round(progress.left, 3) if progress.unit == "m" else 0.0,
            "by": self.by,
        }


class ExternalNavigation(ExternalMotion):
    """A drive to a target: the backend's."""

    def __init__(
        self,
        target: Target,
        backend: MotionBackend,
        estimate: PoseEstimate,
        trust: LocalisationCheck,
        now_s: float,
    ) -> None:
        super().__init__()
        self.target, self.by = target, backend.name
        self.backend = backend
        self._whole_m = max(target.distance_m(estimate.pose), 1e-6)
        self._left_m = self._whole_m
        self._trust = trust
        self._watch = ProgressWatch(backend.patience, estimate.pose, self._whole_m, now_s)

    def begin(self, estimate: PoseEstimate) -> None:
        self.backend.begin(self.target, estimate)

    def cancel(self, estimate: PoseEstimate | None) -> None:
        self.backend.cancel(estimate)

    def replaces(self, before: ExternalMotion) -> bool:
        """A backend drops its old target for a new one by itself."""
        return isinstance(before, ExternalNavigation) and before.backend is self.backend

    def tick(self, now_s: float, estimate: PoseEstimate) -> None:
        """Go on; ends on arrival.

        Raises `SkillFailed` in doubt, when the backend fails, or when patience is over.
        """
        self._trust.check(estimate)
        arrived = self.backend.tick(now_s, estimate)
        self._left_m = 0.0 if arrived else self.backend.left_m(estimate)
        if arrived:
            self.end()
        else:
            self._watch.look(now_s, estimate.pose, self._left_m, waiting=self.backend.waiting)

    def progress(self) -> Progress:
        """Return the progress of the drive."""
        part = 1.0 - self._left_m / self._whole_m
        return Progress(min(max(part, 0.0), 1.0), self._left_m, "m")


class ProgressWatch:
    """Notices that a robot does not get on, whatever it does instead, such as turning."""

    def __init__(self, patience: Patience, pose: Pose2D, left_m: float, now_s: float) -> None:
        self._patience = patience
        self._looked_s = now_s
        self._place, self._moved_s = pose, now_s
        self._nearest_m, self._nearer_s = left_m, now_s
        self._last_s = now_s + patience.first_s + left_m / patience.slowest_m_s

    def look(self, now_s: float, pose: Pose2D, left_m: float, *, waiting: bool = False) -> None:
        """Raise `SkillFailed` when patience is over.

        While a robot is `waiting` patience rests, and is not renewed afterwards: else a robot that
        waits and turns by turns would never end.
        """
        if waiting:
            self._rest(now_s - self._looked_s)
        self._looked_s = now_s
        if _moved(pose, self._place):
            self._place, self._moved_s = pose, now_s
        if left_m < self._nearest_m - _NEARER_M:
            self._nearest_m, self._nearer_s = left_m, now_s
        if now_s - self._moved_s > self._patience.unmoved_s:
            raise SkillFailed(because("not_moving", left=f"{left_m:.1f}"))
        if now_s - self._nearer_s > self._patience.no_nearer_s or now_s > self._last_s:
            raise SkillFailed(because("not_closer", left=f"{left_m:.1f}"))

    def _rest(self, seconds: float) -> None:
        self._moved_s += seconds
        self._nearer_s += seconds
        self._last_s += seconds


def _moved(one: Pose2D, other: Pose2D) -> bool:
    turned = abs(turn_between(one.yaw_rad, other.yaw_rad))
    return distance_on_floor(one, other) > _MOVED_M or turned > _TURNED_RAD


RECALL_EVERY_S = 0.25
"""A goal on its way when it was cancelled would survive it: so it is cancelled again."""
HOLD_AT_LEAST_S = 1.0
SPEED_UP_RAD_S2 = 1.0
"""The acceleration of turns that EdgeVox steers."""
_LONGEST_STEP_S = 0.1
"""The longest time between two velocities for which a robot speeds up."""
LATE_S = 0.5
"""After a pause of the loop this long, messages of the meantime may wait to be read."""


class ZeroVelocity(Motion):
    """Sends zero velocity until the robot stands; fails if the robot plainly does not obey."""

    def __init__(self, now_s: float) -> None:
        super().__init__()
        self.since_s = now_s
        self.recalled_s = now_s

    def progress(self) -> Progress:
        """Return 0 or 1: the time until it stands is unknown."""
        return Progress(1.0 if self.done else 0.0)


class ControlLoop:
    """The loop; the body holds the lock for `start` and `tick`.

    `mux` decides what moves the robot. `hold` is the newest halt's. `check_driven` raises
    `SkillFailed` as soon as a drive may not go on.
    """

    def __init__(
        self,
        lock: AbstractContextManager[object],
        senses: SensorInputs,
        wheels: VelocityPublisher,
        goals: GoalTopicBackend,
        *,
        clock: Clock,
        obey_s: float,
        speed_up_m_s2: float = math.inf,
        check_driven: Callable[[], None] = lambda: None,
    ) -> None:
        self._speed_up_m_s2 = speed_up_m_s2
        self._sent, self._sent_s = STILL, clock.now()
        self._check_driven = check_driven
        self.mux: CommandMux[ExternalMotion] = CommandMux(lock, on_halt=self._stand)
        self.hold = ZeroVelocity(clock.now())
        self.hold.end()
        self._senses, self._wheels, self._goals = senses, wheels, goals
        self._clock, self._obey_s = clock, obey_s
        self._ticked_s = clock.now()
        self._reads_first = False

    def start(self, drive: ExternalMotion, estimate: PoseEstimate) -> None:
        """Drive from now on. What takes goals drops the old one for the new one by itself.

        Where a backend raises, the drive has ended with that and the robot is held.
        """
        before = self.mux.motion
        self.mux.start(lambda: drive)
        try:
            if before is not None and not drive.replaces(before):
                before.cancel(estimate)
            self.hold.end()
            drive.begin(estimate)
        except Exception as error:
            self.mux.halt(error)
            raise

    def steer(self, twist: Twist2D) -> None:
        """Turn the wheels for a drive that steers them, no faster than it may.

        They speed up by the robot's acceleration, and slow down at once.
        """
        wanted, sent = self.mux.limit(twist), self._sent
        passed_s = min(self._clock.now() - self._sent_s, _LONGEST_STEP_S)
        self._send(
            Twist2D(
                _sped_up(sent.linear_m_s, wanted.linear_m_s, self._speed_up_m_s2 * passed_s),
                _sped_up(sent.angular_rad_s, wanted.angular_rad_s, SPEED_UP_RAD_S2 * passed_s),
            )
        )

    def _send(self, twist: Twist2D) -> None:
        self._sent, self._sent_s = twist, self._clock.now()
        self._wheels.turn(twist)

    def tick(self) -> None:
        """Go on with what is asked.

        The first tick after a pause leaves a drive to the next one, when what the robot said
        meanwhile has been read: it is not silent because EdgeVox did not listen.
        """
        now_s, drive = self._clock.now(), self.mux.motion
        late, self._ticked_s = now_s - self._ticked_s > LATE_S, now_s
        self._reads_first = late and not self._reads_first
        if drive is not None:
            if not self._reads_first:
                self._go_on(drive, now_s)
        elif not self.hold.done:
            self._hold_on(self.hold, now_s)

    def _go_on(self, drive: ExternalMotion, now_s: float) -> None:
        estimate = self._senses.estimate()
        try:
            if estimate is None:
                raise SkillFailed(because("robot_silent", topic=self._senses.odom_topic))
            self._check_driven()
            drive.tick(now_s, estimate)
        except SkillFailed as failure:
            self.mux.halt(failure)

    def _stand(self, drive: ExternalMotion | None, _error: BaseException) -> None:
        """Zero velocity at once, and until the robot is seen to stand."""
        estimate, now_s = self._senses.estimate(), self._clock.now()
        held = not self.hold.done
        self._send(STILL)
        if drive is not None:
            drive.cancel(estimate)
        else:
            moving = not self._senses.odometry_history.still()
            self._goals.recall(estimate if moving and not held else None)
        if not held:
            self.hold = ZeroVelocity(now_s)
        self.hold.since_s = now_s

    def _hold_on(self, hold: ZeroVelocity, now_s: float) -> None:
        self._send(STILL)
        if now_s - hold.recalled_s >= RECALL_EVERY_S:
            hold.recalled_s = now_s
            self._goals.recall(None)
        held_s = now_s - hold.since_s
        if held_s >= HOLD_AT_LEAST_S and self._senses.odometry_history.stands(hold.since_s):
            hold.end()
        elif held_s > self._obey_s:
            problem = self._problem()
            log.error("robot_disobeys", reason=str(problem))
            hold.end(SkillFailed(problem))

    def _problem(self) -> Reason:
        if self._senses.odometry_history.fresh() is None:
            return because("stop_unseen", topic=self._senses.odom_topic)
        return because("still_moves")


def _sped_up(sent: float, wanted: float, most: float) -> float:
    """The wanted speed, but faster than the one that was sent by no more than that."""
    before = abs(sent) if sent * wanted > 0 else 0.0
    return math.copysign(min(abs(wanted), before + most), wanted)


_LATE_S = 0.2
"""How old a scan may be when it is heeded."""


class ExternalRelativeMotion(ExternalMotion):
    """A course that EdgeVox steers by odometry."""

    by = OwnSteering.name

    def __init__(
        self,
        make_course: Callable[[Pose2D, SteeringLimits], Course],
        senses: SensorInputs,
        settings: ExternalSettings,
        estimate: PoseEstimate,
        *,
        now_s: float,
        turn: Callable[[Twist2D], None],
        recall: Callable[[], object],
        sighted: bool,
    ) -> None:
        """Raises `SkillFailed` where it cannot see its way, or something is in it.

        `recall` makes what takes goals forget them, whoever sent them.
        """
        super().__init__()
        self._senses, self._turn, self._recall = senses, turn, recall
        self._trust = LocalisationCheck(senses, estimate)
        start = self._odometry()
        course = make_course(start, settings.steering)
        sighted = sighted or senses.trusted_scan() is not None
        caution = _caution(settings, sighted=sighted)
        self._relative = RelativeMotion(course, caution, senses.trusted_scan, now_s)
        self.target = _on_the_map(course.goal, start, estimate.pose)

    def begin(self, estimate: PoseEstimate) -> None:  # noqa: ARG002 - it goes by odometry
        self._recall()

    def tick(self, now_s: float, estimate: PoseEstimate) -> None:
        """Go on; ends on arrival. Raises `SkillFailed` in doubt, or where it gives up."""
        self._trust.check(estimate)
        self._turn(self._relative.go_on(now_s, self._odometry(), estimate.twist))
        if self._relative.done:
            self.end()

    def progress(self) -> Progress:
        return self._relative.progress()

    def _odometry(self) -> Pose2D:
        """Its pose in the odometry's frame, in which nothing corrects it."""
        sample = self._senses.odometry_history.fresh()
        if sample is None:
            raise SkillFailed(because("robot_silent", topic=self._senses.odom_topic))
        return sample.pose


def _caution(settings: ExternalSettings, *, sighted: bool) -> Caution:
    """The room of the steering's limits, and more for a robot that is faster than they expect."""
    limits = settings.steering
    fastest = limits.max_linear_m_s
    brake_m = fastest * _LATE_S + fastest**2 / (2 * limits.max_linear_m_s2)
    return Caution(
        half_width_m=limits.half_width_m,
        stop_ahead_m=max(limits.stop_ahead_m, limits.half_width_m + brake_m),
        wait_s=limits.wait_s,
        patience_s=settings.steering_patience.unmoved_s,
        sighted=sighted,
    )


def _on_the_map(goal: Pose2D, start: Pose2D, here: Pose2D) -> Target:
    """A goal of the odometry's frame on the map: `start` and `here` are the same place."""
    turned = here.yaw_rad - start.yaw_rad
    origin = compose_on_floor(Pose2D(here.x_m, here.y_m, turned), Pose2D(-start.x_m, -start.y_m, 0))
    there = compose_on_floor(origin, goal)
    return Target(there.x_m, there.y_m, turn_between(0.0, there.yaw_rad))
