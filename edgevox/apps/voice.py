"""The ears and the mouth of an agent, made from the settings."""

from collections.abc import Callable
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path

from edgevox.agent.phrase_file import phrasebook
from edgevox.apps.queries import Info, present_voices, tts_info
from edgevox.core.bus import Bus
from edgevox.core.commands import Command
from edgevox.core.controls import Controls
from edgevox.core.errors import InvalidValue
from edgevox.core.events import ControlChanged
from edgevox.core.languages import LANGUAGES, STT_BACKEND
from edgevox.core.settings import Settings
from edgevox.models import locate
from edgevox.voice.audio import AudioSource
from edgevox.voice.ears import Ears
from edgevox.voice.mouth import SpeakingMouth
from edgevox.voice.sinks.opening import open_sink
from edgevox.voice.sinks.relay import Relay
from edgevox.voice.sources.files import WavFiles
from edgevox.voice.sources.opening import ROS2, open_source
from edgevox.voice.sources.pushed import Pushed
from edgevox.voice.speaker import Speaker
from edgevox.voice.stt.whisper import Whisper
from edgevox.voice.tts.pool import VoicePool
from edgevox.voice.vad import SileroVad
from edgevox.voice.wakeword import WakeWord

WAKE_WORDS = "wake-words"
"""The id in edgevox-models of the wake words."""


@dataclass(frozen=True)
class Voice:
    """What hears and speaks. `relay` carries speech to ROS 2 when `audio_out` says so."""

    source: AudioSource
    stt: Whisper
    mouth: SpeakingMouth
    audible: Callable[[], float]
    wakeword: WakeWord | None
    relay: Relay | None

    @property
    def microphone(self) -> Pushed | None:
        """The source that ROS 2 fills, if `audio_in` says so."""
        return self.source if isinstance(self.source, Pushed) else None

    def infos(self, controls: Controls) -> dict[str, Info]:
        """What hears and what speaks, as `model_info` says it."""
        return {
            "stt": lambda: _stt_info(controls.language),
            "tts": lambda: tts_info(self.mouth.speaker),
        }


def build_voice(
    stack: ExitStack,
    settings: Settings,
    bus: Bus,
    controls: Controls,
) -> Voice:
    """Open sound in both directions and load what the first sentence needs.

    Raises `InvalidValue` for a setting that cannot be honoured, `ModelMissing` for a model that is
    not here.
    """
    if settings.audio_in == ROS2 and not settings.ros2:
        raise InvalidValue("audio_in", ROS2, "ros2 only together with --ros2")
    source = open_source(settings.audio_in)
    stack.callback(source.close)
    relay = Relay()
    sink = open_sink(settings.audio_out, relay=relay if settings.ros2 else None)
    stack.callback(sink.close)
    wakeword = WakeWord(settings.wakeword, locate(WAKE_WORDS)) if settings.wakeword else None
    stt = Whisper(_hearing_model, prompt_of=lambda code: phrasebook(code).hearing.written)
    stack.callback(stt.close)
    mouth = SpeakingMouth(Speaker(lambda: present_voices(controls), VoicePool()), sink)
    stack.callback(bus.subscribe(ControlChanged, lambda change: _prepare(mouth, change)))
    connected = relay if settings.ros2 and settings.audio_out == ROS2 else None
    return Voice(source, stt, mouth, sink.audible, wakeword, connected)


def warm_up(voice: Voice, language: str) -> None:
    """Load and try what hears and speaks, so that the first person does not wait for it."""
    voice.mouth.prepare()
    voice.stt.warm_up(language)
    voice.mouth.warm_up()


def build_ears(
    voice: Voice,
    settings: Settings,
    bus: Bus,
    controls: Controls,
    *,
    submit: Callable[[Command], None],
    is_stop: Callable[[str], bool],
) -> Ears:
    """The ears, not started; what they hear goes to `submit`."""
    return Ears(
        voice.source,
        SileroVad(),
        voice.stt,
        submit=submit,
        bus=bus,
        language=lambda: controls.language,
        muted=lambda: controls.muted,
        audible=voice.audible,
        wakeword=voice.wakeword,
        is_stop=is_stop,
        echo=settings.echo,
        lossless=isinstance(voice.source, WavFiles),
    )


def _hearing_model(language: str) -> Path:
    return locate(LANGUAGES[language].stt_model)


def _prepare(mouth: SpeakingMouth, change: ControlChanged) -> None:
    if change.name in ("language", "voice"):
        mouth.prepare()


def _stt_info(language: str) -> dict[str, str]:
    size = LANGUAGES[language].stt_model.removeprefix("whisper-")
    return {"backend": STT_BACKEND, "model_size": size, "device": "cpu"}
