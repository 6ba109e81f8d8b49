"""Speech from a server: what it is asked, and which sound counts."""

import io
import threading
import wave

import numpy as np
import pytest
from guards import HUNG_S
from speech_server import NOT_FOUND, TONE, http_speech, wav_of, wyoming_speech
from wyoming.audio import AudioChunk, AudioStart, AudioStop
from wyoming.event import Event
from wyoming.info import Attribution, Describe, Info, TtsProgram, TtsVoice
from wyoming.tts import Synthesize

from edgevox.core.cancel import CancelToken
from edgevox.core.errors import InvalidValue
from edgevox.core.servers.errors import OddAnswer, ServerFailed, Unreachable, Unusable
from edgevox.voice.remote.speaking import NoVoice, open_speaking_server, voices_by_language
from edgevox.voice.wav import WavStream

WAV = wav_of()


def _speaks(address, language: str = "en", voice: str = "", token: CancelToken | None = None):
    client = open_speaking_server(address, voice)
    try:
        chunks = list(client.speak("Hello.", language, token or CancelToken()))
    finally:
        client.close()
    return np.concatenate([one.samples for one in chunks]), {one.rate_hz for one in chunks}


def test_a_server_speaks_by_http() -> None:
    with http_speech(speaks=lambda one: one.reply(WAV, kind="audio/wav")) as server:
        samples, rates = _speaks(server.address("tts"))
    assert np.array_equal(samples, TONE)
    assert rates == {22_050}
    assert server.asked[0].json == {
        "model": "kokoro",
        "input": "Hello.",
        "voice": "alloy",
        "response_format": "wav",
    }


@pytest.mark.parametrize(
    ("listed", "language", "voice"),
    [
        ({"voices": ["alloy", "nova"]}, "en", "alloy"),
        (
            {"voices": [{"id": "a", "language": "en-GB"}, {"id": "d", "language": "de_DE"}]},
            "de",
            "d",
        ),
        ([{"voice_id": "x", "lang": "fr"}, {"name": "y", "lang": "en"}], "en", "y"),
        ({"data": 7}, "en", "alloy"),
    ],
)
def test_the_voice_is_the_servers_first_for_the_language(listed, language, voice) -> None:
    with http_speech(
        speaks=lambda one: one.reply(WAV), voices=lambda one: one.reply(listed)
    ) as server:
        _speaks(server.address("tts"), language)
    assert server.asked[0].json["voice"] == voice


def test_a_server_without_a_voice_for_the_language_says_so() -> None:
    voices = {"voices": [{"id": "a", "language": "en"}]}
    only = http_speech(voices=lambda one: one.reply(voices))
    with only as server, pytest.raises(NoVoice, match="no voice for German"):
        _speaks(server.address("tts"), "de")


def test_named_voices_and_models_are_asked_for_without_a_list() -> None:
    with http_speech(speaks=lambda one: one.reply(WAV), models=NOT_FOUND) as server:
        for language in ("en", "de", "fr"):
            _speaks(server.address("tts", model="big"), language, "amy, de=thorsten")
    asked = [(one.json["model"], one.json["voice"]) for one in server.asked]
    assert asked == [("big", "amy"), ("big", "thorsten"), ("big", "amy")]


@pytest.mark.parametrize("text", ["xx=amy", "en=", "en=a, en=b", "a, b"])
def test_voices_that_make_no_sense_are_refused(text: str) -> None:
    with pytest.raises(InvalidValue, match="tts_endpoint_voice"):
        voices_by_language(text)


def test_the_first_sound_is_there_before_the_rest_is_sent() -> None:
    heard = threading.Event()

    def speaks(one) -> None:
        one.reply(WAV[:2044], kind="audio/wav")
        assert heard.wait(HUNG_S)
        one.write(WAV[2044:])

    with http_speech(speaks=speaks) as server:
        client = open_speaking_server(server.address("tts"))
        chunks = client.speak("Hello.", "en", CancelToken())
        assert next(chunks).samples.size == 1000
        heard.set()
        assert sum(one.samples.size for one in chunks) == TONE.size - 1000
        client.close()


@pytest.mark.parametrize(
    ("body", "kind"),
    [
        (b"", OddAnswer),
        (b"ID3\x04mp3", Unusable),
        (b'{"error": "no"}', Unusable),
        (wav_of(TONE[:0]), OddAnswer),
        (wav_of(rate_hz=400_000), Unusable),
        (WAV[:20] + b"\x03\x00" + WAV[22:], Unusable),
        (b"RIFF\x00\x00\x00\x00WAVE" + b"junk\xf0\xff\x00\x00" * 20_000, (Unusable, OddAnswer)),
        (wav_of(np.zeros(8000 * 200, np.int16), 8000), OddAnswer),
    ],
    ids=["nothing", "MP3", "JSON", "silent", "too fast", "float", "junk", "hours"],
)
def test_what_is_no_speech_is_an_error(body: bytes, kind) -> None:
    with http_speech(speaks=lambda one: one.reply(body)) as server, pytest.raises(kind):
        _speaks(server.address("tts"))


