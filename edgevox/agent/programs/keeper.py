"""The keeper of programs, which wait without a thread, are checked when they fire, and end.

The policy and the bounds are asked at the order and before each step.
"""

import uuid
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from typing import Any

from edgevox.agent.goals.executor import SkillExecutor
from edgevox.agent.goals.goal import Goal
from edgevox.agent.known import NOTHING_KNOWN, Known
from edgevox.agent.nlu.meaning import (
    After,
    BatteryBelow,
    Program,
    Repeat,
    StateIs,
    When,
    calls_of,
    drives,
    moves,
)
from edgevox.agent.phrases.phrasebook import Phrasebook
from edgevox.agent.programs.run import ProgramRun, in_words
from edgevox.agent.programs.store import (
    LONGEST_RUN_S,
    LONGEST_WAIT_S,
    Kept,
    ProgramStore,
    Timer,
    Waits,
    check_bounds,
)
from edgevox.agent.skills import Call, SkillFailed, SkillSet, reason_of
from edgevox.agent.text.reasons import because
from edgevox.agent.text.words import continued
from edgevox.agent.turn import Turn
from edgevox.core.agent_events import GoalCancelled, GoalChanged, GoalStatus, ProgramStatus, as_json
from edgevox.core.bus import Bus
from edgevox.core.clock import Clock
from edgevox.core.errors import EdgeVoxError, InvalidValue
from edgevox.core.events import Outcome
from edgevox.core.motion.deadlines import Deadlines
from edgevox.core.motion.interlock import Tell
from edgevox.core.reason import NO_REASON, Reason

LEAD_S = 2.0
"""Seconds from the announcement of a program that moves by itself to its motion."""


class _Permission:
    """Asks the policy about a program, by the way of its order: at the order and at each step."""

    def __init__(
        self,
        executor: SkillExecutor,
        skills: SkillSet,
        known: Known,
        phrases: Callable[[], Phrasebook],
    ) -> None:
        self._executor = executor
        self._skills = skills
        self._known = known
        self._phrases = phrases

    def is_given(self, program: Program, turn: Turn, *, confirmed: bool = False) -> bool:
        """True if the program may be kept; if not, say why.

        Raises `NeedsConfirmation` if the policy wants a yes and the program is not `confirmed`.
        """
        try:
            check_bounds(program, self._known, self._skills.values())
        except SkillFailed as error:
            turn.say(self._phrases().refusal(error.reason), Outcome.REFUSED)
            return False
        calls = calls_of(program)
        prepared = self._executor.prepare(
            calls, self._skills, turn, confirmed=confirmed, later=True
        )
        return bool(prepared) or not calls

    def check(self, kept: Kept) -> None:
        """Raise if the program is not allowed now."""
        check_bounds(kept.program, self._known, self._skills.values())
        for call in calls_of(kept.program):
            self._executor.check(
                call,
                self._skills,
                kept.way,
                kept.turn,
                mark=kept.mark,
                confirmed=kept.confirmed,
            )

    def step(self, kept: Kept, call: Call) -> Goal:
        """The goal of a step that begins now. Raises if the step is not allowed."""
        return self._executor.step(
            call, self._skills, kept.way, kept.turn, mark=kept.mark, confirmed=kept.confirmed
        )


