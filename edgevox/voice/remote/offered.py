"""The ears and voices of EdgeVox for others, such as Home Assistant: a server of Wyoming."""

import socket
import threading
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from socketserver import StreamRequestHandler, ThreadingTCPServer
from typing import Any, Protocol

import numpy as np
from wyoming.asr import Transcribe, Transcript
from wyoming.audio import AudioChunk, AudioStart, AudioStop
from wyoming.error import Error
from wyoming.event import Event, write_event
from wyoming.info import Describe, Info
from wyoming.tts import Synthesize
from wyoming.wake import Detect, Detection, NotDetected

from edgevox.core.errors import EdgeVoxError
from edgevox.core.log import get_logger
from edgevox.core.servers.errors import OddAnswer
from edgevox.core.servers.exchange import SILENCE_S
from edgevox.voice.audio import RATE_HZ, Chunk, Framer, Samples
from edgevox.voice.remote.wyoming import BoundedReader, next_event, read_as
from edgevox.voice.wav import PcmStream, Resampler

log = get_logger(__name__)

MOST_CONNECTIONS = 16
MOST_SOUND_S = 60.0
"""The longest utterance."""
MOST_TEXT = 5000
"""Characters to speak at once."""


class WordDetector(Protocol):
    """Hears words in one stream."""

    def heard(self, samples: Samples) -> Sequence[str]:
        """Take the next frame; the names, as in `Offer.info`, of words that were just said."""

    def reset(self) -> None:
        """The next frame does not follow on those before."""

    def close(self) -> None: ...


@dataclass(frozen=True)
class Offer:
    """What is offered. All of it may be asked by several threads at once."""

    info: Callable[[], Info]
    transcribe: Callable[[Samples, str | None], str]
    """The words of a sound at 16 kHz, in a language or the usual one. Raises `EdgeVoxError`."""
    speak: Callable[[str, str | None, str | None], Iterator[Chunk]]
    """A text in a voice by its name or in a language, or as usual. Raises `EdgeVoxError`."""
    detector: Callable[[], WordDetector]
    """A new one, for one connection. Raises `EdgeVoxError`."""


class WyomingService:
    """Serves an offer on a port, from its creation until it is closed.

    Raises `OSError` if it cannot listen there.
    """

    def __init__(self, offer: Offer, host: str, port: int) -> None:
        service = self

        class Handler(StreamRequestHandler):
            timeout = SILENCE_S

            def handle(self) -> None:
                service._serve(self)

        class Server(ThreadingTCPServer):
            address_family = socket.AF_INET6 if ":" in host else socket.AF_INET
            allow_reuse_address = True
            daemon_threads = False

            def handle_error(self, request: Any, client_address: Any) -> None:  # noqa: ARG002
                log.exception("wyoming_broke", peer=client_address[0])

        self._offer = offer
        self._lock = threading.Lock()
        self._open: set[socket.socket] = set()
        self._closed = False
        self._server = Server((host, port), Handler)
        self._thread = threading.Thread(
            target=self._server.serve_forever, args=(0.1,), name="edgevox-wyoming"
        )
        self._thread.start()

    @property
    def port(self) -> int:
        return int(self._server.server_address[1])

    def close(self) -> None:
        """Hang up on all, and wait for their threads."""
        self._server.shutdown()
        self._thread.join()
        with self._lock:
            self._closed = True
            for one in self._open:
                with suppress(OSError):  # it has hung up
                    one.shutdown(socket.SHUT_RDWR)
        self._server.server_close()

    def _serve(self, handler: StreamRequestHandler) -> None:
        connected = handler.connection
        with self._lock:
            full = self._closed or len(self._open) >= MOST_CONNECTIONS
            if not full:
                self._open.add(connected)
        if full:
            log.warning("wyoming_full", peer=handler.client_address[0], most=MOST_CONNECTIONS)
            return
        session = _Session(self._offer, lambda one: write_event(one, handler.wfile))
        try:
            while event := next_event(BoundedReader(handler.rfile)):
                session.take(event)
        except EdgeVoxError as error:
            log.warning("wyoming_refused", peer=handler.client_address[0], reason=str(error))
        except OSError:
            """It has hung up, or was silent for too long."""
        finally:
            session.close()
            with self._lock:
                self._open.discard(connected)


