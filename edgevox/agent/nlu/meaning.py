"""The meaning of an utterance: calls to do at once, or a small program.

A program has steps, repetitions, delays and conditions around calls of skills.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

from edgevox.agent.agents import Agent
from edgevox.agent.skills import Call, SkillSet


@dataclass(frozen=True, slots=True)
class Do:
    """Do these calls, in their order."""

    calls: tuple[Call, ...]


@dataclass(frozen=True, slots=True)
class Say:
    """Say these words."""

    words: str


@dataclass(frozen=True, slots=True)
class Pause:
    """Wait between two steps."""

    seconds: float


@dataclass(frozen=True, slots=True)
class Return:
    """Go back to where the robot stood when the program began to run."""


@dataclass(frozen=True, slots=True)
class Again:
    """Do the last order again."""


@dataclass(frozen=True, slots=True)
class Steps:
    """Do these steps in sequence; each begins when the one before has succeeded."""

    steps: tuple["Program", ...]


@dataclass(frozen=True, slots=True)
class Repeat:
    """Repeat a program."""

    program: "Program"
    """The program of each round."""
    count: float | None
    """Number of rounds; None to repeat until a stop."""


@dataclass(frozen=True, slots=True)
class After:
    """Start a program after a delay."""

    delay_s: float
    """The delay in seconds."""
    program: "Program"
    """The program."""


@dataclass(frozen=True, slots=True)
class BatteryBelow:
    """Condition: the battery's charge is below this."""

    percent: float


@dataclass(frozen=True, slots=True)
class Arrived:
    """Condition: the motion that runs at the time of the order has reached its end."""


@dataclass(frozen=True, slots=True)
class StateIs:
    """Condition: what the robot tells of itself is so."""

    name: str
    """The name of the condition, among those that the robot knows."""
    said: str
    """The words that it was named by."""
    value: float | None = None
    """The number that it compares with, if one was said."""


Condition = BatteryBelow | StateIs | Arrived


@dataclass(frozen=True, slots=True)
class When:
    """Start a program once, as soon as a condition is true."""

    condition: Condition
    program: "Program"


Program = Do | Say | Pause | Return | Again | Steps | Repeat | After | When


def parts_of(program: Program) -> Iterator[Program]:
    """A program and all programs inside it, from the outside inwards."""
    yield program
    match program:
        case Steps(steps=steps):
            for one in steps:
                yield from parts_of(one)
        case Repeat(program=inner) | After(program=inner) | When(program=inner):
            yield from parts_of(inner)


def calls_of(program: Program) -> tuple[Call, ...]:
    """All calls inside a program, each once."""
    return tuple(call for one in parts_of(program) if isinstance(one, Do) for call in one.calls)


def is_endless(program: Program) -> bool:
    """True if a program goes on until it is stopped."""
    return any(isinstance(one, Repeat) and one.count is None for one in parts_of(program))


def replaced(program: Program, leaf: Callable[[Do | Again], Program]) -> Program:
    """The program with each `Do` and `Again` replaced by its `leaf`."""
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
    """The innermost program, without repetitions, delays and conditions around it."""
    match program:
        case Repeat(program=inner) | After(program=inner) | When(program=inner):
            return kernel(inner)
    return program


def drives(program: Program, skills: SkillSet) -> bool:
    """True if a program sets the body in motion."""
    back = any(isinstance(one, Return) for one in parts_of(program))
    return back or any(skills[call.skill].drives for call in calls_of(program))


def moves(program: Program, skills: SkillSet) -> bool:
    """True if a program uses the body."""
    back = any(isinstance(one, Return) for one in parts_of(program))
    return back or any(skills[call.skill].moves for call in calls_of(program))


ASK_FROM, SURE_FROM = 0.5, 0.8
"""Confidences from which on the robot asks, and acts without asking; below both it does nothing."""

BACK = "go_back"
"""Name of the dialogue skill that leads back to where the last motion began."""
THE_OTHER, RESUME, THERE = "the_other", "resume", "go_there"
REFERENCES = ("again", BACK, THERE, "further", RESUME, THE_OTHER)
"""Names of the dialogue skills that refer to what was done or spoken of before."""

IT = "it"
"""Value of an argument that is the thing spoken of last; it names nothing."""

HEARD_FROM = 0.8
"""Product of the confidences of hearing and of meaning below which the robot asks before a motion.
Of 1,152 commands by the tuning voices (`training/acoustics`), in noise at 10, 5 and 0 dB, no wrong
one was done, with a lower confidence for words that were only expected
(`edgevox.voice.stt.speech_to_text`); with 0.75 one was."""


@dataclass(frozen=True, slots=True)
class Meaning:
    """The meaning of an utterance: calls to do at once, or a program."""

    agent: Agent
    """The agent whose skills are called."""
    calls: tuple[Call, ...]
    """Calls to do at once; empty for a program."""
    source: str
    """The stage that found the meaning: ``template`` or ``reading``."""
    confidence: float = 1.0
    """Confidence in the meaning, 1 for a template; below `SURE_FROM` the robot asks."""
    program: Program | None = None
    """An order for later, or for more than once."""

    @property
    def sure(self) -> bool:
        """True if it may be done without asking."""
        return self.confidence >= SURE_FROM

    def heard(self, confidence: float) -> "Meaning":
        """The meaning of words with this recognition confidence; unsure if the product is low."""
        unsure_anyway = confidence >= HEARD_FROM and not self.sure
        if self.confidence * confidence >= HEARD_FROM or unsure_anyway:
            return self
        return replace(self, confidence=min(self.confidence, ASK_FROM))

    @property
    def every_call(self) -> tuple[Call, ...]:
        """All calls, those inside the program included."""
        return calls_of(self.program) if self.program else self.calls
