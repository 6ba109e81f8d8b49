"""Permission for programs and for each of their steps, by the bounds and the policy."""

from collections.abc import Callable, Mapping, Sequence
from typing import Any, Protocol

from edgevox.agent.goals.executor import Follower
from edgevox.agent.goals.goal import Goal
from edgevox.agent.nlu.orders import Program, calls_of
from edgevox.agent.phrases.phrasebook import Phrasebook
from edgevox.agent.programs.senses import Senses
from edgevox.agent.programs.store import Kept, check_bounds
from edgevox.agent.skills import Call, SkillFailed, SkillSet
from edgevox.agent.turn import Turn
from edgevox.core.commands import Way
from edgevox.core.events import Outcome


class Hands(Protocol):
    """Checks and runs the steps of programs: the `SkillExecutor` does."""

    def follow(self, follower: Follower) -> None:
        """Tell the follower of stops and of the ends of goals."""

    @property
    def moving(self) -> Goal | None:
        """The last of the goals that move or wait to move."""

    def prepare(
        self, calls: Sequence[Call], skills: SkillSet, turn: Turn, *, confirmed: bool = False
    ) -> Sequence[Goal]:
        """Goals of these calls; if one is not allowed, say so and return none."""

    def check(
        self,
        call: Call,
        skills: SkillSet,
        way: Way,
        turn: int = 0,
        *,
        mark: int | None = None,
        confirmed: bool = False,
    ) -> Mapping[str, Any]:
        """Raise for a call that is not allowed."""

    def step(
        self,
        call: Call,
        skills: SkillSet,
        way: Way,
        turn: int,
        *,
        mark: int,
        confirmed: bool = False,
    ) -> Goal:
        """Check a call now and return its goal."""

    def launch(self, goal: Goal, may: Callable[[], bool]) -> bool:
        """Run a goal, unless `may` returns False."""


class Permission:
    """Asks the policy about a program, by the way of its order: at the order and at each step."""

    def __init__(
        self, hands: Hands, skills: SkillSet, senses: Senses, phrases: Callable[[], Phrasebook]
    ) -> None:
        self._hands = hands
        self._skills = skills
        self._senses = senses
        self._phrases = phrases

    def is_given(self, program: Program, turn: Turn, *, confirmed: bool = False) -> bool:
        """True if the program may be kept; if not, say why.

        Raises `NeedsConfirmation` if the policy wants a yes and the program is not `confirmed`.
        """
        try:
            check_bounds(program, self._senses, self._skills.values())
        except SkillFailed as error:
            turn.say(self._phrases().refusal(error.reason), Outcome.REFUSED)
            return False
        calls = calls_of(program)
        prepared = self._hands.prepare(calls, self._skills, turn, confirmed=confirmed)
        return bool(prepared) or not calls

    def check(self, kept: Kept) -> None:
        """Raise if the program is not allowed now."""
        check_bounds(kept.program, self._senses, self._skills.values())
        for call in calls_of(kept.program):
            self._hands.check(
                call,
                self._skills,
                kept.way,
                kept.turn,
                mark=kept.mark,
                confirmed=kept.confirmed,
            )

    def step(self, kept: Kept, call: Call) -> Goal:
        """The goal of a step that begins now. Raises if the step is not allowed."""
        return self._hands.step(
            call, self._skills, kept.way, kept.turn, mark=kept.mark, confirmed=kept.confirmed
        )
