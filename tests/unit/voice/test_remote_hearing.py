"""Transcription on a server: what it is asked, and what counts of its answer."""

import logging
import threading
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml
from guards import HUNG_S
from speech_server import NOT_FOUND, http_speech, wyoming_speech
from wyoming.asr import Transcribe
from wyoming.asr import Transcript as WyomingTranscript
from wyoming.error import Error
from wyoming.event import Event

from edgevox.core.cancel import CancelToken
from edgevox.core.servers import errors
from edgevox.core.servers.errors import OddAnswer, ServerBusy, ServerFailed, Unreachable, Unusable
from edgevox.voice.audio import RATE_HZ
from edgevox.voice.remote.hearing import open_hearing_server

SOUND = np.arange(int(1.5 * RATE_HZ), dtype=np.int16)
GOOD = {"text": "Go to the kitchen."}
ODD = yaml.safe_load(Path(__file__).with_name("odd_hearing.yaml").read_text(encoding="utf-8"))


def _hears(address, language: str = "en", prompt: str = "", token: CancelToken | None = None):
    client = open_hearing_server(address)
    try:
        return client.transcribe(SOUND, language, prompt, token or CancelToken())
    finally:
        client.close()


def test_a_server_is_asked_for_its_model_that_transcribes_in_the_language(tmp_path: Path) -> None:
    key = tmp_path / "key"
    key.write_text("hunter")
    with http_speech(hears=lambda one: one.reply(GOOD)) as server:
        heard = _hears(server.address("stt", key_file=key), "de", "Fahr in die Küche.")
    assert heard.text == "Go to the kitchen."
    (asked,) = server.asked
    assert asked.key == "Bearer hunter"
    assert asked.fields == {
        "model": "Systran/faster-whisper-large-v3",
        "language": "de",
        "prompt": "Fahr in die Küche.",
        "temperature": "0",
        "response_format": "verbose_json",
    }
    assert asked.sound.getframerate() == RATE_HZ
    assert asked.sound.readframes(SOUND.size) == SOUND.tobytes()


@pytest.mark.parametrize("row", ODD, ids=[row["name"] for row in ODD])
def test_what_counts_of_an_answer(row: dict[str, Any]) -> None:
    with http_speech(hears=lambda one: one.reply(row["reply"])) as server:
        if "fails" in row:
            with pytest.raises(getattr(errors, row["fails"])):
                _hears(server.address("stt"))
            return
        heard = _hears(server.address("stt"))
    assert heard.text == row["heard"]
    least, most = row.get("sure", (0.0, 1.0))
    assert least <= heard.confidence <= most
    assert heard.others == ()


def test_a_server_that_tells_no_doubts_is_asked_for_the_text_from_then_on() -> None:
    def hears(one) -> None:
        wanted = one.fields["response_format"]
        one.reply(
            GOOD if wanted == "json" else {"error": "response_format"},
            200 if wanted == "json" else 400,
        )

    with http_speech(hears=hears) as server:
        client = open_hearing_server(server.address("stt"))
        texts = [client.transcribe(SOUND, "en", "", CancelToken()).text for _ in range(2)]
        client.close()
    assert texts == ["Go to the kitchen."] * 2
    assert [one.fields["response_format"] for one in server.asked] == [
        "verbose_json",
        "json",
        "json",
    ]


def test_a_server_without_a_list_of_models_is_asked_for_any() -> None:
    with http_speech(models=NOT_FOUND, hears=lambda one: one.reply(GOOD)) as server:
        assert _hears(server.address("stt")).text
    assert server.asked[0].fields["model"] == "whisper-1"


def test_a_server_that_only_chats_says_what_to_set() -> None:
    said = "no model that transcribes.*stt_endpoint_model"
    only = http_speech(models=lambda one: one.reply({"data": [{"id": "qwen3"}]}))
    with only as server, pytest.raises(Unusable, match=said):
        _hears(server.address("stt"))


@pytest.mark.parametrize(
    ("code", "kind"), [(429, ServerBusy), (500, Unreachable), (401, Unusable), (422, ServerFailed)]
)
def test_a_refusal_is_told_by_its_kind(code: int, kind: type[ServerFailed]) -> None:
    refuses = http_speech(hears=lambda one: one.reply({"detail": "no"}, code))
    with refuses as server, pytest.raises(kind):
        _hears(server.address("stt"))


