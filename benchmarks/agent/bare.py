"""`edgevox-agent` without logs of what happens, gauges and diagnostics: what the other is held to.

Nobody needs it but `overhead.py`, so there is no setting for it. Metrics are off by default.
"""

import sys
from collections.abc import Callable
from types import ModuleType
from typing import Any

from edgevox.apps.agent import build
from edgevox.apps.agent import main as agent
from edgevox.core.bus import Bus
from edgevox.ros2 import bridge


class Nothing:
    """Does nothing, in place of a part."""

    def __init__(self, *_: object, **__: object) -> None:
        pass

    def close(self) -> None:
        """Nor leaves anything behind."""


def replace(module: ModuleType, name: str, by: Callable[..., Any]) -> None:
    """Put something else in its place, which must be there: else nothing would be left out."""
    if not hasattr(module, name):
        raise AttributeError(f"{module.__name__} has no {name}: benchmarks/agent/bare.py is stale")
    setattr(module, name, by)


def main() -> int:
    """Run it; the process's exit code."""
    gauges = build.Gauges  # type: ignore[attr-defined]
    replace(build, "BusLog", Nothing)
    replace(build, "Gauges", lambda _: gauges(Bus()))  # of a bus on which nothing happens
    replace(bridge, "DiagnosticsPublisher", Nothing)
    return agent.main()


if __name__ == "__main__":
    sys.exit(main())
