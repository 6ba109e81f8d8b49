"""Executes calls of skills: checked, acknowledged, run as goals, and reported when they end.

Runs goals beside the conversation: what moves, what waits in order, and what is answered.
"""

import json
import threading
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from typing import Any, Protocol

from edgevox.agent.goals.goal import Goal
from edgevox.agent.goals.lane import Lane, Plan
from edgevox.agent.phrases.load import ENGLISH, phrasebook
from edgevox.agent.phrases.phrasebook import Phrasebook, detail
from edgevox.agent.policy import CheckedCall, Denied, Guard, NeedsConfirmation
from edgevox.agent.skills import STOP, Call, Skill, SkillFailed, SkillSet, reason_of
from edgevox.agent.skills.failures import too_many_calls
from edgevox.agent.text.reasons import because
from edgevox.agent.turn import Turn
from edgevox.core.agent_events import GoalRejected, GoalStatus, ToolCalled
from edgevox.core.bus import Bus
from edgevox.core.errors import EdgeVoxError, InvalidValue, shorten
from edgevox.core.events import Outcome
from edgevox.core.motion.deadlines import Deadlines
from edgevox.core.motion.interlock import Interlock, Tell
from edgevox.core.reason import NO_REASON, Reason
from edgevox.core.ways import Way

MAX_BACKGROUND = 64
"""How many background goals may wait."""
ANSWER_S = 30.0
"""A skill that answers holds up what is said next, for so long at most."""


class GoalRunner:
    """Three lanes. What moves the body: the newest plan wins. Goals of programs that move nothing:
    in their order, each beside whatever moves or is said. What a turn asks: while it waits.

    `on_end` is called for every goal that moved, after its end was published.
    """

    def __init__(self, on_end: Callable[[Goal], None]) -> None:
        self._deadlines = Deadlines("edgevox-goals-deadlines")
        self._moving = Lane("moving", self._deadlines, on_end)
        self._background = Lane("background", self._deadlines)
        self._answering = Lane("answering", self._deadlines)
        self._lanes = (self._moving, self._background, self._answering)

    def start(self) -> None:
        self._deadlines.start()
        for lane in self._lanes:
            lane.start()

    def close(self) -> None:
        """Cancel everything and wait for the threads."""
        for lane in self._lanes:
            lane.close()
        self._deadlines.close()

    @property
    def busy(self) -> bool:
        """Whether any goal runs or waits."""
        return any(lane.busy for lane in self._lanes)

    @property
    def full(self) -> bool:
        """Whether one more background goal would be dropped."""
        return self._background.waiting >= MAX_BACKGROUND

    @property
    def moving(self) -> Goal | None:
        """The last of the goals that move or wait to."""
        return self._moving.last

    def wait_idle(self, timeout_s: float | None = None) -> bool:
        """Block until nothing runs or waits; False if something still did after the timeout."""
        return all(lane.wait_idle(timeout_s) for lane in self._lanes)

    def move(self, goals: Sequence[Goal]) -> None:
        """Run these instead of whatever moves or waits to."""
        self._moving.replace(Plan(goals))

    def run_in_background(self, goal: Goal) -> None:
        """Run this after those that wait, without pre-empting anything."""
        if self.full:
            goal.accept()
            goal.drop(because("goals_wait", skill=goal.skill.name, count=str(MAX_BACKGROUND)))
        else:
            self._background.append(Plan((goal,)))

    def answer(self, goal: Goal) -> None:
        """Run this and block until it has ended, within `ANSWER_S`."""
        self._answering.append(Plan((goal,), ANSWER_S))
        goal.wait()

    def cancel_motion(self, reason: Reason | str) -> bool:
        """End what moves or waits to; True if anything did. Does not wait for its end."""
        return self._moving.cancel(reason)

    def cancel(self, reason: Reason | str) -> bool:
        """End everything; True if anything ran or waited. Does not wait for its end."""
        ended = [lane.cancel(reason) for lane in self._lanes]
        return any(ended)


MAX_CALLS = 8
"""How many calls one utterance may hold."""


class Follower(Protocol):
    """Hears what becomes of goals, on the thread on which it happens."""

    def goal_ended(self, goal: Goal) -> None:
        """One that moved has ended, and that was said."""

    def motion_forbidden(self, reason: Reason) -> Tell:
        """Nothing may move from now on: let nothing begin to. What moves is about to be ended.

        What this returns tells of it, and is called once all that moved was ended.
        """


