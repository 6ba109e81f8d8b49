"""A short motion on ``cmd_vel`` by the robot's odometry: some metres straight on, or a turn.

What takes goals could lead the robot round an obstacle, and localisation could move its line: so
EdgeVox steers these itself, in the odometry's frame.
"""

from collections.abc import Callable

from edgevox.agent.skills import SkillFailed
from edgevox.agent.text.reasons import because
from edgevox.core.transforms import Pose2D, compose_on_floor, turn_between
from edgevox.robots.capabilities import Twist2D
from edgevox.robots.motion import Progress
from edgevox.robots.relative_motion import Caution, Course, RelativeMotion
from edgevox.ros2.external.inputs import SensorInputs
from edgevox.ros2.external.motion import OwnSteering, PoseEstimate, Target
from edgevox.ros2.external.navigation import ExternalMotion, LocalisationCheck
from edgevox.ros2.external.settings import ExternalSettings, SteeringLimits

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
