"""A program that is kept: what is left of it, when it is due, and how far it is."""

from collections.abc import Callable
from dataclasses import dataclass, field

from edgevox.agent.goals import Goal
from edgevox.agent.programs.program import Program
from edgevox.core.agent_events import ProgramStatus
from edgevox.core.ways import Way


def _nothing() -> None:
    """There is nothing to call off."""


@dataclass(eq=False, slots=True)
class Kept:
    """One program from its order to its end. Only who keeps it changes it.

    `program` is what is left of it: without the delay, once that is over. `due_s` is the clock's
    time when it goes on by itself, `goal` what runs its steps, `round` how often they were begun.
    `way` is how it was asked for, in which `turn` and at which `mark` of the interlock, and
    `confirmed` whether somebody said yes to it.
    """

    id: str
    program: Program
    turn: int
    way: Way
    mark: int
    confirmed: bool = False
    due_s: float | None = None
    round: int | None = None
    goal: Goal | None = None
    call_off: Callable[[], None] = field(default=_nothing)

    @property
    def status(self) -> ProgramStatus:
        """What it does while it is kept."""
        return ProgramStatus.RUNNING if self.goal else ProgramStatus.WAITING
