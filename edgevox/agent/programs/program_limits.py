"""How much a program may be: what is more is refused, with a reason."""

from collections.abc import Collection

from edgevox.agent.going import no_way_back
from edgevox.agent.programs.program import (
    After,
    Again,
    BatteryBelow,
    Program,
    Repeat,
    Return,
    When,
    calls_of,
    parts_of,
)
from edgevox.agent.programs.senses import Senses
from edgevox.agent.reasons import because
from edgevox.agent.skill_executor import MAX_CALLS
from edgevox.agent.skills import Skill, SkillFailed

MAX_PROGRAMS = 8
"""How many programs may wait and run at a time."""
MAX_TIMES = 100
"""How often a program may repeat its steps, if it does not do so until it is stopped."""
LONGEST_WAIT_S = 24 * 3600.0
"""How long a program may wait for its time, or for what it waits for to be so."""
LONGEST_RUN_S = 8 * 3600.0
"""How long a program may run."""


def check_bounds(program: Program, senses: Senses, skills: Collection[Skill]) -> None:
    """Raise `SkillFailed` with the reason for a program that is too much, or cannot be.

    `skills` are all that the robot has.
    """
    if len(calls_of(program)) > MAX_CALLS:
        raise SkillFailed(because("program_long", count=str(MAX_CALLS)))
    delays_s = [one.delay_s for one in parts_of(program) if isinstance(one, After)]
    if sum(delays_s) > LONGEST_WAIT_S:
        raise SkillFailed(because("program_late", hours=f"{LONGEST_WAIT_S / 3600:g}"))
    for one in parts_of(program):
        _check_part(one, senses, skills)


def _check_part(part: Program, senses: Senses, skills: Collection[Skill]) -> None:
    match part:
        case Repeat(count=float() | int() as count) if not (
            count == int(count) and 1 <= count <= MAX_TIMES
        ):
            raise SkillFailed(because("program_times", said=f"{count:g}", count=str(MAX_TIMES)))
        case When(condition=BatteryBelow()) if senses.battery is None:
            raise SkillFailed(because("no_battery"))
        case When(condition=BatteryBelow(percent=percent)) if not 0 < percent < 100:
            raise SkillFailed(because("program_percent", said=f"{percent:g}"))
        case Return() if senses.way_back() is None:
            raise SkillFailed(no_way_back(skills))
        case Again():
            raise SkillFailed(because("nothing_before"))
