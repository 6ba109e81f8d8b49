"""`edgevox wyoming`: this machine's ears and voices for others, such as Home Assistant, by Wyoming.

Wyoming has no keys and no encryption: it listens on this machine only, unless told otherwise.
"""

import argparse
import sys
import threading
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import ExitStack, closing
from typing import TYPE_CHECKING, Any

from edgevox import __version__
from edgevox.apps.flags import add_flags, given_flags
from edgevox.apps.run_program import ShutdownSignals, run_program, set_up_logs
from edgevox.apps.streams import show, with_streams
from edgevox.core.cancel import CancelToken
from edgevox.core.errors import EdgeVoxError, InvalidValue, install_extra
from edgevox.core.languages import LANGUAGES, STT_BACKEND, language_code
from edgevox.core.settings import Settings, load_settings

if TYPE_CHECKING:
    from wyoming.info import Info

    from edgevox.voice.audio import Chunk, Samples
    from edgevox.voice.remote.offered import Offer

PROGRAM = "edgevox wyoming"
FLAGS = (
    "language", "voice", "wakeword", "wakeword_engine", "stop_spotter", "log_level", "log_format",
)  # fmt: skip
STOP = "stop"
"""The name of the detector that hears the stop words of the language."""
PHRASE_CHARS = 160


@with_streams(PROGRAM)
def main(argv: Sequence[str] | None = None) -> int:
    """Serve until somebody ends it; the process's exit code."""
    arguments = _parser().parse_args(list(sys.argv[2:] if argv is None else argv))

    def prepare() -> Callable[[], bool]:
        settings = load_settings(given_flags(arguments), arguments.config)
        set_up_logs(PROGRAM, settings)
        return lambda: _serve(settings, arguments.host, arguments.port)

    return run_program(PROGRAM, prepare)


def _serve(settings: Settings, host: str, port: int) -> bool:
    with ExitStack() as stack, ShutdownSignals(settings.leave_s):
        url = serve(stack, settings, host, port)
        show(f"{url}: transcribes, speaks and hears {', '.join(_words(settings)) or 'no word'}")
        threading.Event().wait()
    return True


def serve(stack: ExitStack, settings: Settings, host: str, port: int) -> str:
    """Serve until the stack is closed; the address. Raises `EdgeVoxError`."""
    try:
        from edgevox.voice.remote.offered import WyomingService
    except ModuleNotFoundError as error:
        raise EdgeVoxError(f"no module {error.name}: {install_extra('voice')}") from None
    offer = _offer(stack, settings)
    try:
        service = WyomingService(offer, host, port)
    except OSError as error:
        raise EdgeVoxError(f"{host}, port {port}: cannot listen: {error}") from None
    stack.callback(service.close)
    return f"tcp://{f'[{host}]' if ':' in host else host}:{service.port}"


def _words(settings: Settings) -> list[str]:
    return [*([settings.wakeword] if settings.wakeword else []), *([STOP] * settings.stop_spotter)]


def _offer(stack: ExitStack, settings: Settings) -> "Offer":
    from edgevox.apps.agent.voice import open_hearing
    from edgevox.voice.remote.offered import Offer

    hearing = open_hearing(
        stack, settings.model_copy(update={"stt_endpoint": "", "keep_audio": None})
    )
    hearing.stt.warm_up(settings.language)

    def transcribe(sound: "Samples", language: str | None) -> str:
        return hearing.stt.transcribe(sound, _code(language, settings)).text

    with closing(_Words(settings)):
        """What is missing is told at the start, and not to whoever connects."""
    info = _info(settings)
    return Offer(lambda: info, transcribe, _Speaking(settings).speak, lambda: _Words(settings))


class _Words:
    """Implements `WordDetector` by the wake word and the stop words' spotter."""

    def __init__(self, settings: Settings) -> None:
        from edgevox.apps.agent.voice import open_stop_detector, open_wakeword
        from edgevox.voice.vad import open_vad

        self._language = settings.language
        self._wakeword = open_wakeword(settings)
        self._spotter = open_stop_detector(settings)
        self._vad = open_vad()

    def heard(self, samples: "Samples") -> Sequence[str]:
        probability = self._vad.probability(samples)
        found = []
        if self._wakeword and self._wakeword.heard(samples, probability):
            found.append(self._wakeword.phrase)
        if self._spotter and self._spotter.heard(samples, probability, self._language):
            found.append(STOP)
        return found

    def reset(self) -> None:
        self._vad.reset()
        if self._wakeword:
            self._wakeword.reset()
        if self._spotter:
            self._spotter.forget()

    def close(self) -> None:
        if self._wakeword:
            self._wakeword.close()


