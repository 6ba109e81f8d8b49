"""What a small program is: steps, repetitions, delays and conditions around calls of skills."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass

from edgevox.agent.skills import Call, SkillSet


@dataclass(frozen=True, slots=True)
class Do:
    """These calls, in their order."""

    calls: tuple[Call, ...]


@dataclass(frozen=True, slots=True)
class Say:
    """Say these words."""

    words: str


@dataclass(frozen=True, slots=True)
class Return:
    """Go back to where the robot stood when the program began to run."""


@dataclass(frozen=True, slots=True)
class Again:
    """What was ordered last."""


@dataclass(frozen=True, slots=True)
class Steps:
    """One after another; the next begins when the one before has succeeded."""

    steps: tuple["Program", ...]


@dataclass(frozen=True, slots=True)
class Repeat:
    """So many times, or until it is stopped where `count` is None."""

    program: "Program"
    count: float | None


@dataclass(frozen=True, slots=True)
class After:
    """When so much time has passed."""

    delay_s: float
    program: "Program"


@dataclass(frozen=True, slots=True)
class BatteryBelow:
    """The battery has less left than this."""

    percent: float


@dataclass(frozen=True, slots=True)
class Arrived:
    """What moves when this is said has come to its end."""


Condition = BatteryBelow | Arrived


@dataclass(frozen=True, slots=True)
class When:
    """As soon as something is so, once."""

    condition: Condition
    program: "Program"


Program = Do | Say | Return | Again | Steps | Repeat | After | When


def parts_of(program: Program) -> Iterator[Program]:
    """A program and all that is in it, from the outside inwards."""
    yield program
    match program:
        case Steps(steps=steps):
            for one in steps:
                yield from parts_of(one)
        case Repeat(program=inner) | After(program=inner) | When(program=inner):
            yield from parts_of(inner)


def calls_of(program: Program) -> tuple[Call, ...]:
    """All calls that it holds, each once."""
    return tuple(call for one in parts_of(program) if isinstance(one, Do) for call in one.calls)


def is_endless(program: Program) -> bool:
    """Whether it goes on until it is stopped."""
    return any(isinstance(one, Repeat) and one.count is None for one in parts_of(program))


def replaced(program: Program, leaf: Callable[[Do | Again], Program]) -> Program:
    """The same, with `leaf` of all calls and of what says "again" in their places."""
    match program:
        case Do() | Again():
            return leaf(program)
        case Steps(steps=steps):
            return Steps(tuple(replaced(one, leaf) for one in steps))
        case Repeat(program=inner, count=count):
            return Repeat(replaced(inner, leaf), count)
        case After(delay_s=delay_s, program=inner):
            return After(delay_s, replaced(inner, leaf))
        case When(condition=condition, program=inner):
            return When(condition, replaced(inner, leaf))
    return program


def kernel(program: Program) -> Program:
    """What is done each time: without repetitions, delays and conditions around it."""
    match program:
        case Repeat(program=inner) | After(program=inner) | When(program=inner):
            return kernel(inner)
    return program


def drives(program: Program, skills: SkillSet) -> bool:
    """Whether it sets the body in motion."""
    back = any(isinstance(one, Return) for one in parts_of(program))
    return back or any(skills[call.skill].drives for call in calls_of(program))


def moves(program: Program, skills: SkillSet) -> bool:
    """Whether it uses the body."""
    back = any(isinstance(one, Return) for one in parts_of(program))
    return back or any(skills[call.skill].moves for call in calls_of(program))