class Programs:
    """The programs that wait and run. Every method may be called from any thread.

    A program that is due replaces the running motion, as any order does; a motion that replaces a
    running program ends it. `stop` ends all programs. Programs do not outlive the process: a robot
    must not begin to move by itself after a start.
    """

    def __init__(
        self,
        bus: Bus,
        executor: SkillExecutor,
        skills: SkillSet,
        *,
        announce: Callable[[str], None],
        phrases: Callable[[], Phrasebook],
        clock: Clock,
        timer: Timer | None = None,
        known: Known = NOTHING_KNOWN,
    ) -> None:
        """Store the collaborators and follow the executor.

        Args:
            bus: Carries `ProgramChanged`.
            executor: Checks and runs the steps.
            skills: The skills that steps may call.
            announce: Says a sentence that no turn asked for.
            phrases: Returns the sentences of the current language.
            clock: Measures waits and runs.
            timer: Wakes programs at their time; `Deadlines` by default.
            known: The body's battery and way back, for conditions and returns.
        """
        self._executor = executor
        self._permission = _Permission(executor, skills, known, phrases)
        self._skills = skills
        self._announce = announce
        self._phrases = phrases
        self._clock = clock
        self._timer = timer = timer or Deadlines("edgevox-programs", clock)
        self._known = known
        self._store = ProgramStore(bus, clock, timer, self.in_words)
        executor.follow(self)
        self._waits = Waits(self._store, timer, known, self._fire, self._missed)

    def start(self) -> None:
        self._timer.start()

    def close(self) -> None:
        """Forget all programs, and wait for the timer's thread."""
        self.stopped(self.stop(), because("shutting_down"))
        self._timer.close()

    @property
    def kept(self) -> Sequence[Kept]:
        """All programs that wait and run, in the order of their requests."""
        return self._store.all

    def in_words(self, program: Program) -> str:
        """The program described in the current language."""
        return in_words(program, self._phrases(), self._skills)

    def told(self, kept: Kept) -> str:
        """The rest of a program, described for a person."""
        return self._store.text(kept)

    def listed(self) -> Mapping[str, Any]:
        """The answer to the query `list_programs`."""
        found = [as_json(self._store.event(one)) for one in self.kept]
        return {"programs": [{key: one[key] for key in one if key != "kind"} for one in found]}

    def drives(self, program: Program) -> bool:
        """True if the program sets the body in motion."""
        return drives(program, self._skills)

    def may_keep(self, program: Program, turn: Turn, *, confirmed: bool = False) -> bool:
        """True if the program may be kept; if not, say why. Raises `NeedsConfirmation`."""
        return self._permission.is_given(program, turn, confirmed=confirmed)

    def keep(self, program: Program, turn: Turn, *, confirmed: bool = False) -> bool:
        """Keep a program that `may_keep` allowed, and say so; if motion is forbidden, say that."""
        kept = Kept(uuid.uuid4().hex, program, turn.number, turn.way, turn.mark, confirmed)
        try:
            self._permission.check(kept)
            if not self._store.put(kept, turn.token):
                return False
            self._begin(kept)
        except EdgeVoxError as error:
            self._store.take(kept)
            turn.say(self._phrases().refusal(reason_of(error)), Outcome.REFUSED)
            return False
        turn.acted()
        turn.say(self.in_words(program))
        return True

    def forget(self, some: Sequence[Kept], reason: Reason) -> None:
        """End these programs and their motion."""
        self.stopped([one for one in some if self._store.take(one)], reason)

    def motion_forbidden(self, reason: Reason) -> Tell:
        """Take all programs, so that none moves by itself when motion is allowed again.

        Returns a function that ends and reports them.
        """
        return partial(self._forbidden, self.stop(), reason)

    def forget_by_id(self, program_id: str, reason: Reason) -> None:
        """End one program, or all if the id is empty. Raises `InvalidValue` for an unknown id."""
        some = [one for one in self.kept if program_id in ("", one.id)]
        if program_id and not some:
            raise InvalidValue("program", program_id, "the id of one that waits or runs")
        self.forget(some, reason)

    def stop(self) -> Sequence[Kept]:
        """Take all programs, so that none begins to move, and return them; publishes nothing."""
        return [one for one in self.kept if self._store.take(one)]

    def stopped(self, ended: Sequence[Kept], reason: Reason) -> None:
        """End the motion of these taken programs, and publish their end."""
        for one in ended:  # cancel all before publishing any
            if one.goal is not None:
                one.goal.token.cancel(reason)
        for one in ended:
            self._store.tell(one, ProgramStatus.CANCELLED, reason)

    def goal_ended(self, goal: Goal) -> None:
        """Tell the waits that a moving goal has ended; its end was said."""
        self._waits.goal_ended(goal)

    def _forbidden(self, ended: Sequence[Kept], reason: Reason) -> None:
        waiting = [one for one in ended if one.goal is None]
        self.stopped(ended, reason)
        if waiting:
            orders = " ".join(map(self.told, waiting))
            self._announce(self._phrases().say("program_forgotten", orders=orders))

    def _begin(self, kept: Kept) -> None:
        """Wait for the program's time or condition; without one, run it."""
        match kept.program:
            case After(delay_s=delay_s):
                kept.due_s = self._clock.now() + delay_s
                self._store.later(kept, delay_s, partial(self._fire, kept))
                self._store.tell(kept)
            case When(condition=BatteryBelow() | StateIs()):
                self._store.later(kept, LONGEST_WAIT_S, partial(self._unmet, kept))
                self._store.tell(kept)
                self._waits.for_state()
            case When():
                moving = self._executor.moving
                if moving is None:
                    raise SkillFailed(because("nothing_moves"))
                self._store.tell(kept)
                self._waits.for_goal(kept, moving)
            case _:
                self._launch(kept)

    def _fire(self, kept: Kept) -> None:
        """Go on with the inner program after its time or condition came, if it is still allowed."""
        if not self._store.has(kept) or not isinstance(kept.program, After | When):
            return
        kept.program, kept.due_s = kept.program.program, None
        try:
            self._permission.check(kept)
            if isinstance(kept.program, After | When) or not moves(kept.program, self._skills):
                self._begin(kept)
            else:
                self._announce_start(kept)
        except EdgeVoxError as error:
            self._fail(kept, reason_of(error))

    def _announce_start(self, kept: Kept) -> None:
        """Warn people nearby that the robot is about to move, and set out `LEAD_S` later."""
        kept.due_s = self._clock.now() + LEAD_S
        order = continued(self.told(kept))
        self._announce(self._phrases().say("program_now", order=order))
        self._store.later(kept, LEAD_S, partial(self._set_out, kept))

    def _set_out(self, kept: Kept) -> None:
        try:
            self._launch(kept)
        except EdgeVoxError as error:
            self._fail(kept, reason_of(error))

    def _launch(self, kept: Kept) -> None:
        """Run the steps as one goal whose events stay here.

        Raises while motion is forbidden, or if the first step would end a motion for nothing.
        """
        for first in calls_of(kept.program)[:1]:
            self._executor.check_ready(first, self._skills)
        run = ProgramRun(
            kept.program,
            make=partial(self._permission.step, kept),
            announce=self._announce,
            phrases=self._phrases,
            way_back=self._known.way_back,
            clock=self._clock,
            on_round=partial(self._round, kept),
        )
        inside = Bus()
        inside.subscribe(GoalChanged, partial(self._changed, kept, run))
        inside.subscribe(GoalCancelled, partial(self._cancelled, kept, run))
        steps = run.as_skill(moves=moves(kept.program, self._skills))
        kept.goal = Goal(steps, {}, turn=kept.turn, bus=inside, goal_id=kept.id)
        kept.due_s = None
        self._store.later(kept, LONGEST_RUN_S, partial(self._too_long, kept))
        self._executor.launch(kept.goal, lambda: self._store.has(kept))

    def _round(self, kept: Kept, number: int) -> None:
        kept.round = number
        self._store.tell(kept)

    def _changed(self, kept: Kept, run: ProgramRun, event: GoalChanged) -> None:
        if event.status is GoalStatus.RUNNING and not isinstance(kept.program, Repeat):
            self._store.tell(kept)
        elif event.status is GoalStatus.SUCCEEDED:
            self._end(kept, ProgramStatus.DONE)
            if isinstance(kept.program, Repeat):
                self._announce(self._phrases().say("program_done"))
        elif event.status is GoalStatus.FAILED:  # the executor says why
            run.left(event.reason or NO_REASON)
            self._end(kept, ProgramStatus.FAILED, event.reason)

    def _cancelled(self, kept: Kept, run: ProgramRun, event: GoalCancelled) -> None:
        """Handle a cancelled run: another motion replaced it, unless it was ended here."""
        run.left(event.reason)
        if self._end(kept, ProgramStatus.CANCELLED, event.reason):
            self._announce(self._phrases().say("program_replaced"))

    def _too_long(self, kept: Kept) -> None:
        over = because("program_over", hours=f"{LONGEST_RUN_S / 3600:g}")
        self._fail(kept, over)
        if kept.goal is not None:
            kept.goal.token.cancel(over)

    def _unmet(self, kept: Kept) -> None:
        self._fail(kept, because("program_unmet", hours=f"{LONGEST_WAIT_S / 3600:g}"))

    def _missed(self, kept: Kept) -> None:
        """Cancel a program whose awaited motion did not reach its end."""
        told = self.told(kept)
        if self._end(kept, ProgramStatus.CANCELLED, because("program_missed")):
            self._announce(self._phrases().say("program_forgotten", orders=told))

    def _fail(self, kept: Kept, reason: Reason) -> None:
        if self._end(kept, ProgramStatus.FAILED, reason):
            self._announce(self._phrases().failure(reason))

    def _end(self, kept: Kept, status: ProgramStatus, reason: Reason | None = None) -> bool:
        """Take the program and publish its end; False if it had ended before."""
        taken = self._store.take(kept)
        if taken:
            self._store.tell(kept, status, reason)
        return taken
