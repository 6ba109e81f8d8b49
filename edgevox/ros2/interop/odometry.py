"""Where the odometry frame is on the map.

REP 105 wants two things of it: a pose in `odom` never jumps, and `map -> odom -> base_link` is the
pose on the map. The body knows its true pose, so `odom` is where the robot was at the start and
stays there, until somebody puts the robot elsewhere (a reset): then `odom` moves with it.
"""

from edgevox.core.transforms import IDENTITY, Pose3D, angle, compose, distance, inverse

_SLACK_M = 0.05
_SLACK_RAD = 0.2
_HURRY = 2.0
"""A step so many times as large as the body's speed allows is no motion."""


class Odometer:
    """Keeps `map -> odom`. `max_linear_m_s` and `max_angular_rad_s` are the body's limits."""

    def __init__(self, max_linear_m_s: float, max_angular_rad_s: float) -> None:
        self._max_linear_m_s = max_linear_m_s
        self._max_angular_rad_s = max_angular_rad_s
        self._before: tuple[float, Pose3D] | None = None
        self._odom_to_base = IDENTITY
        self.map_to_odom = IDENTITY

    def move(self, time_s: float, pose: Pose3D) -> Pose3D:
        """The pose in `odom`, from that on the map."""
        before = self._before
        if before is not None and before[1] == pose:  # a robot at rest is asked all the time
            self._before = time_s, pose
            return self._odom_to_base
        if before is None or self._jumped(*before, time_s, pose):
            self.map_to_odom = compose(pose, inverse(self._odom_to_base))
        self._odom_to_base = compose(inverse(self.map_to_odom), pose)
        self._before = time_s, pose
        return self._odom_to_base

    def _jumped(self, then_s: float, then: Pose3D, now_s: float, now: Pose3D) -> bool:
        passed_s = max(now_s - then_s, 0.0)
        far_m = _SLACK_M + _HURRY * self._max_linear_m_s * passed_s
        far_rad = _SLACK_RAD + _HURRY * self._max_angular_rad_s * passed_s
        return distance(then, now) > far_m or angle(then, now) > far_rad