@pytest.mark.parametrize("pieces", [1, 3, 7, 44, 1000])
@pytest.mark.parametrize("width", [1, 2, 4])
def test_a_wav_file_is_read_as_it_comes_in_whatever_pieces(pieces: int, width: int) -> None:
    data = io.BytesIO()
    with wave.open(data, "wb") as file:
        file.setparams((2, width, 16_000, 0, "NONE", ""))
        file.writeframes(bytes(range(128)) * 2 * width)
    whole, stream = data.getvalue() + b"LIST\x04\x00\x00\x00abcd", WavStream()
    got = [stream.push(whole[at : at + pieces]) for at in range(0, len(whole), pieces)]
    assert sum(one.size for one in got) == 128
    assert stream.rate_hz == 16_000


def test_a_stream_that_does_not_know_its_length_is_read_to_its_end() -> None:
    stream = WavStream()
    unknown = WAV[:4] + b"\xff" * 4 + WAV[8:40] + b"\xff" * 4 + WAV[44:]
    assert np.array_equal(stream.push(unknown), TONE)


# Wyoming


def _info(*languages: str) -> Event:
    by = Attribution("somebody", "http://example")
    voices = [
        TtsVoice(
            f"voice-{one}", by, installed=one != "fr", description="", version="", languages=[one]
        )
        for one in languages
    ]
    program = TtsProgram("piper", by, installed=True, description="", version="", voices=voices)
    return Info(tts=[program]).event()


def _turn(events, send, _raw) -> None:
    if Describe.is_type(events[0].type):
        send(_info("en_US", "fr", "de_DE"))
        return
    form = {"rate": 16_000, "width": 2, "channels": 1}
    send(AudioStart(**form).event())
    for at in range(0, TONE.size, 3001):
        send(AudioChunk(**form, audio=TONE[at : at + 3001].tobytes()).event())
    send(AudioStop().event())


def test_a_server_speaks_by_wyoming_with_its_voice_for_the_language() -> None:
    with wyoming_speech(_turn) as server:
        samples, rates = _speaks(server.address("tts"), "de")
    assert np.array_equal(samples, TONE)
    assert rates == {16_000}
    asked = Synthesize.from_event(server.asked[1][0])
    assert (asked.text, asked.voice.name) == ("Hello.", "voice-de_DE")


def test_a_voice_that_is_not_installed_is_none() -> None:
    with wyoming_speech(_turn) as server, pytest.raises(NoVoice, match="French"):
        _speaks(server.address("tts"), "fr")


@pytest.mark.parametrize(
    ("events", "kind"),
    [
        ([AudioStart(16_000, 2, 1).event()], Unreachable),
        ([AudioStart(16_000, 2, 1).event(), AudioStop().event()], OddAnswer),
        ([AudioStart(7, 2, 1).event(), AudioStop().event()], Unusable),
        ([AudioStart(16_000, 2, 0).event(), AudioStop().event()], Unusable),
        ([AudioStart("x", 2, 1).event(), AudioStop().event()], OddAnswer),
        ([Event("audio-chunk", {}, b"1234")], OddAnswer),
        ([Event("audio-start", {"rate": 16_000})], OddAnswer),
    ],
    ids=range(7),
)
def test_sound_that_is_none_is_an_error(events, kind: type[ServerFailed]) -> None:
    def turn(_asked, send, _raw) -> None:
        for one in events:
            send(one)

    with wyoming_speech(turn) as server, pytest.raises(kind):
        _speaks(server.address("tts"), voice="any")


@pytest.mark.parametrize("wait_for", ["the list", "the sound"])
def test_cancelling_before_any_sound_is_no_fault_of_the_server(wait_for: str) -> None:
    asked = threading.Event()

    def hang(one) -> None:
        asked.set()
        one.hang()

    routes = {"voices" if wait_for == "the list" else "speaks": hang}
    over = threading.Event()

    def turn(events, send, _raw) -> None:
        if Describe.is_type(events[0].type) and wait_for != "the list":
            send(_info("en_US"))
            return
        asked.set()
        over.wait(HUNG_S)

    with http_speech(**routes) as by_http, wyoming_speech(turn) as by_wyoming:
        for server in (by_http, by_wyoming):
            asked.clear()
            token = CancelToken()
            client = open_speaking_server(server.address("tts"))
            threading.Thread(target=lambda: asked.wait(HUNG_S) and token.cancel()).start()  # noqa: B023
            assert list(client.speak("Hello.", "en", token)) == []
            client.close()
        over.set()


def test_cancelling_hangs_up_in_the_middle() -> None:
    token = CancelToken()

    def turn(_events, send, raw) -> None:
        form = {"rate": 16_000, "width": 2, "channels": 1}
        while True:
            send(AudioChunk(**form, audio=TONE.tobytes()).event())

    with wyoming_speech(turn) as server:
        client = open_speaking_server(server.address("tts"), "any")
        chunks = client.speak("Hello.", "en", token)
        next(chunks)
        token.cancel()
        assert list(chunks) == []
        client.close()