def test_a_server_that_hangs_is_given_up_and_cancelling_ends_the_wait() -> None:
    with http_speech(hears=lambda one: one.hang()) as server:
        with pytest.raises(Unreachable, match="in time"):
            _hears(server.address("stt", timeout_s=0.3))
        token = CancelToken()
        threading.Timer(0.1, token.cancel).start()
        assert _hears(server.address("stt"), token=token).text == ""


def test_a_key_file_is_named_by_its_setting(tmp_path: Path) -> None:
    with http_speech() as server, pytest.raises(Unusable, match="stt_endpoint_key_file"):
        _hears(server.address("stt", key_file=tmp_path / "none", model="whisper"))


# Wyoming


def test_wyoming_is_asked_in_the_language_with_the_whole_sound() -> None:
    def turn(_events, send, _raw) -> None:
        send(WyomingTranscript(text="Go to the kitchen.", language="de").event())

    with wyoming_speech(turn) as server:
        heard = _hears(server.address("stt", model="large"), "de")
    assert (heard.text, round(heard.confidence, 2)) == ("Go to the kitchen.", 0.85)
    first, start, *chunks, stop = server.asked[0]
    assert Transcribe.from_event(first) == Transcribe(name="large", language="de")
    assert (start.type, stop.type) == ("audio-start", "audio-stop")
    assert {(one.data["rate"], one.data["width"], one.data["channels"]) for one in chunks} == {
        (RATE_HZ, 2, 1)
    }
    assert b"".join(one.payload for one in chunks) == SOUND.tobytes()


def test_transcripts_in_pieces_are_passed_over_for_the_whole_one() -> None:
    def turn(_events, send, _raw) -> None:
        for kind in ("transcript-start", "transcript-chunk", "transcript-stop"):
            send(Event(kind, {"text": "Go"}))
        send(Event("transcript", {"text": "Go to the kitchen."}))

    with wyoming_speech(turn) as server:
        assert _hears(server.address("stt")).text == "Go to the kitchen."


@pytest.mark.parametrize(
    ("raw", "kind", "says"),
    [
        (b"", Unreachable, "ended before"),
        (b"HTTP/1.1 400 Bad Request\r\n\r\n", Unusable, "not Wyoming"),
        (b"[1]\n", Unusable, "not Wyoming"),
        (b'{"type": 7}\n', Unusable, "not Wyoming"),
        (b'{"type": "transcript", "data": 7}\n', Unusable, "not Wyoming"),
        (b'{"type": "transcript", "data": {}}\n', OddAnswer, "without its fields"),
        (b'{"type": "transcript", "data": {"text": 7}}\n', OddAnswer, "not a transcript"),
        (b'{"type": "x", "payload_length": 99999999}\n', Unusable, "1 MiB"),
        (b'{"type": "x", "data_length": 99999999}\n', Unusable, "1 MiB"),
        (b'{"type": "x", "payload_length": "many"}\n', Unusable, "not Wyoming"),
        (b"x" * 70_000, Unusable, "line without end"),
        (b"[" * 60_000 + b"\n", Unusable, "not Wyoming"),
        (b'{"type": "transcript", "data_length": 50}\n{"te', Unreachable, "ended before"),
    ],
    ids=range(13),
)
def test_what_is_no_wyoming_is_an_error_never_a_crash(raw: bytes, kind, says: str) -> None:
    sends = wyoming_speech(lambda _events, _send, stream: stream.write(raw))
    with sends as server, pytest.raises(kind, match=says):
        _hears(server.address("stt"))


def test_an_answer_without_end_is_cut_off() -> None:
    def turn(_events, _send, raw) -> None:
        while True:
            raw.write(b'{"type": "x", "payload_length": 1000000}\n' + bytes(1_000_000))

    with wyoming_speech(turn) as server, pytest.raises(Unusable, match="16 MiB"):
        _hears(server.address("stt"))


def test_an_error_that_the_server_tells_is_odd() -> None:
    tells = wyoming_speech(lambda _e, send, _r: send(Error(text="no\nmodel").event()))
    with tells as server, pytest.raises(OddAnswer, match="no model"):
        _hears(server.address("stt"))


def test_a_wyoming_server_that_hangs_is_given_up() -> None:
    over = threading.Event()
    with wyoming_speech(lambda *_: over.wait(HUNG_S)) as server:
        with pytest.raises(Unreachable, match="in time"):
            _hears(server.address("stt", timeout_s=0.3))
        over.set()


def test_nothing_that_was_said_is_logged(caplog: pytest.LogCaptureFixture) -> None:
    with caplog.at_level(logging.DEBUG), http_speech(hears=lambda one: one.reply(GOOD)) as server:
        _hears(server.address("stt"))
    assert "kitchen" not in caplog.text
