"""The last drive that somebody asked for in words: what "no, the bedroom" corrects."""

from dataclasses import dataclass

from edgevox.agent.agents import Agent
from edgevox.agent.skills import Call
from edgevox.core.agent_events import GOAL_ENDS, GoalCancelled, GoalChanged
from edgevox.core.bus import Bus
from edgevox.core.clock import Clock

CORRECTED_S = 20.0
"""A drive can be corrected while it runs and for so long after its end."""


@dataclass(frozen=True, slots=True)
class DriveCall:
    """A call that set the body in motion, in which turn, and whose skill it is."""

    agent: Agent
    call: Call
    turn: int


class LastDrive:
    """Remembers it. Begun and looked at from one thread; how it ends comes from any."""

    def __init__(self, bus: Bus, clock: Clock) -> None:
        self._clock = clock
        self._drive: DriveCall | None = None
        self._ends_s: dict[int, float] = {}
        bus.subscribe(GoalChanged, self._on_goal)
        bus.subscribe(GoalCancelled, self._on_goal)

    @property
    def corrigible(self) -> DriveCall | None:
        """The drive, if somebody may still correct it."""
        drive = self._drive
        if drive is None:
            return None
        ended_s = self._ends_s.get(drive.turn)
        late = ended_s is not None and self._clock.now() - ended_s > CORRECTED_S
        return None if late else drive

    def begin(self, drive: DriveCall) -> None:
        """Remember this one instead; before it begins, so that no end is missed."""
        self._drive, self._ends_s = drive, {}

    def forget(self) -> None:
        """There is none to correct."""
        self._drive = None

    def _on_goal(self, event: GoalChanged | GoalCancelled) -> None:
        drive = self._drive
        mine = drive and (event.turn, event.skill) == (drive.turn, drive.call.skill)
        if mine and event.status in GOAL_ENDS:
            self._ends_s[event.turn] = self._clock.now()
