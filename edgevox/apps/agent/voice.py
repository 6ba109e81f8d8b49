"""Speech in and out of an agent, made from the settings.

The settings choose the stop word spotter, the wake word, its engine and so its licence.
"""

from collections.abc import Callable, Iterable, Mapping
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Literal

from edgevox.agent.conversation import Conversation
from edgevox.agent.nlu.hearing.endings import Endings
from edgevox.agent.nlu.hearing.wordings import HearingPrompts
from edgevox.agent.phrases.load import phrasebook
from edgevox.agent.policy import Guard
from edgevox.agent.skills import Skill, SkillSet
from edgevox.apps.agent.queries import Info, present_voices, tts_info
from edgevox.apps.folders import voiceprints_folder
from edgevox.core.bus import Bus
from edgevox.core.commands import Command, Speak, Way
from edgevox.core.controls import Controls
from edgevox.core.errors import InvalidValue
from edgevox.core.events import ControlChanged
from edgevox.core.hearers import UtteranceHeard
from edgevox.core.languages import LANGUAGES, STT_BACKEND
from edgevox.core.log import get_logger
from edgevox.core.servers.address import Address
from edgevox.core.settings import Settings
from edgevox.core.speech import Ending, FollowUp
from edgevox.models import locate
from edgevox.models.manifest import builtin_manifest
from edgevox.voice.audio import AudioSource
from edgevox.voice.echo.played import PlayedSound
from edgevox.voice.listener import Listener
from edgevox.voice.sentence_synthesiser import SentenceSynthesiser, Voices
from edgevox.voice.sinks.open_sink import open_sink
from edgevox.voice.sinks.paced import Relay, TappedSink
from edgevox.voice.sources.open_source import ROS2, WavFiles, open_source
from edgevox.voice.sources.pushed import Pushed
from edgevox.voice.speech_output import SpeechOutput
from edgevox.voice.stop_spotter.detector import StopDetector
from edgevox.voice.stop_spotter.network import ENCODER
from edgevox.voice.stop_spotter.spotter import open_stop_spotter
from edgevox.voice.stt.kept import MOST_BYTES, MOST_UTTERANCES, KeepingSpeechToText, KeptAudio
from edgevox.voice.stt.speech_to_text import SpeechToText, WatchedSpeechToText
from edgevox.voice.stt.whisper import Whisper
from edgevox.voice.transcriber import KnownVoice
from edgevox.voice.tts.voices import VoicePool
from edgevox.voice.vad import open_vad
from edgevox.voice.voiceprint import ENCODER as VOICE_ENCODER
from edgevox.voice.voiceprint import KnownVoices, VoiceEncoder, VoicePrints
from edgevox.voice.word_detection import WakeDetector

if TYPE_CHECKING:
    from edgevox.voice.remote.shared_hearing import SharedSpeechToText
    from edgevox.voice.remote.shared_speech import SharedSpeech

log = get_logger(__name__)


def open_stop_detector(settings: Settings) -> StopDetector | None:
    """Open the stop word detector, loaded.

    None if no setting asks for it, or, with a log line, if its model is missing or cannot be
    loaded: stop words are still found in transcripts.
    """
    if not settings.stop_spotter:
        return None
    try:
        spotter = open_stop_spotter(locate(ENCODER))
        spotter.warm_up()
    except Exception as error:  # noqa: BLE001 - whatever its library raises, the robot starts
        log.warning("stop_spotter_missing", reason=str(error))
        return None
    return spotter


def open_known_voices(settings: Settings, guard: Guard) -> KnownVoice:
    """Open what tells people who were enrolled from guests.

    Without the setting all are guests to a policy that has rules for guests, and to no other.
    Raises `ModelMissing`.
    """
    if not settings.voiceprints:
        return lambda _sound, _ended_s: not guard.policy.file.of_way(Way.VOICE_GUEST)
    prints = VoicePrints(voiceprints_folder())
    known = KnownVoices(VoiceEncoder(locate(VOICE_ENCODER)), prints)
    log.info("voiceprints_in_use", people=len(prints.read()))
    return lambda sound, ended_s: bool(known.who(sound, ended_s))


