"""Keeps programs: they wait without a thread of their own, are checked when they fire, and end."""

import uuid
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from typing import Any

from edgevox.agent.goals.goal import Goal
from edgevox.agent.nlu.orders import (
    After,
    BatteryBelow,
    Program,
    Repeat,
    When,
    drives,
    moves,
)
from edgevox.agent.phrases.phrasebook import Phrasebook
from edgevox.agent.programs.permission import Hands, Permission
from edgevox.agent.programs.run import ProgramRun, in_words
from edgevox.agent.programs.senses import NO_SENSES, Senses
from edgevox.agent.programs.store import (
    LONGEST_RUN_S,
    LONGEST_WAIT_S,
    Kept,
    ProgramStore,
    Timer,
    Waits,
)
from edgevox.agent.skills import SkillFailed, SkillSet, reason_of
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
"""A program that begins to move by itself says so this long before it does."""


class Programs:
    """The programs that wait and run. Every method may be called from any thread.

    One that is due takes the place of whatever moves, as any order does, and whatever takes the
    place of one that runs ends it. `stop` ends all of them. Nothing is kept beyond the process: a
    robot that begins to move by itself after a start is a surprise.
    """

    def __init__(
        self,
        bus: Bus,
        hands: Hands,
        skills: SkillSet,
        *,
        announce: Callable[[str], None],
        phrases: Callable[[], Phrasebook],
        clock: Clock,
        timer: Timer | None = None,
        senses: Senses = NO_SENSES,
    ) -> None:
        self._hands = hands
        self._permission = Permission(hands, skills, senses, phrases)
        self._skills = skills
        self._announce = announce
        self._phrases = phrases
        self._clock = clock
        self._timer = timer = timer or Deadlines("edgevox-programs", clock)
        self._senses = senses
        self._store = ProgramStore(bus, clock, timer, self.in_words)
        hands.follow(self)
        self._waits = Waits(self._store, timer, senses, self._fire, self._missed)

    def start(self) -> None:
        self._timer.start()

    def close(self) -> None:
        """Forget all of them, and wait for the timer's thread."""
        self.stopped(self.stop(), because("shutting_down"))
        self._timer.close()

    @property
    def kept(self) -> Sequence[Kept]:
        """Those that wait and run, in the order in which they were asked for."""
        return self._store.all

    def in_words(self, program: Program) -> str:
        """What a program does, in the language that is spoken."""
        return in_words(program, self._phrases(), self._skills)

    def told(self, kept: Kept) -> str:
        """What one will do from now on, as a person is told."""
        return self._store.text(kept)

    def listed(self) -> Mapping[str, Any]:
        """The answer to the query `list_programs`."""
        found = [as_json(self._store.event(one)) for one in self.kept]
        return {"programs": [{key: one[key] for key in one if key != "kind"} for one in found]}

    def drives(self, program: Program) -> bool:
        """Whether it sets the body in motion."""
        return drives(program, self._skills)

    def may_keep(self, program: Program, turn: Turn, *, confirmed: bool = False) -> bool:
        """Whether it may be kept; else why not is said. Raises `NeedsConfirmation`."""
        return self._permission.is_given(program, turn, confirmed=confirmed)

    def keep(self, program: Program, turn: Turn, *, confirmed: bool = False) -> bool:
        """Keep what `may_keep` allowed and say so; else why not is said, as motion is forbidden."""
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
        """End these, and what moves for them."""
        self.stopped([one for one in some if self._store.take(one)], reason)

    def motion_forbidden(self, reason: Reason) -> Tell:
        """Take all of them: none begins to move by itself when motion is allowed again.

        What this returns ends and tells of them.
        """
        return partial(self._forbidden, self.stop(), reason)

    def forget_by_id(self, program_id: str, reason: Reason) -> None:
        """End one, or all where the id is empty. Raises `InvalidValue` if there is no such one."""
        some = [one for one in self.kept if program_id in ("", one.id)]
        if program_id and not some:
            raise InvalidValue("program", program_id, "the id of one that waits or runs")
        self.forget(some, reason)

    def stop(self) -> Sequence[Kept]:
        """None of those that are kept may begin to move from now on; nobody is told yet."""
        return [one for one in self.kept if self._store.take(one)]

    def stopped(self, ended: Sequence[Kept], reason: Reason) -> None:
        """These were taken: end what moves for them, and say so on the bus."""
        for one in ended:  # all of them, before anybody is told of one
            if one.goal is not None:
                one.goal.token.cancel(reason)
        for one in ended:
            self._store.tell(one, ProgramStatus.CANCELLED, reason)

    def goal_ended(self, goal: Goal) -> None:
        """A goal that moved has ended, and its end was said."""
        self._waits.goal_ended(goal)

    def _forbidden(self, ended: Sequence[Kept], reason: Reason) -> None:
        waiting = [one for one in ended if one.goal is None]
        self.stopped(ended, reason)
        if waiting:
            orders = " ".join(map(self.told, waiting))
            self._announce(self._phrases().say("program_forgotten", orders=orders))

    def _begin(self, kept: Kept) -> None:
        """Let its time come, or what it waits for; else run it."""
        match kept.program:
            case After(delay_s=delay_s):
                kept.due_s = self._clock.now() + delay_s
                self._store.later(kept, delay_s, partial(self._fire, kept))
                self._store.tell(kept)
            case When(condition=BatteryBelow()):
                self._store.later(kept, LONGEST_WAIT_S, partial(self._unmet, kept))
                self._store.tell(kept)
                self._waits.for_battery()
            case When():
                moving = self._hands.moving
                if moving is None:
                    raise SkillFailed(because("nothing_moves"))
                self._store.tell(kept)
                self._waits.for_goal(kept, moving)
            case _:
                self._launch(kept)

    def _fire(self, kept: Kept) -> None:
        """What it waited for is so: go on with what is in it, if that may still be."""
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
        """Say that it is about to move, and let whoever is near hear it."""
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
        """Run its steps as one goal, whose events stay here. Raises while motion is forbidden."""
        run = ProgramRun(
            kept.program,
            make=partial(self._permission.step, kept),
            announce=self._announce,
            phrases=self._phrases,
            way_back=self._senses.way_back,
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
        self._hands.launch(kept.goal, lambda: self._store.has(kept))

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
        elif event.status is GoalStatus.FAILED:  # whoever runs goals says why
            run.left(event.reason or NO_REASON)
            self._end(kept, ProgramStatus.FAILED, event.reason)

    def _cancelled(self, kept: Kept, run: ProgramRun, event: GoalCancelled) -> None:
        """Something else moves instead, unless it was ended here."""
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
        """What moved did not come to its end, so what was to follow does not."""
        told = self.told(kept)
        if self._end(kept, ProgramStatus.CANCELLED, because("program_missed")):
            self._announce(self._phrases().say("program_forgotten", orders=told))

    def _fail(self, kept: Kept, reason: Reason) -> None:
        if self._end(kept, ProgramStatus.FAILED, reason):
            self._announce(self._phrases().failure(reason))

    def _end(self, kept: Kept, status: ProgramStatus, reason: Reason | None = None) -> bool:
        """Keep it no longer and tell of its end; False if it had ended before."""
        taken = self._store.take(kept)
        if taken:
            self._store.tell(kept, status, reason)
        return taken
