"""The components of an agent, each of which reports its status.

Every agent lists the same ones, so that one configuration of an aggregator fits all: a component
that is not wanted is well, and says that it is off.
"""

from edgevox import __version__
from edgevox.agent.llm.status import LlmComponent
from edgevox.agent.policy.status import PolicyComponent
from edgevox.apps.agent.parts import AgentParts
from edgevox.apps.agent.policy import known_names
from edgevox.apps.folders import needed_folders, written_folders
from edgevox.core.gauges import Gauges
from edgevox.core.motion.interlock import InterlockComponent
from edgevox.core.status import Component, ComponentName, Off
from edgevox.ops.diagnostics.disk import DiskComponent
from edgevox.ops.diagnostics.process import ProcessComponent
from edgevox.robots.sim_loop import SimComponent
from edgevox.voice.status import AudioComponent, SttComponent, TtsComponent

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
        PolicyComponent(parts.guard, lambda: known_names(parts.skills)),
        DiskComponent(
            lambda: written_folders(parts.settings), lambda: needed_folders(parts.settings)
        ),
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
        SttComponent(voice.stt, listener, controls),
        TtsComponent(voice.speech_output, controls, gauges),
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
