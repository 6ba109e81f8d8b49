"""How fast the wheels of a 2D robot change their speed: within its limits, but to brake."""

from edgevox.robots.capabilities import Twist2D
from edgevox.robots.command_mux import STILL, clamped
from edgevox.robots.engine import STEP_S
from edgevox.robots.world_model import RobotSpec


class VelocityRamp:
    """`velocity` is what the wheels are asked for now. Not thread-safe; the body locks."""

    def __init__(self, limits: RobotSpec) -> None:
        self.velocity = STILL
        self._linear_m_s = limits.max_linear_m_s2 * STEP_S
        self._angular_rad_s = limits.max_angular_rad_s2 * STEP_S

    def step(self, wanted: Twist2D | None) -> Twist2D:
        """The velocity of the next step; it brakes as hard as it can where nothing is wanted."""
        if wanted is None:
            self.brake()
        else:
            now = self.velocity
            self.velocity = Twist2D(
                _toward(now.linear_m_s, wanted.linear_m_s, self._linear_m_s),
                _toward(now.angular_rad_s, wanted.angular_rad_s, self._angular_rad_s),
            )
        return self.velocity

    def brake(self) -> None:
        """Ask for a stand at once."""
        self.velocity = STILL


def _toward(now: float, wanted: float, most: float) -> float:
    return wanted if -most <= wanted - now <= most else now + clamped(wanted - now, most)