class _Session:
    """One connection: what it asked for, and the sound that it sends."""

    def __init__(self, offer: Offer, send: Callable[[Event], object]) -> None:
        self._offer = offer
        self._send = send
        self._language: str | None = None
        self._detector: WordDetector | None = None
        self._names: Sequence[str] = ()
        """The words that it wants to hear of; none for all."""
        self._detecting = self._detected = False
        self._hears: _Hearing | None = None

    def take(self, event: Event) -> None:
        """Do what an event asks; its failure is told to the peer."""
        kinds: Mapping[Any, Callable[[Event], None]] = {
            Describe: lambda _: self._tell(self._offer.info()),
            Transcribe: self._transcribe,
            Detect: self._detect,
            AudioStart: self._begin,
            AudioChunk: self._hear,
            AudioStop: self._end,
            Synthesize: self._speak,
        }
        does = next((does for kind, does in kinds.items() if kind.is_type(event.type)), None)
        try:
            if does:
                does(event)
        except EdgeVoxError as error:
            self._tell(Error(str(error)))

    def close(self) -> None:
        """Free what it holds."""
        if self._detector:
            self._detector.close()

    def _tell(self, what: Any) -> None:
        self._send(what.event())

    def _transcribe(self, event: Event) -> None:
        self._language, self._detecting = read_as(Transcribe, event).language, False

    def _detect(self, event: Event) -> None:
        self._names = read_as(Detect, event).names or ()
        self._detector = self._detector or self._offer.detector()
        self._detecting = True

    def _begin(self, event: Event) -> None:
        self._hears, self._detected = _Hearing(read_as(AudioStart, event)), False
        if self._detector:
            self._detector.reset()

    def _hear(self, event: Event) -> None:
        chunk = read_as(AudioChunk, event)
        self._hears = self._hears or _Hearing(chunk)
        if not (self._detecting and self._detector):
            self._hears.keep(chunk.audio)
            return
        for frame in self._hears.frames(chunk.audio):
            for name in self._detector.heard(frame):
                if not self._names or name in self._names:
                    self._detected = True
                    self._tell(Detection(name=name, timestamp=chunk.timestamp))

    def _end(self, _: Event) -> None:
        hears, self._hears = self._hears, None
        if self._detecting:
            if not self._detected:
                self._tell(NotDetected())
            return
        sound = hears.whole() if hears else np.empty(0, np.int16)
        text = self._offer.transcribe(sound, self._language) if sound.size else ""
        self._tell(Transcript(text=text, language=self._language))

    def _speak(self, event: Event) -> None:
        asked = read_as(Synthesize, event)
        if len(asked.text) > MOST_TEXT:
            raise OddAnswer(f"{len(asked.text)} characters, expected at most {MOST_TEXT}")
        name, language = (asked.voice.name, asked.voice.language) if asked.voice else (None, None)
        form: dict[str, int] = {}
        for chunk in self._offer.speak(asked.text, name, language):
            if not form:
                form = {"rate": chunk.rate_hz, "width": 2, "channels": 1}
                stream = Resampler(chunk.rate_hz, chunk.rate_hz)
                self._tell(AudioStart(**form))
            if chunk.rate_hz != form["rate"]:  # another voice went on
                stream = Resampler(chunk.rate_hz, form["rate"])
            self._tell(AudioChunk(**form, audio=stream.push(chunk.samples).tobytes()))
        if not form:
            raise OddAnswer("there is nothing to say in it")
        self._tell(AudioStop())


class _Hearing:
    """A sound that comes in pieces, at 16 kHz."""

    def __init__(self, form: AudioStart | AudioChunk) -> None:
        try:
            self._pcm = PcmStream(int(form.rate), int(form.width), int(form.channels))
        except (TypeError, ValueError, OverflowError):
            raise OddAnswer("sound without a form") from None
        self._resampler = Resampler(self._pcm.rate_hz, RATE_HZ)
        self._framer = Framer()
        self._kept: list[Samples] = []
        self._size = 0

    def keep(self, data: bytes) -> None:
        """More of an utterance."""
        samples = self._resampler.push(self._pcm.push(data))
        self._size += samples.size
        if self._size > MOST_SOUND_S * RATE_HZ:
            self._kept.clear()
            raise OddAnswer(f"over {MOST_SOUND_S:.0f} s of sound")
        self._kept.append(samples)

    def whole(self) -> Samples:
        """The utterance."""
        return np.concatenate([*self._kept, self._resampler.flush()])

    def frames(self, data: bytes) -> Iterator[Samples]:
        """The frames that are whole now."""
        samples = self._resampler.push(self._pcm.push(data))
        return (frame.samples for frame in self._framer.push(samples, 0.0))
