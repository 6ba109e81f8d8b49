"""The construction of an agent by hand, its service, and its closing in reverse order.

Also here: an agent's drain, its components, each of which reports its status, and the arguments of
skills that may hold a person's own words.
"""

import time
from collections.abc import Callable, Sequence
from contextlib import ExitStack
from pathlib import Path

from edgevox import __version__
from edgevox.agent.agents import Agent
from edgevox.agent.conversation import Conversation
from edgevox.agent.known import NOTHING_KNOWN
from edgevox.agent.llm.language_model import LanguageModel, LlmComponent, ModelFailed
from edgevox.agent.llm.prompt import PromptPrefill
from edgevox.agent.policy.guard import PolicyComponent
from edgevox.agent.text.reasons import because
from edgevox.apps.agent.models import (
    find_weights,
    open_decider,
    open_model,
    open_phonemes,
    open_without,
)
from edgevox.apps.agent.parts import AgentParts, CommandRouter, Startable
from edgevox.apps.agent.policy import build_guard, known_names, log_strange_names
from edgevox.apps.agent.queries import available_voices, build_queries, deafness
from edgevox.apps.agent.voice import build_listener, build_voice, endings, warm_up_hearing
from edgevox.apps.console.serve_console import serve_console
from edgevox.apps.folders import needed_folders, written_folders
from edgevox.apps.metrics import read_bridge, read_parts, serve_metrics
from edgevox.apps.robots import build_agents, gather_skills
from edgevox.apps.run_program import ShutdownSignals
from edgevox.apps.streams import show
from edgevox.apps.terminal import run_terminal
from edgevox.core.bus import Bus
from edgevox.core.commands import Speak
from edgevox.core.controls import Controls
from edgevox.core.errors import InvalidValue
from edgevox.core.events import (
    ControlChanged,
    SentenceReady,
    State,
    StateChanged,
)
from edgevox.core.hearers import Hearers
from edgevox.core.log import get_logger
from edgevox.core.motion.drain import Drain
from edgevox.core.motion.interlock import Interlock, InterlockComponent
from edgevox.core.motion.software_stop import SoftwareStop
from edgevox.core.settings import Settings
from edgevox.core.status import (
    Component,
    ComponentName,
    Components,
    Gauges,
    HealthCheck,
    Off,
    lives,
)
from edgevox.models import ModelMissing
from edgevox.ops.health import Health
from edgevox.ops.logs import BusLog
from edgevox.ops.machine import ClockComponent, DiskComponent, ProcessComponent
from edgevox.robots.capabilities import Body, HasPicture, HasPose
from edgevox.robots.facts import known_of
from edgevox.robots.flat.viewer import Viewer, has_display
from edgevox.robots.sim_loop import SimComponent
from edgevox.ros2 import BridgeContext, open_bridge
from edgevox.voice.status import AudioComponent, SttComponent, TtsComponent

log = get_logger(__name__)

STANDS_M_S, STANDS_RAD_S = 0.01, 0.01
"""Slower than this, a robot stands: a simulated one comes to rest, a real one never measures
zero."""


def build_drain(
    settings: Settings, interlock: Interlock, bus: Bus, body: Body | None, talk: Conversation
) -> Drain:
    """Build the drain.

    It waits for goals as long as the settings say, then half of `leave_s` for a stand.
    """
    return Drain(
        interlock,
        bus,
        halt=body.halt if body else lambda _: False,
        busy=lambda: talk.busy,
        stands=lambda: stands(body),
        reason=because("draining"),
        bound_s=settings.drain_s,
        stand_s=settings.leave_s / 2,
    )


def stands(body: Body | None) -> bool:
    """Return whether the body stands; without a velocity, it stands once it was halted."""
    if not isinstance(body, HasPose):
        return True
    now = body.velocity()
    return abs(now.linear_m_s) < STANDS_M_S and abs(now.angular_rad_s) < STANDS_RAD_S


def free_text(agents: Sequence[Agent]) -> Callable[[str, str], bool]:
    """Return a test whether an argument, by its skill's name and its own, takes any words.

    An argument of an unknown skill does.
    """
    free = {name: one.free_text for agent in agents for name, one in agent.skills.items()}
    return lambda skill, argument: skill not in free or argument in free[skill]


