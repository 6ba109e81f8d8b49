"""The objects of EdgeVox that a bridge connects to ROS 2. Does not import rclpy."""

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
    """EdgeVox's side of a bridge."""

    settings: Settings
    bus: Bus
    """Source of the events that go out."""
    submit: Submit
    """Takes each command; raises `InvalidValue`."""
    controls: Controls
    queries: Queries
    body: Body | None = None
    """None for an agent without a robot: then there are no `robot_state`, `agent_event`, robot
    topics or action."""
    goals: StartsGoals | None = None
    """Runs the skills of `execute_skill`; None without a body."""
    audio_in: Pushed | None = None
    """Filled from the topic `audio_in`."""
    audio_out: Relay | None = None
    """Sent to the topic `audio_out`."""
    components: Components | None = None
    """The components that report their status."""
    interlock: Interlock = field(default_factory=Interlock)
    """Engaged while another agent of the namespace moves the robot."""
    guard: Guard = field(default_factory=Guard)
    """The policy for velocities and for `command`; goals are judged by `goals`."""
    handle: "AgentNodeHandle | None" = None
    """Lends the node to skills."""
