"""What a bridge is connected to, on EdgeVox's side. Knows nothing of rclpy."""

from collections.abc import Callable
from dataclasses import dataclass

from edgevox.core.bus import Bus
from edgevox.core.controls import Controls
from edgevox.core.settings import Settings
from edgevox.robots.capabilities import Body
from edgevox.ros2.contract import Incoming, Queries
from edgevox.ros2.skill_requests import StartsGoals


@dataclass(frozen=True)
class Wiring:
    """Events come from `bus`, commands go to `submit`, which raises `InvalidValue`.

    `body` and `goals` belong to an agent that has a body; without one there is neither
    `robot_state` nor `agent_event`, no robot's topics and no action.
    """

    settings: Settings
    bus: Bus
    submit: Callable[[Incoming], None]
    controls: Controls
    queries: Queries
    body: Body | None = None
    goals: StartsGoals | None = None
