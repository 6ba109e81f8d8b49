"""Speech from a server: the OpenAI audio API, and Wyoming."""

from collections.abc import Callable, Generator, Iterator, Mapping
from typing import Any, Protocol

from wyoming.audio import AudioChunk, AudioStart, AudioStop
from wyoming.event import Event
from wyoming.info import Info
from wyoming.tts import Synthesize, SynthesizeVoice

from edgevox.core.cancel import CancelToken
from edgevox.core.errors import InvalidValue
from edgevox.core.languages import LANGUAGES
from edgevox.core.servers.address import Address, first_that
from edgevox.core.servers.errors import OddAnswer, RequestRefused, Unreachable, Unusable
from edgevox.core.servers.http import HttpServer
from edgevox.voice.audio import Chunk, Samples
from edgevox.voice.remote.wyoming import SCHEMES, WyomingServer, answers, deadline, read_as
from edgevox.voice.wav import PcmStream, WavStream

MOST_BYTES = 32 << 20
MOST_SOUND_S = 120.0
"""A longer sound than this is no phrase."""
_ANY_MODEL, _ANY_VOICE = "tts-1", "alloy"
"""What most servers take for what they have."""


class NoVoice(RequestRefused):
    """The server has no voice for a language."""

    def __init__(self, host: str, language: str) -> None:
        self.language = language
        super().__init__(f"{host} has no voice for {LANGUAGES[language].name}")


class SpeakingServer(Protocol):
    """A server that speaks. For one thread at a time, but for `close`."""

    address: Address

    def speak(self, text: str, language: str, token: CancelToken) -> Generator[Chunk, None, None]:
        """The text as sound; no further piece once cancelled. Raises `ServerFailed`."""

    def look(self, language: str, token: CancelToken) -> None:
        """Ask what it has, so that the first sentence need not. Raises `ServerFailed`."""

    def lives(self, token: CancelToken) -> bool:
        """Whether it answers anything within `LOOK_S`, also while it speaks; from any thread."""

    def close(self) -> None: ...


def voices_by_language(text: str, field: str = "tts_endpoint_voice") -> Mapping[str, str]:
    """Voices by language code, and by an empty code that of all others. Raises `InvalidValue`."""
    voices: dict[str, str] = {}
    for part in filter(None, (one.strip() for one in text.split(","))):
        code, equals, name = (one.strip() for one in part.partition("="))
        code, name = (code, name) if equals else ("", code)
        if (code and code not in LANGUAGES) or not name or code in voices:
            raise InvalidValue(
                field, text, "a voice, or one for each language: en=amy, de=thorsten"
            )
        voices[code] = name
    return voices


def open_speaking_server(address: Address, voice: str = "") -> SpeakingServer:
    """The client for this address. Raises `InvalidValue` for voices that make no sense."""
    voices = voices_by_language(voice)
    by_wyoming = address.url.partition("://")[0] in SCHEMES
    return (WyomingSpeaking if by_wyoming else OpenAiSpeaking)(address, voices)


class OpenAiSpeaking:
    """Implements `SpeakingServer` by ``/v1/audio/speech``, which knows no languages.

    The server's own list of voices, where it has one, tells which voice speaks which.
    """

    def __init__(self, address: Address, voices: Mapping[str, str]) -> None:
        self.address = address
        self._voices = dict(voices)
        self._server = HttpServer(address)
        self._model = address.model

    def speak(self, text: str, language: str, token: CancelToken) -> Generator[Chunk, None, None]:
        """See `SpeakingServer.speak`."""
        self.look(language, token)
        if token.cancelled:
            return
        voice = self._voices.get(language) or self._voices[""]
        asked = {"model": self._model, "input": text, "voice": voice, "response_format": "wav"}
        until_s = deadline(self.address)
        with self._server.request(
            "audio/speech", until_s, token, most_bytes=MOST_BYTES, json=asked
        ) as request:
            stream = WavStream()
            sounds = map(stream.push, request.chunks())
            for samples in _bounded(sounds, lambda: stream.rate_hz, token):
                yield Chunk(samples, stream.rate_hz)
                request.deadline_s = deadline(self.address)

    def look(self, language: str, token: CancelToken) -> None:
        """See `SpeakingServer.look`."""
        until_s = deadline(self.address)
        if not self._model:
            try:
                reply = self._server.read_json("models", until_s, token)
            except Unusable:
                self._model = _ANY_MODEL
            else:
                self._model = "" if reply is None else first_that("tts", reply, self.address)["id"]
        if not (self._voices.get(language) or self._voices.get("")) and not token.cancelled:
            self._voices[language] = self._voice_for(language, until_s, token)

    def lives(self, token: CancelToken) -> bool:
        """See `SpeakingServer.lives`."""
        return self._server.lives(token)

    def close(self) -> None:
        """See `SpeakingServer.close`."""
        self._server.close()

    def _voice_for(self, language: str, until_s: float, token: CancelToken) -> str:
        try:
            reply = self._server.read_json("audio/voices", until_s, token)
        except (Unusable, RequestRefused):
            return _ANY_VOICE
        return _listed_voice(reply, language, self.address)


