"""Puts an agent together, by hand, and takes it apart in reverse order."""

from collections.abc import Sequence
from contextlib import ExitStack
from dataclasses import dataclass
from typing import Protocol

from edgevox.agent.conversation import Conversation
from edgevox.agent.llm.base import LanguageModel
from edgevox.agent.llm.primer import Primer
from edgevox.apps.language_model import find_weights, open_model
from edgevox.apps.queries import Queries, available_voices, build_queries
from edgevox.apps.robots import build_agents
from edgevox.apps.switchboard import Switchboard
from edgevox.apps.voice import Voice, build_ears, build_voice, warm_up
from edgevox.core.bus import Bus
from edgevox.core.controls import Controls
from edgevox.core.events import ControlChanged
from edgevox.core.settings import Settings
from edgevox.ops.health import Health, lives, moves
from edgevox.robots.capabilities import Body, TellsStalls
from edgevox.ros2 import Wiring, open_bridge
from edgevox.voice.ears import Ears


class Part(Protocol):
    """Something with a lifetime."""

    def start(self) -> None: ...

    def close(self) -> None: ...


@dataclass(frozen=True)
class Parts:
    """An agent: what it is made of, none of it started.

    Without a `body` it only talks, without a `voice` it only writes.
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
    health: Health

    @property
    def name(self) -> str:
        """What it is called."""
        return self.body.name if self.body else "edgevox"


def build_parts(stack: ExitStack, settings: Settings, body: Body | None) -> Parts:
    """Make everything; what must be closed is left to the stack. Raises `EdgeVoxError`.

    Only health is served from now on: a model may take long to load.
    """
    health = _serve_health(stack, settings)
    bus = Bus()
    controls = Controls(
        bus,
        language=settings.language,
        voice=settings.voice,
        muted=settings.muted,
        voices=available_voices,
    )
    voice = None if settings.text_mode else build_voice(stack, settings, bus, controls)
    model_path = find_weights(settings)
    model = open_model(settings, model_path)
    if model:
        stack.callback(model.close)
    conversation = Conversation(
        build_agents(body),
        bus,
        halt=body.halt if body else lambda _: False,
        model=model,
        mouth=voice.mouth if voice else None,
        language=settings.language,
    )
    bus.subscribe(ControlChanged, lambda change: _follow(conversation, change))
    queries = build_queries(
        controls,
        model_path,
        endpoint=settings.llm_endpoint,
        **(voice.infos(controls) if voice else {}),
    )
    switchboard = Switchboard(conversation, controls, queries, bus)
    ears = (
        build_ears(
            voice,
            settings,
            bus,
            controls,
            submit=switchboard.submit,
            is_stop=conversation.is_stop,
        )
        if voice
        else None
    )
    return Parts(
        settings,
        bus,
        body,
        controls,
        queries,
        conversation,
        switchboard,
        model,
        voice,
        ears,
        health,
    )


def start_parts(stack: ExitStack, parts: Parts, ros_args: Sequence[str] = ()) -> None:
    """Start everything, from the body outwards; what is closed last is started first.

    With a voice, everything is loaded and warm when this returns: who speaks does not wait. Typed
    commands never need the model, so without a voice nobody waits for it here.
    """
    if parts.body:
        start(stack, parts.body)
    if parts.voice:
        start(stack, parts.voice.mouth)
    _watch(parts)
    if parts.settings.ros2:
        bridge = open_bridge(_wiring(parts), ros_args)
        start(stack, bridge)
        print(f"ROS 2: {bridge.where}", flush=True)
        parts.health.watch("ros2", moves(lambda: bridge.stalled_s))
        parts.health.require("rclpy", lambda: bridge.missing)
    primer = Primer(parts.model, parts.conversation.mind.chat()) if parts.model else None
    if primer:
        start(stack, primer)
    if parts.voice:
        print("warming up ...", flush=True)
        warm_up(parts.voice, parts.controls.language)
        if primer:
            primer.wait()
    start(stack, parts.conversation)  # late, so that its first state is heard on the bridge
    if parts.ears:
        start(stack, parts.ears)
    parts.health.started()


def _serve_health(stack: ExitStack, settings: Settings) -> Health:
    health = Health()
    if settings.health_port:
        from edgevox.ops.health_server import HealthServer

        start(stack, HealthServer(health, settings.health_host, settings.health_port))
    return health


def _watch(parts: Parts) -> None:
    """What the process cannot do its work without."""
    health, body, voice, ears = parts.health, parts.body, parts.voice, parts.ears
    health.watch("conversation", lives(lambda: parts.conversation.alive))
    if isinstance(body, TellsStalls):
        health.watch("body", moves(lambda: body.stalled_s))
    if voice:
        health.watch("mouth", lives(lambda: voice.mouth.alive))
    if ears:
        health.watch("ears", lives(lambda: ears.alive))


def _wiring(parts: Parts) -> Wiring:
    voice = parts.voice
    return Wiring(
        parts.settings,
        parts.bus,
        parts.switchboard.submit,
        parts.controls,
        parts.queries,
        parts.body,
        parts.conversation if parts.body else None,
        voice.microphone if voice else None,
        voice.relay if voice else None,
    )


def start(stack: ExitStack, part: Part) -> None:
    """Start it, and leave its end to the stack."""
    stack.callback(part.close)
    part.start()


def _follow(conversation: Conversation, change: ControlChanged) -> None:
    if change.name == "language":
        conversation.set_language(str(change.value))
