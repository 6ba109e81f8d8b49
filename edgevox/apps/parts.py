"""What an agent is made of."""

from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Protocol

from edgevox.agent.conversation import Conversation
from edgevox.agent.llm.base import LanguageModel
from edgevox.agent.policy import Guard
from edgevox.apps.queries import Queries
from edgevox.apps.switchboard import Switchboard
from edgevox.apps.voice import Voice
from edgevox.core.bus import Bus
from edgevox.core.controls import Controls
from edgevox.core.interlock import Interlock
from edgevox.core.settings import Settings
from edgevox.core.status import Components
from edgevox.ops.health import Health
from edgevox.robots.capabilities import Body
from edgevox.voice.ears import Ears

if TYPE_CHECKING:
    from edgevox.ops.metrics import Registry


class Part(Protocol):
    """Something with a lifetime."""

    def start(self) -> None: ...

    def close(self) -> None: ...


@dataclass(frozen=True)
class Parts:
    """An agent: what it is made of, none of it started.

    Without a `body` it only talks, without a `voice` it only writes. `absent` says why there is no
    language model on board though one was asked for.
    """

    settings: Settings
    bus: Bus
    body: Body | None
    controls: Controls
    queries: Queries
    conversation: Conversation
    switchboard: Switchboard
    model: LanguageModel | None
    voice: Voice | None
    ears: Ears | None
    components: Components
    health: Health
    model_path: Path | None
    metrics: "Registry | None"
    absent: str = ""
    interlock: Interlock = field(default_factory=Interlock)
    guard: Guard = field(default_factory=Guard)

    @property
    def name(self) -> str:
        """What it is called."""
        return self.body.name if self.body else "edgevox"
