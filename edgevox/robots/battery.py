"""A battery: what the robot does costs energy, standing on the dock brings it back.

Power drawn is `idle_w` always, and for actual motion `linear_w_per_m_s` for each metre per second
and `angular_w_per_rad_s` for each radian per second. Within `DOCK_REACH_M` of the dock, standing,
it charges with `charge_w`.
"""

import math

from edgevox.core.transforms import Pose2D
from edgevox.robots.capabilities import Twist2D
from edgevox.robots.shapes import Point
from edgevox.robots.world_model import BatterySpec

DOCK_REACH_M = 0.3
_STANDING_M_S = 0.02


class Battery:
    """Charge of one robot."""

    def __init__(self, spec: BatterySpec, dock: Point) -> None:
        self._spec = spec
        self._dock = dock
        self._left_wh = spec.capacity_wh

    @property
    def charge(self) -> float:
        """What is left, 0 to 1."""
        return self._left_wh / self._spec.capacity_wh

    @property
    def empty(self) -> bool:
        return self._left_wh <= 0.0

    def step(self, seconds: float, pose: Pose2D, twist: Twist2D) -> None:
        """Account for this much time at this place with this motion."""
        spec = self._spec
        speed, turning = abs(twist.linear_m_s), abs(twist.angular_rad_s)
        power_w = spec.idle_w + spec.linear_w_per_m_s * speed + spec.angular_w_per_rad_s * turning
        if speed < _STANDING_M_S and math.dist((pose.x_m, pose.y_m), self._dock) <= DOCK_REACH_M:
            power_w -= spec.charge_w
        left = self._left_wh - power_w * seconds / 3600.0
        self._left_wh = min(max(left, 0.0), spec.capacity_wh)
