"""What an agent's metrics are read from: its parts, and never a value that the table has not."""

from collections.abc import Mapping
from contextlib import ExitStack
from types import SimpleNamespace

import pytest
from prometheus_client.parser import text_string_to_metric_families

from edgevox.agent.llm.remote_model import FallbackModel
from edgevox.agent.policy import Denied, Guard
from edgevox.agent.text.reasons import because
from edgevox.apps import metrics
from edgevox.apps.agent.build import list_components
from edgevox.core.bus import Bus
from edgevox.core.cancel import CancelToken
from edgevox.core.commands import Way
from edgevox.core.motion.interlock import Interlock
from edgevox.core.servers.errors import Unreachable
from edgevox.core.servers.health import ServerHealth
from edgevox.core.settings import check_settings
from edgevox.core.status import Components, Gauges
from edgevox.ops.health import Health
from edgevox.ops.metric_table import METRICS
from edgevox.robots.flat.apartment import ApartmentRobot
from edgevox.robots.world.load import load_world
from edgevox.ros2.open import NullBridge

ELSEWHERE = ("recorder.", "metrics.")
"""What a program of its own says, and what `/metrics` says of itself."""


class Server:
    """A model on a server that has gone, or one on board that has not."""

    name, context_tokens = "model", 4096

    def __init__(self, *, gone: bool) -> None:
        self.gone = gone

    def generate(self, messages, *, grammar, max_tokens, token):
        if self.gone:
            raise Unreachable("nobody answers")
        yield "Hello."


HEARING = ServerHealth("stt", "voice:1", "the model on board")


@pytest.fixture
def parts(tmp_path):
    """An agent as far as its metrics go."""
    (tmp_path / "model.bin").write_bytes(b"x" * 1000)
    (tmp_path / "voice.onnx").write_bytes(b"x" * 20)
    settings = check_settings({"llm_endpoint": "http://llm:8080", "metrics_port": 1})
    synthesiser = SimpleNamespace(failures=5, last=None, fault="")
    components = Components()
    return SimpleNamespace(
        settings=settings,
        name="robot-apartment",
        body=ApartmentRobot(load_world(), speed=0.0),
        controls=SimpleNamespace(language="fr", voice="", muted=True),
        conversation=SimpleNamespace(refusals={"too_many": 1, "too_long": 8}),
        model=FallbackModel(Server(gone=True), Server(gone=False)),
        model_path=tmp_path / "model.bin",
        voice=SimpleNamespace(
            speech_output=SimpleNamespace(alive=True, refused=3, synthesiser=synthesiser),
            source=SimpleNamespace(name="a microphone", dropped=7),
            sink=SimpleNamespace(name="a loudspeaker"),
            stt=SimpleNamespace(),
            hearing=SimpleNamespace(shared=SimpleNamespace(health=HEARING, on_board_fault="")),
            speech=SimpleNamespace(health=ServerHealth("tts", "voice:1", "a voice on board")),
            weights=lambda: {"stt": (tmp_path,), "tts": frozenset({tmp_path / "voice.onnx"})},
        ),
        listener=SimpleNamespace(
            alive=True, failed=4, transcriber=SimpleNamespace(refused=2, failed=6, last=None)
        ),
        components=components,
        health=Health(components),
        absent="",
        guard=Guard(),
        interlock=Interlock(),
        skills=(),
    )


@pytest.fixture
def registry(parts, monkeypatch):
    """What is served, on a port of the machine's choice."""
    with ExitStack() as stack:
        server = "edgevox.ops.metrics.MetricsServer"
        monkeypatch.setattr(server, lambda *_: SimpleNamespace(start=int, close=int))
        bus = Bus()
        registry = metrics.serve_metrics(
            stack, parts.settings, bus, parts.components, parts.health, skills=parts.body.skills
        )
        parts.metrics = registry
        metrics.read_parts(parts)
        list_components(parts, Gauges(bus))
        parts.components.add(*NullBridge().components)
        metrics.read_bridge(parts, NullBridge())
        yield registry


def values(registry) -> dict:
    families = text_string_to_metric_families(registry.text().decode())
    return {
        (
            sample.name,
            *(sample.labels[name] for name in METRICS[family_name(sample.name)].labels),
        ): (sample.value)
        for family in families
        for sample in family.samples
        if family_name(sample.name) in METRICS
    }


def family_name(sample: str) -> str:
    return next((name for name, metric in METRICS.items() if sample in metric.series), "")


def test_what_the_parts_count_is_what_is_read(parts, registry) -> None:
    parts.guard.refuse(Denied(because("policy_denied"), Way.VOICE, "grasp"))
    told = values(registry)

    assert told["edgevox_policy_refusals_total", "voice", "policy_denied"] == 1
    assert told["edgevox_policy_broken",] == 0
    assert told["edgevox_dropped_total", "conversation"] == 1
    assert told["edgevox_refused_requests_total", "too_many"] == 1
    assert told["edgevox_refused_requests_total", "too_long"] == 8
    assert told["edgevox_dropped_total", "transcriber"] == 2
    assert told["edgevox_dropped_total", "speech_output"] == 3
    assert told["edgevox_dropped_total", "microphone"] == 7
    assert told["edgevox_failures_total", "listener"] == 4
    assert told["edgevox_failures_total", "speech_output"] == 5
    assert told["edgevox_failures_total", "transcriber"] == 6
    assert told["edgevox_model_weights_bytes", "llm"] == 1000
    assert told["edgevox_model_weights_bytes", "stt"] == 1020
    assert told["edgevox_model_weights_bytes", "tts"] == 20
    assert told["edgevox_build_info", metrics.__version__, "robot-apartment", "fr"] == 1
    assert told["edgevox_muted",] == 1
    assert told["edgevox_ready",] == 0, "nothing was started"
    assert told["edgevox_check_ok", "start"] == 0
    assert told["edgevox_failures_total", "executor"] == 0
    assert told["edgevox_executor_lag_seconds",] == 0
    assert told["edgevox_sim_real_time_factor",] == 0, "it is not known yet"
    assert told["edgevox_sim_stalled_seconds",] == 0
    assert told["edgevox_watchdog_halts_total",] == 0
    assert registry.failures == 0


def test_every_value_that_the_table_names_is_one_that_a_component_says(parts, registry) -> None:
    said = {f"{one.name}.{name}" for one in parts.components.statuses() for name in one.values}
    for metric in METRICS.values():
        if isinstance(metric.read, Mapping):
            shown = {place for place in metric.read.values() if not place.startswith(ELSEWHERE)}
            assert shown <= said, metric.name
            labels = [set(known) for known in metric.labels.values()] or [{""}]
            assert labels == [set(metric.read)]


def test_a_model_server_that_does_not_answer_is_down_and_the_fallback_counts(
    parts, registry
) -> None:
    assert values(registry)["edgevox_llm_server_up",] == 1

    said = parts.model.generate([], grammar=None, max_tokens=1, token=CancelToken())
    assert list(said) == ["Hello."]
    told = values(registry)
    assert told["edgevox_llm_server_up",] == 0
    assert told["edgevox_llm_fallbacks_total",] == 1


def test_no_label_has_a_value_that_the_table_has_not(registry) -> None:
    for name, *labels in values(registry):
        for known, value in zip(METRICS[family_name(name)].labels.values(), labels, strict=True):
            assert isinstance(known, str) or value in known, name
