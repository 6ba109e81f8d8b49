"""What a robot, simulated or not, says of itself: the component `sim`."""

from edgevox.core.clock import Clock
from edgevox.core.fault import fault_of
from edgevox.core.recent_increase import RecentIncrease
from edgevox.core.status import ComponentName, Finding, HealthCheck, Level, Status, moves, stall
from edgevox.robots.capabilities import (
    Body,
    CountsHalts,
    HasBattery,
    KeepsPace,
    RemembersPlaces,
    TellsStalls,
)

SLOW = 0.9
"""A world that keeps less than this part of its pace is slow."""
LOW_BATTERY = 0.15


class SimComponent:
    """Standing still, breaking and having no robot are errors; being slow is a warning."""

    name = ComponentName.SIM

    def __init__(self, body: Body, clock: Clock | None = None) -> None:
        self._body = body
        self._breaking = RecentIncrease(clock)
        self.checks = (
            (HealthCheck("body", moves(lambda: body.stalled_s)),)
            if isinstance(body, TellsStalls)
            else ()
        )

    def status(self) -> Status:
        """How it is now. A world that stands still may hold the lock that its battery is behind."""
        body, steps = self._body, self._body if isinstance(self._body, KeepsPace) else None
        stalled_s = body.stalled_s if isinstance(body, TellsStalls) else 0.0
        breaks = steps.breaks if steps else 0
        found = stall(stalled_s, "the world has")
        battery = body.battery() if isinstance(body, HasBattery) and not found else None
        if fault := fault_of(body):
            found.append(Finding(Level.ERROR, fault))
        if isinstance(body, RemembersPlaces) and (fault := body.place_memory.fault):
            found.append(Finding(Level.WARN, fault))
        if self._breaking.grew(breaks):
            text = f"its numbers broke and it was put back, {breaks} times by now"
            found.append(Finding(Level.ERROR, text))
        if steps and steps.pace is not None and steps.pace < SLOW:
            found.append(Finding(Level.WARN, f"slow: keeps {100 * steps.pace:.0f} % of its pace"))
        if battery is not None and battery < LOW_BATTERY:
            level = Level.WARN if battery else Level.ERROR
            found.append(Finding(level, f"battery at {100 * battery:.0f} %"))
        return Status.judged(
            self.name,
            found,
            well="runs",
            body=body.name,
            **({"real_time_factor": steps.real_time_factor or None} if steps else {}),
            stalled_s=stalled_s,
            broke=breaks,
            battery=battery,
            **({"watchdog_halts": body.watchdog_halts} if isinstance(body, CountsHalts) else {}),
        )
