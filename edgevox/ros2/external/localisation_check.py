"""Whether a drive may go on by what is heard of where the robot is."""

from edgevox.agent.skills import SkillFailed
from edgevox.core.log import get_logger
from edgevox.ros2.external.motion_bounds import MOST_CORRECTION_M, Jump, on_the_map
from edgevox.ros2.external.sensor_inputs import SensorInputs, incredible
from edgevox.ros2.external.target import PoseEstimate

log = get_logger(__name__)


class LocalisationCheck:
    """Made when a drive begins, and looked at whenever it goes on.

    Odometry runs smoothly; localisation may correct it by some metres. What jumps further ends the
    drive, and is where the robot is for the next one.
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
