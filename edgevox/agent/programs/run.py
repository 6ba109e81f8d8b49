"""The run of a program, step by step inside one goal, and its description in words.

As one goal, a program is pre-empted, cancelled, halted, and left behind if it hangs, as any goal
is. The description joins the sentences that the skills say when they begin.
"""

import itertools
from collections.abc import Callable, Iterable
from functools import partial

from edgevox.agent.goals.goal import Goal
from edgevox.agent.nlu.meaning import (
    After,
    Arrived,
    BatteryBelow,
    Do,
    Pause,
    Program,
    Repeat,
    Return,
    Say,
    StateIs,
    Steps,
    When,
    parts_of,
)
from edgevox.agent.phrases.phrasebook import Phrasebook
from edgevox.agent.skills import Call, GoalHandle, Result, Skill, SkillFailed, SkillSet, skill
from edgevox.agent.text.reasons import because
from edgevox.agent.text.words import continued
from edgevox.core.agent_events import GoalStatus
from edgevox.core.cancel import Cancelled
from edgevox.core.clock import Clock
from edgevox.core.errors import EdgeVoxError
from edgevox.core.reason import Reason


def in_words(program: Program, phrases: Phrasebook, skills: SkillSet) -> str:
    """The program described in one or more sentences."""
    match program:
        case Do(calls=calls):
            return phrases.chained([_call(call, phrases, skills) for call in calls])
        case Steps(steps=steps):
            return phrases.chained([in_words(one, phrases, skills) for one in steps])
        case Say(words=words):
            return phrases.say("program_saying", words=words)
        case Pause(seconds=seconds):
            return phrases.say("program_wait", duration=phrases.duration(seconds))
        case Return():
            return phrases.say("program_back")
        case Repeat(program=inner, count=None):
            return phrases.say("program_endless", order=_part(inner, phrases, skills))
        case Repeat(program=inner, count=count):
            order = _part(inner, phrases, skills)
            return phrases.say("program_times", count=f"{count:g}", order=order)
        case After(delay_s=delay_s, program=inner):
            duration = phrases.duration(delay_s)
            order = _part(inner, phrases, skills)
            return phrases.say("program_after", duration=duration, order=order)
        case When(condition=BatteryBelow(percent=percent), program=inner):
            order = _part(inner, phrases, skills)
            return phrases.say("program_low", percent=f"{percent:g}", order=order)
        case When(condition=StateIs(said=said), program=inner):
            order = _part(inner, phrases, skills)
            return phrases.say("program_when", condition=said, order=order)
        case When(condition=Arrived(), program=inner):
            return phrases.say("program_arrived", order=_part(inner, phrases, skills))
    raise TypeError(program)


def _part(program: Program, phrases: Phrasebook, skills: SkillSet) -> str:
    return continued(in_words(program, phrases, skills))


def _call(call: Call, phrases: Phrasebook, skills: SkillSet) -> str:
    one = skills[call.skill]
    try:
        said = phrases.acknowledge(one, one.validate(call.arguments))
    except EdgeVoxError:  # its place was forgotten since; the person is told when it is due
        said = ""
    return said or phrases.say("program_action", action=phrases.can(one))


SHORTEST_ROUND_S = 1.0
"""Least seconds of a round, so that a program of instant steps does not spin."""


class ProgramRun:
    """Runs the steps of one program.

    The ends of steps are announced in the first round only: a person who watches a patrol knows
    them after that.
    """

    def __init__(
        self,
        program: Program,
        *,
        make: Callable[[Call], Goal],
        announce: Callable[[str], None],
        phrases: Callable[[], Phrasebook],
        way_back: Callable[[], Call | None],
        clock: Clock,
        on_round: Callable[[int], None],
    ) -> None:
        """Store the program and its collaborators.

        Args:
            program: The program to run.
            make: Returns the checked goal of a call, or raises as `SkillExecutor.check`.
            announce: Says a sentence that no turn asked for.
            phrases: Returns the sentences of the current language.
            way_back: Returns the call that leads back to the pose now, or None.
            clock: Measures rounds.
            on_round: Called with the number of each round that begins, from 1 on.
        """
        self._program = program
        self._make = make
        self._announce = announce
        self._phrases = phrases
        self._way_back = way_back
        self._clock = clock
        self._on_round = on_round
        self._home: Call | None = None
        self._step: Goal | None = None
        self._first = True
        self._paused = False

    def as_skill(self, *, moves: bool) -> Skill:
        """The skill that the program's goal runs."""

        def program(goal: GoalHandle) -> Result:
            """Do the steps of a program."""
            if any(isinstance(part, Return) for part in parts_of(self._program)):
                self._home = self._way_back()
            self._do(self._program, goal)
            return {}

        return skill(moves=moves)(program)

    def left(self, reason: Reason) -> None:
        """Tell that the program has ended: end the current step too, even if it hangs."""
        if self._step is not None:
            self._step.end(GoalStatus.CANCELLED, reason)

    def _do(self, part: Program, goal: GoalHandle) -> None:
        goal.token.check()
        match part:
            case Do(calls=calls):
                for call in calls:
                    self._call(call, goal)
            case Steps(steps=steps):
                for one in steps:
                    self._do(one, goal)
            case Say(words=words):
                self._announce(words)
            case Pause(seconds=seconds):
                goal.token.wait(seconds)
                goal.token.check()
                self._paused = True
            case Return():
                if self._home is None:
                    raise SkillFailed(because("cannot_go_back"))
                self._call(self._home, goal)
            case Repeat(program=inner, count=count):
                rounds = itertools.count(1) if count is None else range(1, int(count) + 1)
                self._repeat(inner, rounds, goal)
            case _:
                raise TypeError(part)

    def _repeat(self, inner: Program, rounds: Iterable[int], goal: GoalHandle) -> None:
        for number in rounds:
            goal.token.check()
            began_s = self._clock.now()
            self._on_round(number)
            self._do(inner, goal)
            self._first = False
            left_s = SHORTEST_ROUND_S - (self._clock.now() - began_s)
            if left_s > 0:
                goal.token.wait(left_s)

    def _call(self, call: Call, goal: GoalHandle) -> None:
        """Run one step as a goal of its own, to its end."""
        goal.token.check()
        step = self._step = self._make(call)
        if self._paused:  # people nearby may not expect that it goes on
            self._paused = False
            self._announce(self._phrases().acknowledge(step.skill, step.arguments))
        step.accept()
        forget = goal.token.on_cancel(partial(_cancel, step, goal))
        step.run()
        forget()
        if step.status is GoalStatus.FAILED:
            raise SkillFailed(step.reason)
        if step.status is not GoalStatus.SUCCEEDED:
            goal.token.check()
            raise Cancelled(step.reason)
        if self._first:
            report = self._phrases().report(step.skill, step.arguments, step.result)
            if report:
                self._announce(report)


def _cancel(step: Goal, goal: GoalHandle) -> None:
    step.token.cancel(goal.token.why)
