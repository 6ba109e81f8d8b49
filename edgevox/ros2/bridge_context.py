"""What a bridge is connected to, on EdgeVox's side. Knows nothing of rclpy."""

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from edgevox.agent.policy import Guard
from edgevox.core.bus import Bus
from edgevox.core.commands import Submit
from edgevox.core.controls import Controls
from edgevox.core.motion.interlock import Interlock
from edgevox.core.settings import Settings
from edgevox.core.status import Components
from edgevox.robots.capabilities import Body
from edgevox.ros2.contract import Queries
from edgevox.ros2.skill_requests import StartsGoals
from edgevox.voice.sinks.relay import Relay
from edgevox.voice.sources.pushed import Pushed

if TYPE_CHECKING:
    from edgevox.ros2.clients.agent_node_handle import AgentNodeHandle


@dataclass(frozen=True)
class BridgeContext:
    """Events come from `bus`, commands go to `submit`, which raises `InvalidValue`.

    `body` and `goals` belong to an agent that has a body; without one there is neither
    `robot_state` nor `agent_event`, no robot's topics and no action. `audio_in` is filled from a
    topic, `audio_out` is sent to one. `components` say how they are. `interlock` is
    engaged while another agent of the namespace moves the robot. `guard` is asked of velocities and
    of what comes on `command`; of goals the one who runs them asks. `handle` is lent the node, for
    skills.
    """

    settings: Settings
    bus: Bus
    submit: Submit
    controls: Controls
    queries: Queries
    body: Body | None = None
    goals: StartsGoals | None = None
    audio_in: Pushed | None = None
    audio_out: Relay | None = None
    components: Components | None = None
    interlock: Interlock = field(default_factory=Interlock)
    guard: Guard = field(default_factory=Guard)
    handle: "AgentNodeHandle | None" = None