class _Speaking:
    """Speaks with the voices of this machine, one phrase at a time."""

    def __init__(self, settings: Settings) -> None:
        from edgevox.apps.agent.queries import present_voices
        from edgevox.voice.sentence_synthesiser import SentenceSynthesiser
        from edgevox.voice.tts.voices import VoicePool

        self._settings = settings
        self._lock = threading.Lock()
        self._wanted = (settings.language, settings.voice)
        self._synthesiser = SentenceSynthesiser(present_voices(lambda: self._wanted), VoicePool())
        self._synthesiser.prepare()

    def speak(self, text: str, name: str | None, language: str | None) -> Iterator["Chunk"]:
        """See `Offer.speak`."""
        from edgevox.voice.sentence_synthesiser import split_phrases

        wanted = _voices().get(name or "")
        if name and wanted is None:
            raise InvalidValue("voice", name, f"one of {', '.join(_voices())}")
        if wanted is None:
            code = _code(language, self._settings)
            wanted = code, self._settings.voice if code == self._settings.language else ""
        for phrase in split_phrases(text, PHRASE_CHARS):
            yield from self._phrase(phrase, wanted)

    def _phrase(self, text: str, wanted: tuple[str, str]) -> Sequence["Chunk"]:
        """All of it: a peer that reads slowly keeps nobody waiting."""
        from edgevox.voice.spoken_answer import SpeakingUtterance

        utterance = SpeakingUtterance(CancelToken(), bool, lambda *_: None, lambda _: None)
        with self._lock:
            self._wanted = wanted
            line = utterance.log.begin(text)
            chunks = list(self._synthesiser.speak(utterance, line, text))
            fault = self._synthesiser.fault
        if fault:
            raise EdgeVoxError(fault)
        return chunks


def _code(language: str | None, settings: Settings) -> str:
    """The code of a language's tag, such as en-US; that of the settings for none."""
    if not language:
        return settings.language
    try:
        return language_code(language)
    except ValueError as error:
        raise InvalidValue("language", language, str(error)) from None


def _voices() -> Mapping[str, tuple[str, str]]:
    """Language and voice by the names that are offered."""
    from edgevox.apps.agent.queries import available_voices

    return {f"{code}-{name}": (code, name) for code in LANGUAGES for name in available_voices(code)}


def _info(settings: Settings) -> "Info":
    from wyoming.info import (
        AsrModel,
        AsrProgram,
        Attribution,
        Info,
        TtsProgram,
        TtsVoice,
        WakeModel,
        WakeProgram,
    )

    from edgevox.apps.agent.queries import deafness

    def told(name: str, description: str) -> dict[str, Any]:
        by = Attribution("EdgeVox", "")
        return {
            "name": name,
            "description": description,
            "attribution": by,
            "installed": True,
            "version": __version__,
        }

    heard = [code for code in LANGUAGES if not deafness(code)]
    program = told("edgevox", "EdgeVox")
    hears = AsrProgram(
        **program, models=[AsrModel(**told(STT_BACKEND, "Whisper"), languages=heard)]
    )
    voices = [
        TtsVoice(**told(name, name), languages=[code]) for name, (code, _) in _voices().items()
    ]
    words = [
        WakeModel(**told(word, word), languages=[settings.language], phrase=word)
        for word in _words(settings)
    ]
    return Info(
        asr=[hears] if heard else [],
        tts=[TtsProgram(**program, voices=voices)] if voices else [],
        wake=[WakeProgram(**program, models=words)] if words else [],
    )


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog=PROGRAM,
        description="Offer this machine's hearing, voices, wake word and stop words by Wyoming,"
        " Home Assistant's protocol, which has no keys and no encryption.",
        epilog="Settings come from a --config file, then EDGEVOX_* variables, then these flags.",
    )
    add_flags(parser, FLAGS)
    parser.add_argument(
        "--host", default="127.0.0.1", help="address to listen on; default: this machine only"
    )
    parser.add_argument("--port", type=int, default=10300, help="port; default: 10300; 0: any")
    return parser