MICRO = "micro-wake-words"
"""The id in edgevox-models of networks that a product may use."""
OPEN = "wake-words"
"""The id of openWakeWord's, which may not be used commercially."""
MODELS: Mapping[str, str] = {"micro": MICRO, "openwakeword": OPEN}
"""The models of each engine."""

_FRONT_END = {"embedding_model", "melspectrogram"}


def open_wakeword(settings: Settings) -> WakeDetector | None:
    """Open the wake word detector; None without a wake word.

    Raises `InvalidValue` for a phrase that the engine has no network for, `ModelMissing` for
    networks that are not here.
    """
    if not settings.wakeword:
        return None
    if own := own_file(settings):
        from edgevox.voice.wake.micro import MicroWakeWord

        return MicroWakeWord(own)
    engine = settings.wakeword_engine
    phrase = " ".join(settings.wakeword.casefold().replace("_", " ").split())
    if phrase not in phrases(engine):
        others = [name for name in MODELS if phrase in phrases(name)]
        hint = f"; or set wakeword_engine to {others[0]}, which has it" if others else ""
        known = ", ".join(phrases(engine))
        raise InvalidValue("wakeword", settings.wakeword, f"one of {known}, or a .json file{hint}")
    folder = locate(MODELS[engine])
    if engine == "micro":
        from edgevox.voice.wake.micro import open_network

        return open_network(folder, phrase)
    from edgevox.voice.wake.wakeword import WakeWord

    licence = builtin_manifest().licences[builtin_manifest().models[OPEN].licence]
    log.warning("wake_word_not_commercial", phrase=phrase, licence=licence.name)
    return WakeWord(phrase, folder)


def needed_models(settings: Settings) -> tuple[str, ...]:
    """The ids of the models that the wake word and voice prints need."""
    own = not settings.wakeword or own_file(settings)
    prints = (VOICE_ENCODER,) if settings.voiceprints else ()
    return prints if own else (MODELS[settings.wakeword_engine], *prints)


def phrases(engine: str) -> list[str]:
    """The wake words that an engine's models have."""
    names = (Path(file.name) for file in builtin_manifest().models[MODELS[engine]].files)
    stems = {name.stem for name in names if name.suffix == ".tflite"}
    return sorted(name.replace("_", " ") for name in stems - _FRONT_END)


def own_file(settings: Settings) -> Path | None:
    """Return the description of the user's own network, if the setting names one."""
    file = Path(settings.wakeword).expanduser()
    return file if file.suffix == ".json" else None


@dataclass(frozen=True)
class VoiceChain:
    """The parts that hear and speak."""

    source: AudioSource
    sink: TappedSink
    stt: WatchedSpeechToText
    speech_output: SpeechOutput
    wakeword: WakeDetector | None
    relay: Relay | None
    """Carries speech to ROS 2 if `audio_out` says so."""
    played: PlayedSound
    hearing: "Hearing"
    speech: "SharedSpeech | None"
    """The server that speaks before the voices on board; None without one."""
    weights: Callable[[], Mapping[str, Iterable[Path]]]
    """Returns the loaded files, or folders of them, of ``stt`` and ``tts``."""

    @property
    def microphone(self) -> Pushed | None:
        """The source that ROS 2 fills, if `audio_in` says so."""
        return self.source if isinstance(self.source, Pushed) else None

    def infos(self, controls: Controls) -> dict[str, Info]:
        """Return the speech parts of `model_info`."""
        return {
            "stt": lambda: _stt_info(controls.language, self.hearing.shared),
            "tts": lambda: tts_info(self.speech_output.synthesiser),
        }


