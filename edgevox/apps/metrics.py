"""The server of an agent's metrics. Without metrics, none of their modules is imported."""

from collections.abc import Iterable, Mapping
from contextlib import ExitStack
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING

from edgevox import __version__
from edgevox.agent.skills import Skill
from edgevox.apps.agent.parts import AgentParts
from edgevox.core.bus import Bus
from edgevox.core.files.user_file import size_bytes
from edgevox.core.settings import Settings
from edgevox.core.status import Components
from edgevox.ops.health import Health
from edgevox.ops.machine import count_threads
from edgevox.ros2 import Bridge

if TYPE_CHECKING:
    from edgevox.ops.metrics import Registry
    from edgevox.ros2.recorder import Recorder


def serve_metrics(
    stack: ExitStack,
    settings: Settings,
    bus: Bus,
    components: Components,
    health: Health,
    *,
    skills: Iterable[Skill],
) -> "Registry | None":
    """Count what happens on the bus and serve it, if a port says so. Raises `InvalidValue`."""
    if not settings.metrics_port:
        return None
    from edgevox.ops.metric_table import SKILLS
    from edgevox.ops.metrics import Registry, observe

    registry = Registry({SKILLS: [skill.name for skill in skills]}, components)
    _serve(stack, settings, registry, health)
    stack.callback(observe(bus, registry))
    return registry


def serve_recorders_metrics(
    stack: ExitStack, settings: Settings, health: Health, recorder: "Recorder"
) -> None:
    """Serve what a recorder says of itself, if a port says so. Raises `InvalidValue`."""
    if not settings.metrics_port:
        return
    from edgevox.ops.metrics import Registry

    registry = Registry(None, Components(recorder))
    told: Mapping[tuple[str, ...], float] = {
        (__version__, "edgevox-recorder", settings.language): 1.0
    }
    registry.read("edgevox_build_info", lambda: told)
    registry.read("edgevox_executor_lag_seconds", lambda: recorder.ros.lag_s)
    _serve(stack, settings, registry, health)


def read_parts(parts: AgentParts) -> None:
    """Add metrics that no component reports: running parts, a control, sizes of files."""
    metrics = parts.metrics
    if metrics is None:
        return
    metrics.read("edgevox_build_info", lambda: _build_info(parts))
    metrics.read("edgevox_muted", lambda: parts.controls.muted)
    metrics.read("edgevox_model_weights_bytes", lambda: _weights(parts))
    metrics.read("edgevox_policy_refusals_total", lambda: parts.guard.refusals)


def read_bridge(parts: AgentParts, bridge: Bridge) -> None:
    """Add the numbers of messages that the bridge refused, by topic and reason."""
    if parts.metrics is not None:
        parts.metrics.read("edgevox_refused_messages_total", lambda: bridge.refusals)


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


def _build_info(parts: AgentParts) -> Mapping[tuple[str, ...], float]:
    return {(__version__, parts.name, parts.controls.language): 1.0}


def _weights(parts: AgentParts) -> Mapping[str, float]:
    loaded: dict[str, Iterable[Path]] = {"llm": [parts.model_path] if parts.model_path else []}
    if parts.voice:
        loaded |= parts.voice.weights()
    return {name: sum(map(_size_bytes, paths)) for name, paths in loaded.items()}


@cache
def _size_bytes(path: Path) -> int:
    """Return the size of a file or folder. Weights do not change while they are loaded."""
    files = path.rglob("*") if path.is_dir() else (path,)
    return sum(map(size_bytes, files))
