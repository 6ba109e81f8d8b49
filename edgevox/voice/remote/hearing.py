"""Transcription on a server: the OpenAI audio API, and Wyoming.

What a server tells of its doubts (`verbose_json`) is judged as Whisper's own are. Servers that tell
none, as all by Wyoming, are believed with `UNTOLD`. Neither has other hypotheses.
"""

import io
import math
import wave
import zlib
from collections.abc import Iterator, Sequence
from typing import Any, Protocol

from wyoming.asr import Transcribe
from wyoming.asr import Transcript as WyomingTranscript
from wyoming.audio import AudioChunk, AudioStart, AudioStop
from wyoming.event import Event

from edgevox.core.cancel import CancelToken
from edgevox.core.errors import InvalidValue
from edgevox.core.files.validation import read_json
from edgevox.core.servers.address import Address, first_that
from edgevox.core.servers.errors import OddAnswer, RequestRefused, Unreachable, Unusable
from edgevox.core.servers.http import HttpServer
from edgevox.voice.audio import RATE_HZ, Samples
from edgevox.voice.remote.wyoming import SCHEMES, WyomingServer, answers, deadline, read_as
from edgevox.voice.stt.speech_to_text import (
    Segment,
    Transcript,
    parroted,
    plausible,
    transcript_of,
)

UNTOLD = 0.85
"""The likelihood of words whose server does not tell it: enough for a plain order, and asked about
when their meaning is in doubt, too."""
_UNTOLD_NOISE = 0.41
"""And of noise: what Whisper writes over silence was not said."""
_CHARACTERS_A_SECOND, _MORE_CHARACTERS = 60, 200
"""No person says more."""
_ANY_MODEL = "whisper-1"
"""What most servers take for the one they have."""
_CHUNK = 4096


class HearingServer(Protocol):
    """A server that transcribes. For several threads at once."""

    address: Address

    def transcribe(
        self, samples: Samples, language: str, prompt: str, token: CancelToken
    ) -> Transcript:
        """The words in this sound at 16 kHz; none if cancelled. Raises `ServerFailed`."""

    def lives(self, token: CancelToken) -> bool:
        """Whether it answers anything within `LOOK_S`, also while it transcribes."""

    def close(self) -> None: ...


def open_hearing_server(address: Address) -> HearingServer:
    """The client for this address."""
    by_wyoming = address.url.partition("://")[0] in SCHEMES
    return WyomingHearing(address) if by_wyoming else OpenAiHearing(address)


class OpenAiHearing:
    """Implements `HearingServer` by ``/v1/audio/transcriptions``."""

    def __init__(self, address: Address) -> None:
        self.address = address
        self._server = HttpServer(address)
        self._model = address.model
        self._format = "verbose_json"

    def transcribe(
        self, samples: Samples, language: str, prompt: str, token: CancelToken
    ) -> Transcript:
        """See `HearingServer.transcribe`."""
        until_s = deadline(self.address)
        self._model = self._model or self._offered(until_s, token)
        fields = {"model": self._model, "language": language, "temperature": "0"}
        fields |= {"prompt": prompt} if prompt else {}
        sound = _as_wav(samples)
        try:
            reply = self._asked(fields | {"response_format": self._format}, sound, until_s, token)
        except RequestRefused:
            if self._format == "json":
                raise
            reply = self._asked(fields | {"response_format": "json"}, sound, until_s, token)
            self._format = "json"  # it tells no doubts
        return Transcript("") if reply is None else _heard(reply, samples, prompt)

    def lives(self, token: CancelToken) -> bool:
        """See `HearingServer.lives`."""
        return self._server.lives(token)

    def close(self) -> None:
        """See `HearingServer.close`."""
        self._server.close()

    def _asked(
        self, fields: dict[str, str], sound: bytes, until_s: float, token: CancelToken
    ) -> Any:
        files = {"file": ("speech.wav", sound, "audio/wav")}
        with self._server.request(
            "audio/transcriptions", until_s, token, data=fields, files=files
        ) as request:
            reply = request.reply()
        if token.cancelled:
            return None
        try:
            return read_json(reply, "transcript")
        except InvalidValue:
            raise OddAnswer("a transcript that is no JSON") from None

    def _offered(self, until_s: float, token: CancelToken) -> str:
        """The model to ask for; a server without a list has one."""
        try:
            reply = self._server.read_json("models", until_s, token)
        except Unusable:
            return _ANY_MODEL
        return "" if reply is None else str(first_that("stt", reply, self.address)["id"])


