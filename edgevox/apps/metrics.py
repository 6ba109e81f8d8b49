"""What an agent's metrics are read from. Where they are off, nothing of them is even imported."""

import os
import threading
from collections.abc import Iterable, Mapping
from contextlib import ExitStack
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING

from edgevox import __version__
from edgevox.agent.skills import Skill
from edgevox.apps.parts import Parts
from edgevox.apps.voice import Voice, dropped_frames
from edgevox.core.bus import Bus
from edgevox.core.refusals import Refusal
from edgevox.core.settings import Settings
from edgevox.ops.health import Health
from edgevox.robots.capabilities import CountsHalts, KeepsPace, TellsStalls
from edgevox.ros2 import Bridge
from edgevox.voice.ears import Ears

if TYPE_CHECKING:
    from edgevox.ops.metrics import Registry
    from edgevox.ros2.recorder import Recorder

_TASKS = "/proc/self/task"


def serve_metrics(
    stack: ExitStack, settings: Settings, bus: Bus, health: Health, skills: Iterable[Skill]
) -> "Registry | None":
    """Count what happens on the bus and serve it, if a port says so. Raises `InvalidValue`."""
    if not settings.metrics_port:
        return None
    from edgevox.ops.metrics import Registry, observe
    from edgevox.ops.metrics.table import SKILLS

    registry = Registry({SKILLS: [skill.name for skill in skills]})
    _serve(stack, settings, registry, health)
    stack.callback(observe(bus, registry))
    return registry


def serve_recorders_metrics(
    stack: ExitStack, settings: Settings, health: Health, recorder: "Recorder"
) -> None:
    """Serve what a recorder counts, if a port says so. Raises `InvalidValue`."""
    if not settings.metrics_port:
        return
    from edgevox.ops.metrics import Registry

    registry = Registry(None)
    told: Mapping[tuple[str, ...], float] = {
        (__version__, "edgevox-recorder", settings.language): 1.0
    }
    registry.read("edgevox_build_info", lambda: told)
    registry.read("edgevox_recorded_messages_total", lambda: recorder.written)
    registry.read("edgevox_dropped_total", lambda: {"recorder": sum(recorder.dropped.values())})
    registry.read("edgevox_executor_lag_seconds", lambda: recorder.ros.lag_s)
    _serve(stack, settings, registry, health)


def read_parts(parts: Parts) -> None:
    """From now on, what the parts of an agent count can be read."""
    metrics = parts.metrics
    if metrics is None:
        return
    metrics.read("edgevox_build_info", lambda: _build_info(parts))
    metrics.read("edgevox_muted", lambda: parts.controls.muted)
    metrics.read("edgevox_dropped_total", lambda: _dropped(parts))
    metrics.read("edgevox_refused_requests_total", lambda: parts.conversation.refusals)
    metrics.read("edgevox_failures_total", lambda: _failures(parts))
    metrics.read("edgevox_model_weights_bytes", lambda: _weights(parts))
    _read_body(metrics, parts)
    _read_server(metrics, parts)


def read_bridge(parts: Parts, bridge: Bridge) -> None:
    """From now on, what the bridge counts can be read."""
    metrics = parts.metrics
    if metrics is None:
        return
    metrics.read("edgevox_executor_lag_seconds", lambda: bridge.lag_s)
    metrics.read("edgevox_refused_messages_total", lambda: bridge.refusals)
    metrics.read("edgevox_failures_total", lambda: {**_failures(parts), **bridge.failures})


def _serve(stack: ExitStack, settings: Settings, registry: "Registry", health: Health) -> None:
    from edgevox.ops.metrics import MetricsServer

    registry.read("edgevox_threads", count_threads)
    registry.read("edgevox_ready", lambda: health.ready().well)
    registry.read(
        "edgevox_check_ok", lambda: {n: not said for n, said in health.ready().checks.items()}
    )
    server = MetricsServer(registry, settings.metrics_host, settings.metrics_port)
    stack.callback(server.close)
    server.start()


def _build_info(parts: Parts) -> Mapping[tuple[str, ...], float]:
    return {(__version__, parts.name, parts.controls.language): 1.0}


def count_threads() -> int:
    """All threads of the process; where the system does not say, those of Python."""
    return len(os.listdir(_TASKS)) if os.path.isdir(_TASKS) else threading.active_count()


def _read_body(metrics: "Registry", parts: Parts) -> None:
    body = parts.body
    if isinstance(body, KeepsPace):
        metrics.read("edgevox_sim_real_time_factor", lambda: body.real_time_factor)
        if isinstance(body, TellsStalls):
            metrics.read("edgevox_sim_stalled_seconds", lambda: body.stalled_s)
    if isinstance(body, CountsHalts):
        metrics.read("edgevox_watchdog_halts_total", lambda: body.watchdog_halts)


def _read_server(metrics: "Registry", parts: Parts) -> None:
    model = parts.model
    if not parts.settings.llm_endpoint:
        return
    from edgevox.agent.llm.endpoint import FallbackModel  # which needs an HTTP client

    if isinstance(model, FallbackModel):
        metrics.read("edgevox_llm_fallbacks_total", lambda: model.fallbacks)
        metrics.read("edgevox_llm_server_up", lambda: not model.trouble)


def _dropped(parts: Parts) -> Mapping[str, float]:
    found: dict[str, float] = {"conversation": parts.conversation.refusals[Refusal.TOO_MANY]}
    if parts.voice and parts.ears:
        found["microphone"] = dropped_frames(parts.voice.source)
        found["understanding"] = parts.ears.understanding.refused
        found["mouth"] = parts.voice.mouth.refused
    return found


def _failures(parts: Parts) -> Mapping[str, float]:
    found: dict[str, float] = {}
    if isinstance(parts.body, KeepsPace):
        found["body"] = parts.body.breaks
    if parts.voice and parts.ears:
        found |= _failures_of_sound(parts.voice, parts.ears)
    return found


def _failures_of_sound(voice: Voice, ears: Ears) -> Mapping[str, float]:
    return {
        "ears": ears.failed,
        "understanding": ears.understanding.failed,
        "mouth": voice.mouth.speaker.failures,
    }


def _weights(parts: Parts) -> Mapping[str, float]:
    loaded: dict[str, Iterable[Path]] = {"llm": [parts.model_path] if parts.model_path else []}
    if parts.voice:
        loaded |= parts.voice.weights()
    return {name: sum(map(_size_bytes, paths)) for name, paths in loaded.items()}


@cache
def _size_bytes(path: Path) -> int:
    """Of a file, or of all in a folder. Weights do not change while they are loaded."""
    files = path.rglob("*") if path.is_dir() else (path,)
    return sum(file.stat().st_size for file in files if file.is_file())
