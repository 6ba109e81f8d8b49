"""What an agent is made of."""

from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Protocol

from edgevox.agent.conversation import Conversation
from edgevox.agent.llm.language_model import LanguageModel
from edgevox.agent.policy import Guard
from edgevox.agent.skills import Skill
from edgevox.apps.command_router import CommandRouter
from edgevox.apps.queries import Queries
from edgevox.apps.skill_setup import RobotSkills
from edgevox.apps.voice import VoiceChain
from edgevox.core.bus import Bus
from edgevox.core.controls import Controls
from edgevox.core.drain import Drain
from edgevox.core.interlock import Interlock
from edgevox.core.settings import Settings
from edgevox.core.software_stop import SoftwareStop
from edgevox.core.status import Components
from edgevox.ops.health_checks import Health
from edgevox.robots.capabilities import Body
from edgevox.voice.listener import Listener

if TYPE_CHECKING:
    from edgevox.ops.metrics import Registry


class Startable(Protocol):
    """Something with a lifetime."""

    def start(self) -> None: ...

    def close(self) -> None: ...


@dataclass(frozen=True)
class AgentParts:
    """An agent: what it is made of, none of it started.

    Without a `body` it only talks, without a `voice` it only writes. `absent` says why there is no
    language model on board though one was asked for. `notes` are lines that a full screen would
    hide and shows again.
    """

    settings: Settings
    bus: Bus
    body: Body | None
    controls: Controls
    queries: Queries
    conversation: Conversation
    command_router: CommandRouter
    model: LanguageModel | None
    voice: VoiceChain | None
    listener: Listener | None
    components: Components
    health: Health
    model_path: Path | None
    metrics: "Registry | None"
    absent: str = ""
    interlock: Interlock = field(default_factory=Interlock)
    guard: Guard = field(default_factory=Guard)
    robot_skills: RobotSkills = field(default_factory=RobotSkills)
    software_stop: SoftwareStop = field(kw_only=True)
    drain: Drain = field(kw_only=True)
    notes: list[str] = field(default_factory=list)

    @property
    def skills(self) -> tuple[Skill, ...]:
        """What its robot can be asked to do."""
        return self.robot_skills.skills

    @property
    def name(self) -> str:
        """What it is called."""
        return self.body.name if self.body else "edgevox"