def build_parts(stack: ExitStack, settings: Settings, body: Body | None) -> AgentParts:
    """Make everything; what must be closed is left to the stack. Raises `EdgeVoxError`.

    Only health and metrics are served from now on: a model may take long to load.
    """
    components = Components()
    health = _serve_health(stack, settings, components)
    bus = Bus()
    guard = build_guard(settings, bus, body)
    robot_skills = gather_skills(body, settings, bus)
    log_strange_names(guard, robot_skills.skills)
    agents = build_agents(body, robot_skills.skills)
    stack.callback(BusLog(bus, free_text(agents)).close)
    metrics = serve_metrics(stack, settings, bus, components, health, skills=robot_skills.skills)
    controls = Controls(
        bus,
        language=settings.language,
        voice=settings.voice,
        muted=settings.muted,
        confirm=settings.confirm,
        voices=available_voices,
        deafness=(lambda _: "") if settings.text_mode else deafness,
    )
    voice = (
        None
        if settings.text_mode
        else build_voice(stack, settings, bus, controls, robot_skills.skills)
    )
    model, model_path, absent = _think(settings)
    if model:
        stack.callback(model.close)
    interlock = Interlock()
    hearers = _open_hearers(settings, bus) if voice else None
    halt = body.halt if body else lambda _: False
    conversation = Conversation(
        agents,
        bus,
        halt=halt,
        model=model,
        speech_output=voice.speech_output if voice else None,
        language=settings.language,
        confirm=settings.confirm,
        interlock=interlock,
        guard=guard,
        decider=open_decider(),
        phonemes=open_phonemes() if voice else None,
        known=known_of(body) if body else NOTHING_KNOWN,
        follow_up_s=settings.follow_up_s,
        hearers=hearers,
    )
    bus.subscribe(ControlChanged, lambda change: _follow(conversation, change))
    software_stop = SoftwareStop(interlock, bus, conversation.stop, because("software_stop"))
    drain = build_drain(settings, interlock, bus, body, conversation)
    health.offer(drain)
    queries = build_queries(
        controls,
        model_path,
        endpoint=settings.llm_endpoint,
        programs=conversation.programs.listed,
        **(voice.infos(controls) if voice else {}),
    )
    command_router = CommandRouter(conversation, controls, queries, bus)
    listener = (
        build_listener(
            voice,
            settings,
            bus,
            controls,
            submit=command_router.submit,
            is_stop=conversation.is_stop,
            follow_up=conversation.follow_ups,
            ending=endings(conversation).of,
            guard=guard,
            on_utterance=hearers.heard if hearers else None,
        )
        if voice
        else None
    )
    return AgentParts(
        settings,
        bus,
        body,
        controls,
        queries,
        conversation,
        command_router,
        model,
        voice,
        listener,
        components,
        health,
        model_path,
        metrics,
        absent,
        interlock,
        guard,
        robot_skills,
        software_stop=software_stop,
        drain=drain,
        hearers=hearers,
    )


def _open_hearers(settings: Settings, bus: Bus) -> Hearers | None:
    """Open the robots of its group; None without a group. Raises `InvalidValue` without ROS 2."""
    if not settings.answer_group:
        return None
    if not settings.ros2:
        raise InvalidValue("answer_group", settings.answer_group, "--ros2 beside it")
    name = settings.spoken_name or settings.agent_namespace.strip("/").replace("_", " ")
    hearers = Hearers(name, settings.answer_group)
    bus.subscribe(SentenceReady, lambda event: hearers.says(event.text))
    bus.subscribe(StateChanged, lambda event: hearers.speaks(event.state is State.SPEAKING))
    return hearers


def start_parts(stack: ExitStack, parts: AgentParts, ros_args: Sequence[str] = ()) -> None:
    """Start everything, from the body outwards; the last to close is the first to start.

    When this returns, typed and spoken commands work. The voice and the prompt of the language
    model are loaded afterwards, one after the other, so that a command meanwhile does not wait for
    them.
    """
    if parts.body:
        start(stack, parts.body)
    if parts.voice:
        start(stack, parts.voice.speech_output)
    read_parts(parts)
    gauges = Gauges(parts.bus)
    stack.callback(gauges.close)
    list_components(parts, gauges)
    parts.health.add(HealthCheck("conversation", lives(lambda: parts.conversation.alive)))
    if parts.settings.ros2:
        bridge = open_bridge(_bridge_context(parts), ros_args)
        parts.components.add(*bridge.components)
        read_bridge(parts, bridge)
        start(stack, bridge)
        show(f"ROS 2: {bridge.where}")
    if parts.settings.serves_console:
        serve_console(stack, parts)
    prefill = _prefill(stack, parts)
    start(stack, parts.conversation)  # after the bridge, so that its first state is heard there
    if parts.voice and parts.listener:
        show("warming up ...")
        warm_up_hearing(parts.voice, parts.controls.language)
        start(stack, parts.listener)
        parts.voice.speech_output.prepare()
    if prefill:
        prefill.start()
    if parts.absent:
        phrases = parts.conversation.interpreter.phrases
        parts.conversation.submit(Speak(phrases.say("model_failed")))
    parts.health.started()


def _prefill(stack: ExitStack, parts: AgentParts) -> PromptPrefill | None:
    """Read the prompt into the model, after the voice has warmed up. Closed after its users.

    The conversation has not begun: from then on only the conversation may use its interpreter.
    """
    if parts.model is None:
        return None
    opening = parts.conversation.interpreter.chat()
    after = parts.voice.speech_output.warm_up if parts.voice else None
    prefill = PromptPrefill(parts.model, opening, after=after)
    stack.callback(prefill.close)
    return prefill


