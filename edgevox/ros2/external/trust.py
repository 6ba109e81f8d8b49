"""Whether a drive may go on by what is heard of where the robot is."""

from edgevox.agent.skills import SkillFailed
from edgevox.core.log import get_logger
from edgevox.ros2.external.plausible import MOST_CORRECTION_M, Jump, on_the_map
from edgevox.ros2.external.senses import Senses, incredible
from edgevox.ros2.external.target import Fix

log = get_logger(__name__)


class Trust:
    """Made when a drive begins, and looked at whenever it goes on.

    Odometry runs smoothly; localisation may correct it by some metres. What jumps further ends the
    drive, and is where the robot is for the next one.
    """

    def __init__(self, senses: Senses, fix: Fix) -> None:
        self._senses = senses
        self._before = fix
        doubt = senses.sightings.doubt
        self._doubts = doubt.number if doubt else 0

    def check(self, fix: Fix) -> None:
        """Raises `SkillFailed` with the reason why the robot must not go on by this."""
        doubt = self._senses.sightings.doubt
        if doubt and doubt.number > self._doubts:
            if doubt.jump is None:
                raise incredible(self._senses.odom_topic)
            raise self._jumped(doubt.jump, self._senses.odom_topic)
        if not on_the_map(fix.pose):
            raise incredible(self._senses.tf_topic)
        before, self._before = self._before, fix
        jump = Jump.between(before.pose, fix.pose)
        if jump.distance_m > MOST_CORRECTION_M or before.frame != fix.frame:
            raise self._jumped(jump, self._senses.tf_topic)

    def _jumped(self, jump: Jump, topic: str) -> SkillFailed:
        log.warning(
            "pose_jumped",
            topic=topic,
            distance_m=round(jump.distance_m, 2),
            turned_rad=round(jump.turned_rad, 2),
        )
        return SkillFailed(jump.reason)