def build_voice(
    stack: ExitStack,
    settings: Settings,
    bus: Bus,
    controls: Controls,
    skills: Iterable[Skill] = (),
) -> VoiceChain:
    """Open sound in both directions and load what the first sentence needs.

    Raises `InvalidValue` for a setting that cannot be honoured, `ModelMissing` for wake words that
    are not here: a robot that takes every word for a command, or none, is not what was asked for.
    """
    if settings.audio_in == ROS2 and not settings.ros2:
        raise InvalidValue("audio_in", ROS2, "ros2 only together with --ros2")
    source = open_source(settings.audio_in)
    stack.callback(source.close)
    relay = Relay()
    played = PlayedSound()
    sink = TappedSink(
        open_sink(settings.audio_out, relay=relay if settings.ros2 else None, played=played)
    )
    stack.callback(sink.close)
    wakeword = open_wakeword(settings)
    if wakeword:
        stack.callback(wakeword.close)
    hearing = open_hearing(stack, settings, HearingPrompts(SkillSet(skills)))
    on_board = present_voices(lambda: (controls.language, controls.voice))
    speech = _open_shared_speech(stack, settings, on_board, lambda: controls.language)
    pool = VoicePool(server=speech.open if speech else None)
    speech_output = SpeechOutput(SentenceSynthesiser(speech or on_board, pool), sink)
    stack.callback(bus.subscribe(ControlChanged, lambda change: _prepare(speech_output, change)))
    connected = relay if settings.ros2 and settings.audio_out == ROS2 else None
    return VoiceChain(
        source,
        sink,
        hearing.stt,
        speech_output,
        wakeword,
        connected,
        played,
        hearing,
        speech,
        weights=lambda: {"stt": hearing.loaded(), "tts": pool.files},
    )


def written_example(language: str) -> str:
    """A sentence of the phrasebook, as hearing writes what it hears."""
    return phrasebook(language).hearing.written


@dataclass(frozen=True)
class Hearing:
    """Speech to text."""

    stt: WatchedSpeechToText
    stop_stt: SpeechToText
    """The part of it that is on board: for what may not be for the robot."""
    shared: "SharedSpeechToText | None"
    """The part that asks a server; None without one."""
    loaded: Callable[[], Iterable[Path]]
    """Returns the folders of the models that are loaded."""

    def stop_for(self, is_stop: Callable[[str], bool]) -> None:
        """Tell which words stop the robot: heard on board, they do not wait for a server."""
        if self.shared:
            self.shared.is_stop = is_stop


def open_hearing(
    stack: ExitStack, settings: Settings, prompt_of: Callable[[str], str] = written_example
) -> Hearing:
    """Open speech to text.

    `prompt_of` returns, by language, the sentences to expect. Raises `InvalidValue` for a folder of
    `keep_audio` that cannot be written.
    """
    whisper = Whisper(_hearing_model, prompt_of=prompt_of)
    shared = _open_shared_hearing(settings, whisper, prompt_of)
    hears: SpeechToText = shared or whisper
    stops: SpeechToText = whisper
    if settings.keep_audio:
        kept = KeptAudio(settings.keep_audio)
        hears, stops = KeepingSpeechToText(hears, kept), KeepingSpeechToText(stops, kept)
        most_mb = MOST_BYTES // 1_000_000
        log.warning("audio_is_kept", folder=str(kept.folder), most=MOST_UTTERANCES, most_mb=most_mb)
    stt = WatchedSpeechToText(hears)
    stack.callback(stt.close)
    return Hearing(stt, stops if shared else stt, shared, lambda: whisper.loaded)


def _open_shared_hearing(
    settings: Settings, on_board: SpeechToText, prompt_of: Callable[[str], str]
) -> "SharedSpeechToText | None":
    if not settings.stt_endpoint:
        return None
    from edgevox.voice.remote.hearing import open_hearing_server
    from edgevox.voice.remote.shared_hearing import SharedSpeechToText

    address = speech_address(settings, "stt")
    log.warning("audio_is_sent", server=address.host, encrypted=address.encrypted)
    server = open_hearing_server(address)
    return SharedSpeechToText(server, on_board, prompt_of=prompt_of)