def _think(settings: Settings) -> tuple[LanguageModel | None, Path | None, str]:
    """Open the language model; return it, its file, and the reason if a wanted one is missing.

    Plain commands need no model, so a robot that lacks its own comes up, and says so.
    """
    try:
        weights = find_weights(settings)
        return open_model(settings, weights), weights, ""
    except (ModelMissing, ModelFailed) as error:
        absent = str(error)
        log.error("llm_missing", reason=absent)  # noqa: TRY400 - the reason says it all
        return open_without(settings, absent), None, absent


def _serve_health(stack: ExitStack, settings: Settings, components: Components) -> Health:
    health = Health(components)
    if settings.health_port:
        from edgevox.ops.health import HealthServer

        start(stack, HealthServer(health, settings.health_host, settings.health_port))
    return health


def _bridge_context(parts: AgentParts) -> BridgeContext:
    voice = parts.voice
    return BridgeContext(
        parts.settings,
        parts.bus,
        parts.command_router.submit,
        parts.controls,
        parts.queries,
        parts.body,
        parts.conversation if parts.body else None,
        voice.microphone if voice else None,
        voice.relay if voice else None,
        parts.components,
        parts.interlock,
        parts.guard,
        parts.robot_skills.handle,
        parts.hearers,
    )


def start(stack: ExitStack, part: Startable) -> None:
    """Start it, and leave its end to the stack."""
    stack.callback(part.close)
    part.start()


def _follow(conversation: Conversation, change: ControlChanged) -> None:
    match change:
        case ControlChanged(name="language", value=code):
            conversation.set_language(str(code))
        case ControlChanged(name="confirm", value=("always" | "unsure" | "never") as confirm):
            conversation.set_confirm(confirm)


TYPED = "text is typed"


def list_components(parts: AgentParts, gauges: Gauges) -> None:
    """List all; executor and presence are off until a bridge is there, which lists its own."""
    audio, stt, tts = _of_voice(parts, gauges)
    parts.components.add(
        audio,
        stt,
        _llm(parts, gauges),
        tts,
        SimComponent(parts.body) if parts.body else Off(ComponentName.SIM, "no robot"),
        Off(ComponentName.EXECUTOR, "no ROS 2"),
        Off(ComponentName.PRESENCE, "no ROS 2"),
        InterlockComponent(parts.interlock),
        Off(ComponentName.CONSOLE, "not asked for"),
        Off(ComponentName.RECORDINGS, "no console"),
        Off(ComponentName.RECORDER, "no ROS 2"),
        PolicyComponent(parts.guard, lambda: known_names(parts.skills)),
        DiskComponent(
            lambda: written_folders(parts.settings), lambda: needed_folders(parts.settings)
        ),
        ClockComponent(),
        ProcessComponent(parts.health, __version__, lambda: parts.conversation.refusals),
    )


def _of_voice(parts: AgentParts, gauges: Gauges) -> tuple[Component, Component, Component]:
    voice, listener, controls = parts.voice, parts.listener, parts.controls
    if not voice or not listener:
        return (
            Off(ComponentName.AUDIO, TYPED),
            Off(ComponentName.STT, TYPED),
            Off(ComponentName.TTS, TYPED),
        )
    return (
        AudioComponent(
            voice.source,
            voice.sink,
            listener,
            voice.speech_output,
            controls=controls,
            gauges=gauges,
        ),
        SttComponent(voice.stt, listener, controls, shared=voice.hearing.shared),
        TtsComponent(voice.speech_output, controls, gauges, shared=voice.speech),
    )


def _llm(parts: AgentParts, gauges: Gauges) -> Component:
    if not parts.model:
        return Off(ComponentName.LLM, "none was asked for")
    return LlmComponent(
        parts.model,
        gauges,
        weights=parts.model_path,
        endpoint=parts.settings.llm_endpoint,
        absent=parts.absent,
    )


def serve(settings: Settings, body: Body | None, ros_args: Sequence[str]) -> bool:
    """Serve the agent's users, until the program is ended."""
    began_s = time.monotonic()
    with ExitStack() as stack:
        parts = build_parts(stack, settings, body)
        with ShutdownSignals(settings.leave_s, parts.drain) as shutdown:
            start_parts(stack, parts, ros_args)
            if settings.render and has_display() and isinstance(body, HasPicture):
                start(stack, Viewer(body.picture, f"EdgeVox: {body.name}"))
            show(f"{parts.name} is ready. /help shows what can be typed.")
            log.info("ready", agent=parts.name, after_s=round(time.monotonic() - began_s, 1))
            try:
                run_terminal(parts, shutdown)
            finally:
                log.info("shutting_down", agent=parts.name, reason=shutdown.signal or "left")
                parts.drain.stand()  # before anything is closed, since that may hang
    return True
