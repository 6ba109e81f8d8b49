"""The parts of an agent, and the router that sends each command to its part."""

from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Protocol

from edgevox.agent.conversation import Conversation
from edgevox.agent.llm.language_model import LanguageModel
from edgevox.agent.policy import Guard
from edgevox.agent.skills import Skill
from edgevox.apps.agent.queries import Queries
from edgevox.apps.agent.voice import VoiceChain
from edgevox.apps.robots import RobotSkills
from edgevox.core.bus import Bus
from edgevox.core.commands import Command, Query, SetLanguage, SetMuted, SetVoice
from edgevox.core.controls import Controls
from edgevox.core.errors import InvalidValue
from edgevox.core.events import Answered
from edgevox.core.hearers import Hearers
from edgevox.core.motion.drain import Drain
from edgevox.core.motion.interlock import Interlock
from edgevox.core.motion.software_stop import SoftwareStop
from edgevox.core.settings import Settings
from edgevox.core.status import Components
from edgevox.ops.health import Health
from edgevox.robots.capabilities import Body
from edgevox.voice.listener import Listener

if TYPE_CHECKING:
    from edgevox.ops.metrics import Registry


class CommandRouter:
    """Takes every command, from any thread; raises `InvalidValue` for one it cannot honour."""

    def __init__(
        self, conversation: Conversation, controls: Controls, queries: Queries, bus: Bus
    ) -> None:
        self._conversation = conversation
        self._controls = controls
        self._queries = queries
        self._bus = bus

    def submit(self, command: Command, mark: int | None = None) -> None:
        """Take a command, on the caller's thread: what a part other than the conversation does.

        The conversation dispatches the rest by when it is done, at once or in its turn
        (`Conversation.submit`), and what waited for its turn by what is done (its own thread).
        `mark` is the interlock's when the command was received, now by default.
        """
        match command:
            case SetLanguage(code=code):
                self._controls.change({"language": code.strip()})
            case SetVoice(name=name):
                self._controls.change({"voice": name.strip()})
            case SetMuted(muted=muted):
                self._controls.change({"muted": muted})
            case Query(name=name):
                if name not in self._queries:
                    raise InvalidValue("query", name, "one of " + ", ".join(self._queries))
                self._bus.publish(Answered(name, self._queries[name]()))
            case _:
                self._conversation.submit(command, mark)


class Startable(Protocol):
    """Something with a lifetime."""

    def start(self) -> None: ...

    def close(self) -> None: ...


@dataclass(frozen=True)
class AgentParts:
    """The parts of an agent, none of them started."""

    settings: Settings
    bus: Bus
    body: Body | None
    """None for an agent that only talks."""
    controls: Controls
    queries: Queries
    conversation: Conversation
    command_router: CommandRouter
    model: LanguageModel | None
    voice: VoiceChain | None
    """None for an agent that only writes."""
    listener: Listener | None
    components: Components
    health: Health
    model_path: Path | None
    metrics: "Registry | None"
    absent: str = ""
    """The reason why the wanted language model on board is missing."""
    interlock: Interlock = field(default_factory=Interlock)
    guard: Guard = field(default_factory=Guard)
    robot_skills: RobotSkills = field(default_factory=RobotSkills)
    software_stop: SoftwareStop = field(kw_only=True)
    drain: Drain = field(kw_only=True)
    hearers: Hearers | None = None
    """The robots of its group that hear the same person; None without a group."""
    notes: list[str] = field(default_factory=list)
    """Lines that a full screen would hide and shows again."""

    @property
    def skills(self) -> tuple[Skill, ...]:
        """The skills of its robot."""
        return self.robot_skills.skills

    @property
    def name(self) -> str:
        """The agent's name."""
        return self.body.name if self.body else "edgevox"
