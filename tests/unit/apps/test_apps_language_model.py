"""Which language model the settings give, and a robot that shares one."""

from pathlib import Path

import pytest

from edgevox.agent.llm.remote_model import FallbackModel
from edgevox.agent.llm.weights import Memory
from edgevox.apps.agent import models
from edgevox.apps.agent.models import LARGER, SMALLER, find_weights, open_model
from edgevox.apps.agent.queries import build_queries
from edgevox.core.bus import Bus
from edgevox.core.controls import Controls
from edgevox.core.errors import InvalidValue
from edgevox.core.settings import load_settings
from edgevox.models.store import ROOT_VARIABLE

WISH = "why does ice float on water?"


def test_without_a_model_and_without_a_server_there_is_none() -> None:
    assert open_model(load_settings({"llm": "none"}), None) is None


@pytest.mark.parametrize(
    ("llm", "free", "fetched", "chosen"),
    [
        ("auto", 6e9, True, LARGER),
        ("auto", 5.9e9, True, SMALLER),
        ("auto", 6e9, False, SMALLER),
        (SMALLER, 6e9, True, SMALLER),
        ("/a/model.gguf", 6e9, True, "/a/model.gguf"),
        ("none", 6e9, True, "none"),
    ],
)
def test_auto_takes_the_larger_model_where_it_is_and_fits(
    llm: str,
    free: float,
    fetched: bool,
    chosen: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(models, "read_memory", lambda: Memory(8 << 30, int(free)))
    monkeypatch.setenv(ROOT_VARIABLE, str(tmp_path))
    if fetched:
        monkeypatch.setattr(models, "locate", lambda name: tmp_path / name)

    assert models.chosen_llm(load_settings({"llm": llm})) == chosen


def test_a_server_alone_is_a_model() -> None:
    settings = load_settings({"llm": "none", "llm_endpoint": "http://127.0.0.1:9"})
    model = open_model(settings, find_weights(settings))

    assert isinstance(model, FallbackModel)
    model.close()


def test_the_query_for_models_names_the_server() -> None:
    controls = Controls(Bus(), language="en", voice="", muted=False, voices=lambda _: ())
    queries = build_queries(controls, None, endpoint="http://llm:8080")

    assert queries["model_info"]()["llm"] == {
        "model_path": None,
        "device": None,
        "endpoint": "http://llm:8080",
    }


@pytest.mark.parametrize(
    "url", ["llm:8080", "ftp://llm", "http://", "http://llm:x", "http://u:hunter@llm", "http://a b"]
)
def test_an_address_that_is_none_is_refused_without_showing_a_password(url: str) -> None:
    with pytest.raises(InvalidValue, match="llm_endpoint: got .*expected the address") as refused:
        load_settings({"llm_endpoint": url})

    assert "hunter" not in str(refused.value)


@pytest.mark.parametrize(
    "url",
    ["http://llm", "https://a-b.example:8443/v1", "http://[fd00::1]:80/", "http://10.0.0.1:1"],
)
def test_an_address_that_is_one_is_taken(url: str) -> None:
    assert load_settings({"llm_endpoint": url}).llm_endpoint == url


@pytest.mark.parametrize(
    ("written", "meant"),
    [
        ("http://llm:8080/v1/chat/completions", "http://llm:8080/v1"),
        ("http://llm:8080/v1/models/", "http://llm:8080/v1"),
        ("HTTP://llm:8080 ", "http://llm:8080"),
        ("  https://a.example/llm/v1", "https://a.example/llm/v1"),
    ],
)
def test_an_address_is_taken_for_what_it_plainly_is(written: str, meant: str) -> None:
    assert load_settings({"llm_endpoint": written}).llm_endpoint == meant


@pytest.mark.parametrize("setting", ["stt_endpoint", "tts_endpoint"])
def test_speech_has_servers_of_two_kinds(setting: str) -> None:
    for url in ("http://speech:8000/v1", "tcp://speech:10300", "wyoming://[fd00::1]:10200"):
        assert getattr(load_settings({setting: url}), setting) == url
    for url in ("speech:10300", "tcp://speech", "udp://speech:1", "tcp://speech:1/x"):
        with pytest.raises(InvalidValue, match=f"{setting}: got .*Wyoming"):
            load_settings({setting: url})
