"""Results of benchmarks that nobody measured, for the tests of what keeps and shows them."""

from datetime import UTC, datetime
from typing import Any

from benchmarks.core import environment as describing
from benchmarks.core import front, render, run
from benchmarks.core.calibration import calibrated
from benchmarks.core.environment import Environment
from benchmarks.core.figures import Figure, Measured, NotHere
from benchmarks.core.listed import BENCHMARKS, FRONT
from benchmarks.core.plots import Bar, Dot, bars, reliability
from benchmarks.core.results import FRONT_FILE, BadResults, Results, read, write
from benchmarks.core.tables import measured, number
from benchmarks.robots import sim

__all__ = [
    "BENCHMARKS",
    "FRONT",
    "FRONT_FILE",
    "BadResults",
    "Bar",
    "Dot",
    "Measured",
    "NotHere",
    "bars",
    "calibrated",
    "describing",
    "front",
    "measured",
    "number",
    "read",
    "reliability",
    "render",
    "run",
    "sim",
    "write",
]

BEGAN = datetime(2026, 3, 14, 15, 9, tzinfo=UTC)


def environment(processor: str = "Abacus", python: str = "3.12.1") -> Environment:
    machine = {
        "processor": processor,
        "cores": 2,
        "memory_gb": 8,
        "system": "Debian",
        "kernel": "6.1",
        "architecture": "x86_64",
    }
    return Environment.model_validate({"machine": machine, "versions": {"python": python}})


def found(*values: float, **more: Any) -> Measured:
    """A figure, and what a plain library reached."""
    ours = Figure.of("ours", "Speed", "ours", values, "ms", baseline="plain", **more)
    return Measured(figures=(ours, Figure.of("plain", "Speed", "plain", [2.0], "ms")))


def with_run(results: Results, name: str, measured: Measured, **more: Any) -> Results:
    given: dict[str, Any] = {
        "where": environment(),
        "began": BEGAN,
        "took_s": 1.5,
        "commit": ("abc123", False),
        "quick": False,
        "load_before": 0.1,
    }
    return results.with_run(name, measured, **(given | more))
