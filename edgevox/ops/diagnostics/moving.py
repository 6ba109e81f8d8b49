"""The components `sim` and `executor`: what lives by stepping on."""

from dataclasses import dataclass

from edgevox.ops.diagnostics.component import Component, Finding, Level, component
from edgevox.ops.health import STALL_S

LATE_S = 1.0
"""What should move and has not for this long is worth a word; after `STALL_S` it is frozen."""
SLOW = 0.9
"""A world that keeps less than this part of its pace is slow."""
LOW_BATTERY = 0.15


@dataclass(frozen=True, slots=True)
class World:
    """What is known of a body. `pace` is which part of the speed that was asked for it keeps,
    None where none was; `breaks` how often its physics or a step of it failed.
    """

    body: str
    stalled_s: float = 0.0
    real_time_factor: float | None = None
    pace: float | None = None
    breaks: int = 0
    breaking: bool = False
    battery: float | None = None
    trouble: str = ""


def sim(seen: World) -> Component:
    """Standing still, breaking and having no robot are errors; being slow is a warning."""
    found = _stall(seen.stalled_s, "the world has")
    if seen.trouble:
        found.append(Finding(Level.ERROR, seen.trouble))
    if seen.breaking:
        text = f"its numbers broke and it was put back, {seen.breaks} times by now"
        found.append(Finding(Level.ERROR, text))
    if seen.pace is not None and seen.pace < SLOW:
        found.append(Finding(Level.WARN, f"slow: keeps {100 * seen.pace:.0f} % of its pace"))
    if seen.battery is not None and seen.battery < LOW_BATTERY:
        level = Level.WARN if seen.battery else Level.ERROR
        found.append(Finding(level, f"battery at {100 * seen.battery:.0f} %"))
    return component(
        "sim",
        found,
        well="runs",
        body=seen.body,
        real_time_factor=seen.real_time_factor,
        stalled_s=seen.stalled_s,
        broke=seen.breaks,
        battery=seen.battery,
    )


@dataclass(frozen=True, slots=True)
class Executing:
    """What is known of the thread that runs ROS 2's callbacks. `missing` says why there is none."""

    stalled_s: float = 0.0
    failed: int = 0
    failing: bool = False
    missing: str = ""


def executor(seen: Executing) -> Component:
    """A callback that holds up the others is a warning, later an error; so is one that failed."""
    found = _stall(seen.stalled_s, "a callback holds up all others: nothing has")
    if seen.missing:
        found.append(Finding(Level.ERROR, f"not on ROS 2: {seen.missing}"))
    if seen.failing:
        text = f"a callback failed, {seen.failed} by now; the log says why"
        found.append(Finding(Level.WARN, text))
    return component(
        "executor", found, well="turns", stalled_s=seen.stalled_s, failed_callbacks=seen.failed
    )


def _stall(seconds: float, what: str) -> list[Finding]:
    if seconds <= LATE_S:
        return []
    level = Level.ERROR if seconds > STALL_S else Level.WARN
    return [Finding(level, f"{what} not moved for {seconds:.1f} s")]