def _listed_voice(reply: Any, language: str, address: Address) -> str:
    """The first of a list of voices that speaks this language, if they tell which they speak."""
    found = (reply.get("voices") or reply.get("data")) if isinstance(reply, dict) else reply
    told = False
    for one in found if isinstance(found, list) else ():
        if not isinstance(one, dict):
            continue
        name = one.get("voice_id") or one.get("id") or one.get("name")
        speaks = one.get("language") or one.get("lang") or one.get("locale")
        told = told or bool(speaks)
        if name and speaks and _speaks(str(speaks), language):
            return str(name)
    if told:
        raise NoVoice(address.host, language)
    return _ANY_VOICE


def _speaks(tag: str, language: str) -> bool:
    """Whether a language tag such as ``en-GB`` or ``en_US`` is of this language."""
    return tag.replace("_", "-").partition("-")[0].casefold() == language


class WyomingSpeaking:
    """Implements `SpeakingServer` by Wyoming, whose servers tell what their voices speak.

    Some, as wyoming-piper, list voices that they would have to fetch first.
    """

    def __init__(self, address: Address, voices: Mapping[str, str]) -> None:
        self.address = address
        self._voices = dict(voices)
        self._listed: set[str] = set()
        """The languages whose voice is the first that the server lists."""
        self._server = WyomingServer(address)

    def speak(self, text: str, language: str, token: CancelToken) -> Generator[Chunk, None, None]:
        """See `SpeakingServer.speak`."""
        self.look(language, token)
        if token.cancelled:
            return
        voice = SynthesizeVoice(name=self._voices.get(language) or self._voices.get(""))
        asked = Synthesize(text=text, voice=voice).event()
        with self._server.ask([asked], deadline(self.address), token) as request:
            pcm: PcmStream | None = None

            def sounds() -> Iterator[Samples]:
                nonlocal pcm
                for event in answers(request):
                    request.deadline_s = deadline(self.address)
                    if AudioStart.is_type(event.type):
                        pcm = _pcm_of(event)
                    elif AudioChunk.is_type(event.type):
                        pcm = pcm or _pcm_of(event)
                        yield pcm.push(event.payload or b"")
                    elif AudioStop.is_type(event.type):
                        return
                if not token.cancelled:
                    raise Unreachable("the connection ended before the speech did")

            try:
                for samples in _bounded(sounds(), lambda: pcm.rate_hz if pcm else 0, token):
                    yield Chunk(samples, pcm.rate_hz if pcm else 0)
            except OddAnswer as error:
                if language not in self._listed:
                    raise
                raise OddAnswer(
                    f"{error}; name a voice that it has in {self.address.setting}_voice"
                ) from None

    def look(self, language: str, token: CancelToken) -> None:
        """See `SpeakingServer.look`."""
        if self._voices.get(language) or self._voices.get(""):
            return
        info = self._server.describe(deadline(self.address), token)
        if info is not None:
            self._listed.add(language)
            self._voices[language] = _described_voice(info, language, self.address)

    def lives(self, token: CancelToken) -> bool:
        """See `SpeakingServer.lives`."""
        return self._server.lives(token)

    def close(self) -> None:
        """See `SpeakingServer.close`."""
        self._server.close()


def _pcm_of(event: Event) -> PcmStream:
    kind = AudioStart if AudioStart.is_type(event.type) else AudioChunk
    form = read_as(kind, event)
    try:
        return PcmStream(int(form.rate), int(form.width), int(form.channels))
    except (TypeError, ValueError, OverflowError):
        raise OddAnswer("sound without a form") from None


def _described_voice(info: Info, language: str, address: Address) -> str:
    for program in info.tts:
        if address.model and program.name != address.model:
            continue
        for voice in program.voices:
            if voice.installed and any(_speaks(str(tag), language) for tag in voice.languages):
                return str(voice.name)
    raise NoVoice(address.host, language)


def _bounded(
    sounds: Iterator[Samples], rate_hz: Callable[[], int], token: CancelToken
) -> Iterator[Samples]:
    """The sounds that have any samples. Raises `OddAnswer` for too long ones and, unless cancelled,
    for none at all.
    """
    seconds = 0.0
    for samples in sounds:
        if not samples.size:
            continue
        seconds += samples.size / rate_hz()
        if seconds > MOST_SOUND_S:
            raise OddAnswer(f"over {MOST_SOUND_S:.0f} s of sound for a phrase")
        yield samples
    if not seconds and not token.cancelled:
        raise OddAnswer("no sound")