class SkillExecutor:
    """Runs calls: those that move beside the conversation, the others on the spot.

    `stop` and `perform` exclude each other, so no motion starts for a turn that was stopped.
    `phrases` gives the language to speak at the moment. While the `interlock` is engaged no motion
    starts, and what moved when it was engaged is cancelled, which is said. The `guard` is asked of
    each call that is valid, whatever it would do. Who does `follow` hears of ends and of what may
    not move any more; what `on_stop` is given does all that the skill `stop` stands for.
    """

    def __init__(
        self,
        bus: Bus,
        halt: Callable[[str], bool],
        announce: Callable[[str, str], None],
        phrases: Callable[[], Phrasebook] = lambda: phrasebook(ENGLISH),
        *,
        interlock: Interlock | None = None,
        guard: Guard | None = None,
    ) -> None:
        self._bus = bus
        self._halt = halt
        self._announce = announce
        self._phrases = phrases
        self._followers: tuple[Follower, ...] = ()
        self._stop_everything: Callable[[Turn | None], object] = lambda _: None
        self._gate = threading.Lock()
        self._runner = GoalRunner(on_end=self._ended)
        self._guard = guard or Guard(bus=bus)
        self._interlock = interlock or Interlock()
        self._interlock.on_engage(self._stand)

    def follow(self, follower: Follower) -> None:
        """Tell it from now on; to be called before the start."""
        self._followers = (*self._followers, follower)

    def on_stop(self, stop: Callable[[Turn | None], object]) -> None:
        """Call it before the skill `stop` runs, with the turn if it was asked for in words."""
        self._stop_everything = stop

    def start(self) -> None:
        self._runner.start()

    def close(self) -> None:
        self._runner.close()

    @property
    def busy(self) -> bool:
        return self._runner.busy

    def wait_idle(self, timeout_s: float | None = None) -> bool:
        return self._runner.wait_idle(timeout_s)

    def stop(self, reason: Reason | str, turn: Turn | None) -> bool:
        """Cancel the turn, its goals, and all motion of the body. True if there was any of it."""
        try:
            with self._gate:
                cut = turn is not None and turn.token.cancel(reason)
                ran = self._runner.cancel(reason)
        finally:  # whatever breaks, the body is halted
            moved = self._halt(str(reason))
        return cut or ran or moved

    def hush(self, reason: str, turn: Turn) -> bool:
        """Cancel the turn, and leave what moves. True if it was not cancelled yet."""
        with self._gate:
            return turn.token.cancel(reason)

    def withdraw(self, reason: Reason, turn: Turn) -> bool:
        """Cancel the turn, and what moves for it; not what others began. True if it did."""
        with self._gate:
            cut = turn.token.cancel(reason)
            moving = self._runner.moving
            ran = moving is not None and moving.turn == turn.number
            ended = ran and self._runner.cancel_motion(reason)
        return cut or ended

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
        """The arguments, checked. Raises where `begin` would; the policy tells what it refuses.

        `mark` is the interlock's when it was asked for, now by default. `confirmed`: somebody has
        said yes to it, in this `turn`.
        """
        skill = skills[call.skill]
        arguments = skill.validate(call.arguments)
        asked = _asked(skill, arguments)
        self._guard.permit(way, [asked], turn, confirmed=confirmed)
        if held := self._held([skill], self._interlock.mark if mark is None else mark):
            raise SkillFailed(held)
        if not skill.moves and self._runner.full:
            raise SkillFailed(because("goals_wait", skill=call.skill, count=str(MAX_BACKGROUND)))
        return arguments

    def begin(self, call: Call, skills: SkillSet, goal_id: str | None, way: Way, mark: int) -> Goal:
        """Run one call without a turn, and so without a word said about it.

        One that moves pre-empts what moves; another waits for nothing but its like. `mark` is the
        interlock's when it was asked for.
        """
        try:
            arguments = self.check(call, skills, way, mark=mark)
        except EdgeVoxError as error:
            if not isinstance(error, Denied) or way is Way.ACTION:  # else the policy has told
                self._reject(call, reason_of(error), way)
            raise
        goal = self._goal(skills[call.skill], arguments, 0, way, goal_id=goal_id)
        self._tell(goal, "action")
        self._stopping([goal])
        with self._gate:
            if held := self._held([goal.skill], mark):
                goal.drop(held)
            elif goal.skill.moves:
                self._runner.move([goal])
            else:
                self._runner.run_in_background(goal)
        return goal

    def launch(self, goal: Goal, may: Callable[[], bool]) -> bool:
        """Run a goal that was prepared, as `begin` would; False if it `may` not, since it was
        stopped meanwhile. Raises `SkillFailed` while motion is forbidden.
        """
        with self._gate:
            if not may():
                return False
            if held := self._held([goal.skill], self._interlock.mark):
                raise SkillFailed(held)
            if goal.skill.moves:
                self._runner.move([goal])
            else:
                self._runner.run_in_background(goal)
        return True

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
        """A goal for a step of a program, checked now; who runs the program runs it."""
        arguments = self.check(call, skills, way, turn, mark=mark, confirmed=confirmed)
        goal = self._goal(skills[call.skill], arguments, turn, way, confirmed=confirmed)
        self._tell(goal, "program")
        self._stopping([goal])
        return goal

    @property
    def moving(self) -> Goal | None:
        """The last of the goals that move or wait to."""
        return self._runner.moving

    def perform(self, calls: Sequence[Call], skills: SkillSet, turn: Turn, source: str) -> None:
        """Check all calls, then acknowledge and run them in order; if one is wrong, none runs.

        What the policy wants a yes for is refused: nobody is asked here.
        """
        try:
            goals = self.prepare(calls, skills, turn)
        except NeedsConfirmation as unsure:
            self._guard.refuse(unsure, turn.number)
            turn.say(self._phrases().refusal(unsure.reason), Outcome.REFUSED)
            return
        if goals:
            self.run(goals, turn, source)

    def prepare(
        self, calls: Sequence[Call], skills: SkillSet, turn: Turn, *, confirmed: bool = False
    ) -> Sequence[Goal]:
        """The checked calls, for `run`; none if one is wrong or forbidden, which is said.

        Raises `NeedsConfirmation` if the policy wants a yes and nobody has `confirmed` them.
        """
        try:
            goals = self._goals(calls, skills, turn, confirmed=confirmed)
            asked = [_asked(one.skill, one.arguments) for one in goals]
            self._guard.check(turn.way, asked, turn.number, confirmed=confirmed)
        except NeedsConfirmation:
            raise
        except Denied as denied:
            turn.say(self._phrases().refusal(denied.reason), Outcome.REFUSED)
        except InvalidValue as error:
            why, phrases = reason_of(error), self._phrases()
            turn.say(phrases.refusal(why), Outcome.REFUSED, detail=detail(phrases, why))
        except SkillFailed as error:
            why, phrases = error.reason, self._phrases()
            turn.say(phrases.failure(why), Outcome.REFUSED, detail=detail(phrases, why))
        else:
            if not (held := self._held([goal.skill for goal in goals], turn.mark)):
                return goals
            self._refuse(goals, held, turn)
        return ()

    def run(self, goals: Sequence[Goal], turn: Turn, source: str) -> bool:
        """Acknowledge and run them in order; False if nothing may move, which is said."""
        if held := self._held([goal.skill for goal in goals], turn.mark):
            self._refuse(goals, held, turn)
            return False
        turn.acted()
        for goal in goals:
            self._tell(goal, source)
        self._stopping(goals, turn)
        if any(goal.skill.moves for goal in goals):
            return self._run_beside(goals, turn)
        self._run_now(goals, turn)
        return True

    def _goals(
        self, calls: Sequence[Call], skills: SkillSet, turn: Turn, *, confirmed: bool
    ) -> list[Goal]:
        if len(calls) > MAX_CALLS:
            raise too_many_calls(len(calls), MAX_CALLS)
        goals = []
        for call in calls:
            try:
                skill = skills[call.skill]
                arguments = skill.validate(call.arguments)
            except EdgeVoxError as error:
                self._reject(call, reason_of(error), turn.way, turn.number)
                raise
            goal = self._goal(skill, arguments, turn.number, turn.way, confirmed=confirmed)
            goals.append(goal)
        return goals

    def _goal(
        self,
        skill: Skill,
        arguments: Mapping[str, Any],
        turn: int,
        way: Way,
        *,
        confirmed: bool = False,
        goal_id: str | None = None,
    ) -> Goal:
        """A goal that is judged again when it begins: it may have waited."""
        leave = self._guard.leave(way, _asked(skill, arguments), confirmed=confirmed)
        return Goal(skill, arguments, turn=turn, bus=self._bus, goal_id=goal_id, leave=leave)

    def _run_beside(self, goals: Sequence[Goal], turn: Turn) -> bool:
        """Say what is going to be done, and begin: planning a way first would hold the words up."""
        moving = [goal for goal in goals if goal.skill.moves]
        phrases, skills = self._phrases(), [goal.skill for goal in goals]
        if not turn.token.cancelled and not self._held(skills, turn.mark):
            said = [phrases.acknowledge(goal.skill, goal.arguments) for goal in moving]
            turn.say(phrases.chained(said))
        with self._gate:
            if turn.token.cancelled:
                return False
            held = self._held(skills, turn.mark)
            if not held:
                self._runner.move(goals)
        if held:  # since they were told of, just now
            for goal in goals:
                goal.drop(held)
            turn.say(phrases.refusal(held), Outcome.REFUSED)
        return not held

    def _refuse(self, goals: Sequence[Goal], reason: Reason, turn: Turn) -> None:
        """Say why none of them is done, and tell of each that it is not."""
        for goal in goals:
            self._reject(Call(goal.skill.name, goal.arguments), reason, turn.way, turn.number)
        turn.say(self._phrases().refusal(reason), Outcome.REFUSED)

    def _reject(self, call: Call, reason: Reason, way: Way, turn: int = 0) -> None:
        arguments = shorten(json.dumps(dict(call.arguments), default=str))
        self._bus.publish(GoalRejected(call.skill[:80], arguments, reason, str(way), turn))

    def _run_now(self, goals: Sequence[Goal], turn: Turn) -> None:
        for goal in goals:
            forget = turn.token.on_cancel(partial(_follow, goal, turn))
            self._runner.answer(goal)
            forget()
            phrases = self._phrases()
            turn.say(_report(phrases, goal), detail=detail(phrases, goal.reason))

    def _held(self, skills: Sequence[Skill], mark: int) -> Reason:
        """Why these, asked for at this mark, may not run; none if they may. A stop always may."""
        if any(skill.drives for skill in skills):
            return self._interlock.refusal(mark)
        if all(skill.name == STOP for skill in skills):
            return NO_REASON
        return self._interlock.outdated(mark)

    def _stand(self, reason: Reason) -> Tell:
        """End what moves; what this returns says why. Motion that begins after this is refused."""
        tell_those = [follower.motion_forbidden(reason) for follower in self._followers]
        with self._gate:
            ended = self._runner.cancel_motion(reason)

        def tell() -> None:
            for tell_one in tell_those:
                tell_one()
            if ended:
                phrases = self._phrases()
                self._announce(phrases.failure(reason), detail(phrases, reason))

        return tell

    def _stopping(self, goals: Sequence[Goal], turn: Turn | None = None) -> None:
        if any(goal.skill.name == STOP for goal in goals):
            self._stop_everything(turn)

    def _tell(self, goal: Goal, source: str) -> None:
        self._bus.publish(ToolCalled(goal.skill.name, goal.arguments, source, goal.turn))

    def _ended(self, goal: Goal) -> None:
        phrases = self._phrases()
        text = _report(phrases, goal) if goal.turn else ""
        if text:
            self._announce(text, detail(phrases, goal.reason))
        for follower in self._followers:
            follower.goal_ended(goal)


def _follow(goal: Goal, turn: Turn) -> None:
    goal.token.cancel(turn.token.why)


def _report(phrases: Phrasebook, goal: Goal) -> str:
    """What to say of a goal's end; nothing for one that somebody cancelled."""
    if goal.status is GoalStatus.SUCCEEDED:
        return phrases.report(goal.skill, goal.arguments, goal.result)
    if goal.status is GoalStatus.FAILED:
        return phrases.failure(goal.reason)
    return ""


def _asked(skill: Skill, arguments: Mapping[str, Any]) -> CheckedCall:
    """As the policy judges it."""
    return CheckedCall(
        skill.name, arguments, skill.drives, skill.confirm, towards_rad=skill.towards_rad
    )
