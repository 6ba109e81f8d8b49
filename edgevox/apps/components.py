"""What the components of an agent say of themselves: their values, fetched for diagnostics.

Every agent lists the same ones, so that one configuration of an aggregator fits all: what was not
asked for is well, and says that it is off.
"""

import time
from collections.abc import Callable, Mapping

from edgevox import __version__
from edgevox.apps.folders import written_folders
from edgevox.apps.parts import Parts
from edgevox.apps.voice import Voice, dropped_frames
from edgevox.core.languages import LANGUAGES
from edgevox.core.trouble import trouble_of
from edgevox.ops.diagnostics import Component, Diagnostics, Look, component
from edgevox.ops.diagnostics.audio import Sound, audio
from edgevox.ops.diagnostics.disk import disk, rooms
from edgevox.ops.diagnostics.gauges import Gauges
from edgevox.ops.diagnostics.lately import Lately
from edgevox.ops.diagnostics.llm import Thinking, llm
from edgevox.ops.diagnostics.moving import Executing, World, executor, sim
from edgevox.ops.diagnostics.presence import presence
from edgevox.ops.diagnostics.process import process
from edgevox.ops.diagnostics.speech import Hearing, Speaking, stt, tts
from edgevox.ops.health import lives
from edgevox.robots.capabilities import Body, HasBattery, KeepsPace, TellsStalls
from edgevox.ros2 import Bridge
from edgevox.voice.ears import Ears

TYPED = "text is typed"


def off(name: str, why: str) -> Look:
    """A component that was not asked for."""
    return lambda: component(name, well=f"off: {why}")


def list_components(parts: Parts, gauges: Gauges) -> Diagnostics:
    """All; executor and presence are off until a bridge is there, see below."""
    listed = Diagnostics()
    voice, ears = parts.voice, parts.ears
    looks: Mapping[str, Look] = {
        "audio": _audio(parts, voice, ears, gauges) if voice and ears else off("audio", TYPED),
        "stt": _stt(parts, voice, ears) if voice and ears else off("stt", TYPED),
        "llm": _llm(parts, gauges) if parts.model else off("llm", "none was asked for"),
        "tts": _tts(parts, voice, gauges) if voice else off("tts", TYPED),
        "sim": _sim(parts.body) if parts.body else off("sim", "no robot"),
        "executor": off("executor", "no ROS 2"),
        "presence": off("presence", "no ROS 2"),
        "disk": lambda: disk(rooms(written_folders(parts.settings.audio_out))),
        "process": _process(parts),
    }
    for name, look in looks.items():
        listed.add(name, look)
    return listed


def list_executor(listed: Diagnostics, bridge: Bridge) -> None:
    """From now on, say how the bridge is."""
    lately = Lately()

    def look() -> Component:
        failed = bridge.failed
        return executor(Executing(bridge.stalled_s, failed, lately.grew(failed), bridge.missing))

    listed.add("executor", look)


def list_presence(listed: Diagnostics, bridge: Bridge) -> None:
    """From now on, say whether another agent shares the namespace; off where there is no bridge."""
    if not bridge.missing:
        listed.add("presence", lambda: presence(bridge.sharing))


def _audio(parts: Parts, voice: Voice, ears: Ears, gauges: Gauges) -> Look:
    lately = Lately()
    hears, speaks = lives(lambda: ears.alive), lives(lambda: voice.mouth.alive)

    def look() -> Component:
        dropped = dropped_frames(voice.source)
        return audio(
            Sound(
                voice.source.name,
                voice.sink.name,
                trouble_of(voice.source),
                trouble_of(voice.sink),
                ears=hears(),
                mouth=speaks(),
                level=gauges.level,
                muted=parts.controls.muted,
                dropped=dropped,
                losing=lately.grew(dropped),
            )
        )

    return look


def _stt(parts: Parts, voice: Voice, ears: Ears) -> Look:
    understanding, failing, refusing = ears.understanding, Lately(), Lately()

    def look() -> Component:
        last_s, sound_s = understanding.last or (None, None)
        failed, refused = understanding.failed, understanding.refused
        language = parts.controls.language
        return stt(
            Hearing(
                LANGUAGES[language].stt_model,
                language,
                last_s,
                sound_s,
                failed,
                failing.grew(failed),
                refused,
                refusing.grew(refused),
                trouble_of(voice.stt),
            )
        )

    return look


def _llm(parts: Parts, gauges: Gauges) -> Look:
    lately, model, settings = Lately(), parts.model, parts.settings
    on_board = parts.model_path.name if parts.model_path else ""

    def look() -> Component:
        failed = gauges.model_failures
        return llm(
            Thinking(
                on_board,
                settings.llm_endpoint,
                trouble_of(model),
                model.context_tokens if model else 0,
                gauges.tokens_per_s,
                failed,
                lately.grew(failed),
                parts.absent,
            )
        )

    return look


def _tts(parts: Parts, voice: Voice, gauges: Gauges) -> Look:
    lately, speaker = Lately(), voice.mouth.speaker

    def look() -> Component:
        voices = LANGUAGES[parts.controls.language].voices
        asked = next((one for one in voices if parts.controls.voice in ("", one.name)), voices[0])
        last = speaker.last[0] if speaker.last else None
        return tts(
            Speaking(
                asked.name,
                asked.backend,
                last.name if last else None,
                last.backend if last else None,
                gauges.synthesis_s,
                gauges.first_audio_s,
                speaker.failures,
                lately.grew(speaker.failures),
                speaker.trouble,
            )
        )

    return look


def _sim(body: Body) -> Look:
    lately = Lately()

    def look() -> Component:
        steps = body if isinstance(body, KeepsPace) else None
        breaks = steps.breaks if steps else 0
        return sim(
            World(
                body.name,
                body.stalled_s if isinstance(body, TellsStalls) else 0.0,
                steps.real_time_factor or None if steps else None,
                steps.pace if steps else None,
                breaks,
                lately.grew(breaks),
                body.battery() if isinstance(body, HasBattery) else None,
                trouble_of(body),
            )
        )

    return look


def _process(parts: Parts, clock: Callable[[], float] = time.monotonic) -> Look:
    began_s = clock()
    return lambda: process(parts.health, began_s, __version__, parts.conversation.refusals)