class WyomingHearing:
    """Implements `HearingServer` by Wyoming, which has no prompts and tells no doubts."""

    def __init__(self, address: Address) -> None:
        self.address = address
        self._server = WyomingServer(address)

    def transcribe(
        self,
        samples: Samples,
        language: str,
        prompt: str,  # noqa: ARG002 - it takes none
        token: CancelToken,
    ) -> Transcript:
        """See `HearingServer.transcribe`."""
        sends = _spoken(samples, language, self.address.model)
        with self._server.ask(sends, deadline(self.address), token) as request:
            for event in answers(request):
                if WyomingTranscript.is_type(event.type):
                    return _heard({"text": read_as(WyomingTranscript, event).text}, samples, "")
        if token.cancelled:
            return Transcript("")
        raise Unreachable("the connection ended before the transcript")

    def lives(self, token: CancelToken) -> bool:
        """See `HearingServer.lives`."""
        return self._server.lives(token)

    def close(self) -> None:
        """See `HearingServer.close`."""
        self._server.close()


def _spoken(samples: Samples, language: str, model: str) -> Iterator[Event]:
    form = {"rate": RATE_HZ, "width": 2, "channels": 1}
    yield Transcribe(name=model or None, language=language).event()
    yield AudioStart(**form).event()
    for at in range(0, samples.size, _CHUNK):
        yield AudioChunk(**form, audio=samples[at : at + _CHUNK].tobytes()).event()
    yield AudioStop().event()


def _as_wav(samples: Samples) -> bytes:
    data = io.BytesIO()
    with wave.open(data, "wb") as file:
        file.setnchannels(1)
        file.setsampwidth(2)
        file.setframerate(RATE_HZ)
        file.writeframes(samples.tobytes())
    return data.getvalue()


def _heard(reply: Any, samples: Samples, prompt: str) -> Transcript:
    """The transcript, judged by what the server tells of it. Raises `OddAnswer`."""
    seconds = samples.size / RATE_HZ
    try:
        segments = [_segment(one) for one in reply.get("segments") or [reply]]
    except (AttributeError, KeyError, TypeError, ValueError):
        raise OddAnswer(f"not a transcript: {str(reply)[:80]!r}") from None
    said = sum(len(one.text) for one in segments)
    if said > _CHARACTERS_A_SECOND * seconds + _MORE_CHARACTERS:
        raise OddAnswer(f"{said} characters for {seconds:.1f} s of speech")
    real = [one for one in segments if plausible(one, seconds) and not parroted(one, prompt)]
    return transcript_of([_joined(real)], seconds, prompt) if real else Transcript("")


def _segment(told: Any) -> Segment:
    text = told["text"]
    if not isinstance(text, str):
        raise TypeError(text)
    data = text.strip().encode()
    mean = _figure(told.get("avg_logprob"), math.log(UNTOLD), -100.0, 0.0)
    noise = _figure(told.get("no_speech_prob"), _UNTOLD_NOISE, 0.0, 1.0)
    return Segment(text, noise, mean, len(data) / len(zlib.compress(data)))


def _figure(told: Any, untold: float, least: float, most: float) -> float:
    """What the server tells, within bounds; `untold` if it tells nothing."""
    if told is None:
        return untold
    value = float(told)
    if not math.isfinite(value):
        raise ValueError(value)
    return min(max(value, least), most)


def _joined(segments: Sequence[Segment]) -> Segment:
    """Segments that follow on each other as one; the likelihood is the mean over the text."""
    sizes = [max(1, len(one.text)) for one in segments]
    pairs = list(zip(sizes, segments, strict=True))
    mean = sum(size * one.log_probability for size, one in pairs) / sum(sizes)
    text = " ".join(one.text.strip() for one in segments)
    most = max(one.compression for one in segments)
    return Segment(text, min(one.no_speech for one in segments), mean, most)
