"""The servers that are asked before what is on board: what the doctor tells of them."""

import pytest
from doctor_rig import OK, WARNING, levels, situation
from speech_server import NOT_FOUND, http_speech, wav_of, wyoming_speech
from wyoming.error import Error
from wyoming.info import Info

from edgevox.apps.doctor.servers import judge_servers, probe_servers

VOICE = {"tts_endpoint_voice": "amy"}


def told(**settings):
    asked = situation(**settings)
    return judge_servers(probe_servers(asked), asked)


def texts(said):
    return [one.found for one in said]


def test_without_a_server_it_says_that_all_stays_on_board():
    said = told()
    assert levels(said) == [OK]
    assert said.found == "none: hearing, speech and language stay on board"


def test_it_tells_what_is_sent_to_each_server_and_that_it_is_readable_on_the_way():
    routes = {"hears": NOT_FOUND, "speaks": lambda one: one.reply(wav_of(), kind="audio/wav")}
    with http_speech(**routes) as server:
        url = server.address("stt").url
        said = told(stt_endpoint=url, tts_endpoint=url, llm_endpoint=url)
    host = url.removeprefix("http://")
    assert levels(said) == [OK, OK, OK]
    assert texts(said) == [
        f"llm_endpoint sends {host} what people say, in words, unencrypted. It answers",
        f"stt_endpoint sends {host} the sound of what people say, unencrypted. It answers",
        f"tts_endpoint sends {host} what the robot says, in words, unencrypted. It answers",
    ]


def test_where_no_sound_is_heard_only_the_language_models_server_is_asked():
    assert levels(told(stt_endpoint="tcp://127.0.0.1:1", text_mode=True)) == [OK]


@pytest.mark.parametrize(
    ("setting", "says"),
    [("stt_endpoint", "does not transcribe"), ("tts_endpoint", "no voice for English")],
)
def test_a_server_by_wyoming_that_does_not_do_it_is_a_warning(setting, says):
    with wyoming_speech(lambda _events, send, _raw: send(Info().event())) as server:
        said = told(**{setting: server.address("stt").url})
    assert levels(said) == [WARNING]
    assert says in said[0].found
    assert setting in said[0].advice


def test_one_that_cannot_load_the_voice_that_it_lists_is_a_warning():
    with wyoming_speech(lambda _events, send, _raw: send(Error("no such file").event())) as server:
        (said,) = told(tts_endpoint=server.address("tts").url, **VOICE)
    assert said.level == WARNING
    assert "no such file" in said.found


def test_one_that_is_away_is_a_warning_and_what_would_be_sent_is_told_all_the_same():
    (said,) = told(stt_endpoint="http://127.0.0.1:1", stt_endpoint_timeout=0.5)
    assert said.level == WARNING
    assert said.found.startswith("stt_endpoint sends 127.0.0.1:1 the sound of what people say")
    assert "It fails: " in said.found
