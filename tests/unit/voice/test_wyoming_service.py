"""The server of Wyoming: what peers may send it, with ears and voices that are none."""

import socket
import threading
from collections.abc import Iterator, Sequence
from contextlib import closing, contextmanager, suppress

import numpy as np
import pytest
from guards import HUNG_S
from wyoming.asr import Transcribe, Transcript
from wyoming.audio import AudioChunk, AudioStart, AudioStop
from wyoming.event import Event, read_event, write_event
from wyoming.info import Describe, Info
from wyoming.tts import Synthesize, SynthesizeVoice
from wyoming.wake import Detect

from edgevox.core.errors import EdgeVoxError
from edgevox.voice.audio import FRAME_SAMPLES, RATE_HZ, Chunk
from edgevox.voice.remote.offered import MOST_CONNECTIONS, MOST_TEXT, Offer, WyomingService

FORM = {"rate": RATE_HZ, "width": 2, "channels": 1}


class Words:
    """Hears "loud" in each frame that is, and "any" in all."""

    def heard(self, samples) -> Sequence[str]:
        return ["any", "loud"] if samples.max() > 1000 else ["any"]

    def reset(self) -> None: ...

    def close(self) -> None: ...


def _transcribe(samples, language) -> str:
    if language == "xx":
        raise EdgeVoxError("no language xx")
    return f"{samples.size} {language}"


def _speak(text, name, language) -> Iterator[Chunk]:
    yield Chunk(np.zeros(len(text), np.int16), 22_050)
    yield Chunk(np.ones(320, np.int16), 16_000)


@pytest.fixture
def service() -> Iterator[WyomingService]:
    offer = Offer(Info, _transcribe, _speak, Words)
    with closing(WyomingService(offer, "127.0.0.1", 0)) as service:
        yield service


class Peer:
    def __init__(self, port: int) -> None:
        self._socket = socket.create_connection(("127.0.0.1", port), HUNG_S)
        self._reader, self.raw = self._socket.makefile("rb"), self._socket.makefile("wb")

    def send(self, *events) -> None:
        for one in events:
            write_event(one if isinstance(one, Event) else one.event(), self.raw)

    def next(self) -> Event | None:
        return read_event(self._reader)

    def close(self) -> None:
        self._reader.close()
        self.raw.close()
        self._socket.close()


@contextmanager
def peer(service: WyomingService) -> Iterator[Peer]:
    with closing(Peer(service.port)) as one:
        yield one


def _sound(samples: int, level: int = 0) -> AudioChunk:
    return AudioChunk(**FORM, audio=np.full(samples, level, np.int16).tobytes())


def test_one_connection_asks_for_one_thing_after_the_other(service: WyomingService) -> None:
    with peer(service) as one:
        one.send(Describe())
        assert Info.is_type(one.next().type)
        one.send(Transcribe(language="de"), AudioStart(**FORM), _sound(700), AudioStop())
        assert Transcript.from_event(one.next()).text == "700 de"
        one.send(Transcribe(), AudioStart(**FORM), AudioStop())
        assert Transcript.from_event(one.next()).text == ""
        one.send(Synthesize(text="Hello."))
        kinds = [one.next().type for _ in range(4)]
    assert kinds == ["audio-start", "audio-chunk", "audio-chunk", "audio-stop"]


def test_sound_of_another_rate_is_heard_at_16_khz(service: WyomingService) -> None:
    form = {"rate": 48_000, "width": 2, "channels": 2}
    with peer(service) as one:
        one.send(AudioStart(**form), AudioChunk(**form, audio=bytes(48_000 * 4)), AudioStop())
        samples = int(Transcript.from_event(one.next()).text.split()[0])
    assert abs(samples - RATE_HZ) < 100


@pytest.mark.parametrize(
    ("names", "told"), [(None, ["any", "any", "loud"]), (["loud"], ["loud"]), (["x"], [])]
)
def test_words_are_told_as_they_are_heard(service: WyomingService, names, told) -> None:
    with peer(service) as one:
        one.send(Detect(names=names), AudioStart(**FORM))
        one.send(_sound(FRAME_SAMPLES), _sound(FRAME_SAMPLES, 2000), AudioStop())
        got = [one.next() for _ in told]
        assert [event.data["name"] for event in got] == told
        if not told:
            assert one.next().type == "not-detected"
        # Later it may as well want its words.
        one.send(Transcribe(), AudioStart(**FORM), _sound(5), AudioStop())
        assert Transcript.from_event(one.next()).text == "5 None"


@pytest.mark.parametrize(
    "events",
    [
        [Transcribe(language="xx"), AudioStart(**FORM), _sound(5), AudioStop()],
        [Event("audio-start", {"rate": 16_000})],
        [Event("audio-start", {"rate": 7, "width": 2, "channels": 1})],
        [Event("synthesize", {})],
        [Synthesize(text="a" * (MOST_TEXT + 1))],
        [AudioStart(**FORM), *[_sound(30 * RATE_HZ)] * 3],
    ],
    ids=range(6),
)
def test_what_cannot_be_done_is_told_and_the_next_is_done(service: WyomingService, events) -> None:
    with peer(service) as one:
        one.send(*events)
        assert one.next().type == "error"
        one.send(Describe())
        assert Info.is_type(one.next().type)


@pytest.mark.parametrize(
    "raw",
    [
        b"GET / HTTP/1.1\r\n\r\n",
        b"[]\n",
        b"x" * (1 << 17),
        b'{"type": "audio-chunk", "payload_length": 9000000000}\n',
        b'{"type": 7}\n',
    ],
    ids=range(5),
)
def test_who_does_not_speak_wyoming_is_hung_up_on(service: WyomingService, raw: bytes) -> None:
    with peer(service) as one:
        one.raw.write(raw)
        one.raw.flush()
        with suppress(ConnectionResetError):  # some of it was not read
            assert one.next() is None
    with peer(service) as other:
        other.send(Describe())
        assert other.next()


def test_connections_are_bounded_and_closing_hangs_up_on_all() -> None:
    service = WyomingService(Offer(Info, _transcribe, _speak, Words), "127.0.0.1", 0)
    peers = [Peer(service.port) for _ in range(MOST_CONNECTIONS)]
    for one in peers:
        one.send(Describe())
        assert one.next()
    with peer(service) as late:
        assert late.next() is None
    closer = threading.Thread(target=service.close)
    closer.start()
    assert [one.next() for one in peers] == [None] * MOST_CONNECTIONS
    closer.join(HUNG_S)
    assert not closer.is_alive()
    for one in peers:
        one.close()


def test_a_voice_is_asked_for_by_its_name_or_a_language() -> None:
    asked = []

    def speak(*what) -> Iterator[Chunk]:
        asked.append(what)
        return _speak(*what)

    offer = Offer(Info, _transcribe, speak, Words)
    with closing(WyomingService(offer, "127.0.0.1", 0)) as service, peer(service) as one:
        for voice in (None, SynthesizeVoice(name="amy"), SynthesizeVoice(language="de")):
            one.send(Synthesize(text="x", voice=voice))
            while one.next().type != "audio-stop":
                pass
    assert asked == [("x", None, None), ("x", "amy", None), ("x", None, "de")]