def _open_shared_speech(
    stack: ExitStack, settings: Settings, on_board: Voices, language: Callable[[], str]
) -> "SharedSpeech | None":
    if not settings.tts_endpoint:
        return None
    from edgevox.voice.remote.shared_speech import SharedSpeech
    from edgevox.voice.remote.speaking import open_speaking_server

    server = open_speaking_server(speech_address(settings, "tts"), settings.tts_endpoint_voice)
    speech = SharedSpeech(server, on_board, language)
    stack.callback(speech.close)
    return speech


def speech_address(settings: Settings, part: Literal["stt", "tts"]) -> Address:
    """The address of the server that hears or speaks."""
    setting = f"{part}_endpoint"
    of_it = (getattr(settings, f"{setting}{one}") for one in ("", "_model", "_timeout"))
    url, model, timeout_s = of_it
    return Address(url, model, timeout_s, getattr(settings, f"{setting}_key_file"), setting)


def warm_up_hearing(voice: VoiceChain, language: str) -> None:
    """Load and try speech to text, so that the first command does not wait for it.

    A failure is logged, and its part reports it: the rest of the robot is of use without it.
    """
    # On another thread: a signal that arrives inside a C library's start would be lost there.
    with ThreadPoolExecutor(1, "edgevox-warm-up") as worker:
        error = worker.submit(voice.stt.warm_up, language).exception()
    if error:
        log.error("stt_missing", language=language, reason=str(error))


def build_listener(
    voice: VoiceChain,
    settings: Settings,
    bus: Bus,
    controls: Controls,
    *,
    submit: Callable[[Command], None],
    is_stop: Callable[[str], bool],
    follow_up: FollowUp,
    ending: Callable[[str], Ending],
    guard: Guard,
    on_utterance: Callable[[UtteranceHeard], None] | None = None,
) -> Listener:
    """Build the listener, not started; its commands go to `submit`.

    A person who speaks while speech recognition does not work is told so.
    """
    voice.hearing.stop_for(is_stop)
    voice.stt.tell = lambda: submit(Speak(phrasebook(controls.language).say("deaf")))
    from_files = isinstance(voice.source, WavFiles)
    return Listener(
        voice.source,
        open_vad(),
        voice.stt,
        submit=submit,
        bus=bus,
        language=lambda: controls.language,
        muted=lambda: controls.muted,
        audible=voice.sink.audible,
        wakeword=voice.wakeword,
        is_stop=is_stop,
        stop_stt=voice.hearing.stop_stt,
        follow_up=follow_up,
        known=open_known_voices(settings, guard),
        stop_detector=open_stop_detector(settings),
        ending=ending,
        on_utterance=on_utterance,
        saying=voice.speech_output.saying,
        echo="none" if from_files else settings.echo,  # nothing comes back into a file
        played=voice.played,
        lossless=from_files,
    )


def endings(conversation: Conversation) -> Endings:
    """Make the judge of endings, by the templates that the conversation has at the time."""
    interpreter = conversation.interpreter
    return Endings(
        interpreter.plain,
        is_stop=conversation.is_stop,
        hearing=lambda: interpreter.phrases.hearing,
    )


def _hearing_model(language: str) -> Path:
    return locate(LANGUAGES[language].stt_model)


def _prepare(speech_output: SpeechOutput, change: ControlChanged) -> None:
    if change.name in ("language", "voice"):
        speech_output.prepare()


def _stt_info(language: str, shared: "SharedSpeechToText | None") -> dict[str, str]:
    size = LANGUAGES[language].stt_model.removeprefix("whisper-")
    found = {"backend": STT_BACKEND, "model_size": size, "device": "cpu"}
    return found | ({"endpoint": shared.health.server} if shared else {})
