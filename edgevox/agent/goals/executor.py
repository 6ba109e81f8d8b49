"""The executor of skill calls: checks, acknowledges, runs as goals, and reports their ends."""

import json
import threading
from collections.abc import Callable, Mapping, Sequence
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
from edgevox.core.cancel import Cancelled, CancelToken
from edgevox.core.commands import Way
from edgevox.core.errors import EdgeVoxError, InvalidValue, shorten
from edgevox.core.events import Outcome
from edgevox.core.motion.deadlines import Deadlines
from edgevox.core.motion.interlock import Interlock, Tell
from edgevox.core.reason import NO_REASON, Reason

MAX_BACKGROUND = 64
"""Number of background goals that may wait."""
ANSWER_S = 30.0
"""Longest time in seconds for a skill that answers: the conversation waits for it."""
MAX_CALLS = 8
"""Number of calls that one utterance may hold."""
READY_S = 3.0
"""Longest time in seconds to find out whether a skill can begin, before anything is said."""


class Follower(Protocol):
    """Gets told about goals, on the thread on which it happens."""

    def goal_ended(self, goal: Goal) -> None:
        """Called after a moving goal has ended and its end was said."""

    def motion_forbidden(self, reason: Reason) -> Tell:
        """Called when motion becomes forbidden: begin no new motion. Running motion ends next.

        Returns a function that reports; it is called after all motion has ended.
        """


class SkillExecutor:
    """Runs skill calls: moving skills beside the conversation, the others while the turn waits.

    Goals run in three lanes: those that move the body, of which the newest plan replaces all
    others; those in the background, which move nothing and which no turn asked for, one after
    another; and those that a turn waits for.

    `stop` and `perform` exclude each other, so no motion starts for a turn that was stopped.
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
        """Store the collaborators and listen to the interlock.

        Args:
            bus: Carries the events of calls and goals.
            halt: Brakes the body and tells it why; returns whether it moved.
            announce: Says a sentence that no turn asked for, and writes a detail beside it.
            phrases: Returns the sentences of the current language.
            interlock: Starts no motion and cancels the running one while it is engaged.
            guard: Judges every valid call by the policy.
        """
        self._bus = bus
        self._halt = halt
        self._announce = announce
        self._phrases = phrases
        self._followers: tuple[Follower, ...] = ()
        self._stop_everything: Callable[[Turn | None], object] = lambda _: None
        self._gate = threading.Lock()
        self._deadlines = Deadlines("edgevox-goals-deadlines")
        self._moving = Lane("moving", self._deadlines, self._ended)
        self._background = Lane("background", self._deadlines)
        self._answering = Lane("answering", self._deadlines)
        self._lanes = (self._moving, self._background, self._answering)
        self._guard = guard or Guard(bus=bus)
        self._interlock = interlock or Interlock()
        self._interlock.on_engage(self._stand)

    def follow(self, follower: Follower) -> None:
        """Add a follower; call this before `start`."""
        self._followers = (*self._followers, follower)

    def on_stop(self, stop: Callable[[Turn | None], object]) -> None:
        """Set the function that runs before the skill `stop`; it gets the turn, if words asked."""
        self._stop_everything = stop

    def start(self) -> None:
        self._deadlines.start()
        for lane in self._lanes:
            lane.start()

    def close(self) -> None:
        """Cancel all goals and wait for the threads."""
        for lane in self._lanes:
            lane.close()
        self._deadlines.close()

    @property
    def busy(self) -> bool:
        """True if any goal runs or waits."""
        return any(lane.busy for lane in self._lanes)

    @property
    def moving(self) -> Goal | None:
        """The last of the goals that move or wait to."""
        return self._moving.last

    def wait_idle(self, timeout_s: float | None = None) -> bool:
        """Block until no goal runs or waits; False after the timeout."""
        return all(lane.wait_idle(timeout_s) for lane in self._lanes)

    def stop(self, reason: Reason | str, turn: Turn | None) -> bool:
        """Cancel the turn, all goals and all motion of the body; True if there was any."""
        try:
            with self._gate:
                cut = turn is not None and turn.token.cancel(reason)
                ran = [lane.cancel(reason) for lane in self._lanes]
        finally:  # halt the body even if the lines above raise
            moved = self._halt(str(reason))
        return cut or any(ran) or moved

    def hush(self, reason: str, turn: Turn) -> bool:
        """Cancel the turn but not the motion; True if the turn was not cancelled before."""
        with self._gate:
            return turn.token.cancel(reason)

    def withdraw(self, reason: Reason, turn: Turn) -> bool:
        """Cancel the turn and the motion that it began, no other motion; True if there was any."""
        with self._gate:
            cut = turn.token.cancel(reason)
            moving = self.moving
            began = moving is not None and moving.turn == turn.number
            return (began and self._moving.cancel(reason)) or cut

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
        """Check the call and return its checked arguments; raise what `begin` would raise.

        The guard reports what the policy refuses. `mark` is the interlock's mark when the call was
        asked for, now by default. `confirmed` is True if a person said yes to the call.
        """
        skill = skills[call.skill]
        arguments = skill.validate(call.arguments)
        asked = _asked(skill, arguments)
        self._guard.permit(way, [asked], turn, confirmed=confirmed)
        if held := self._held([skill], self._interlock.mark if mark is None else mark):
            raise SkillFailed(held)
        if not skill.moves and self._full:
            raise SkillFailed(_too_many_wait(skill))
        return arguments

    def check_begin(
        self, call: Call, skills: SkillSet, way: Way, mark: int | None = None
    ) -> Mapping[str, Any]:
        """Check the call as `check` does, and that it does not end a motion for nothing."""
        arguments = self.check(call, skills, way, mark=mark)
        self._check_ready(skills[call.skill], arguments)
        return arguments

    def check_ready(self, call: Call, skills: SkillSet) -> None:
        """Raise `SkillFailed` if this call would end the running motion for nothing.

        Never blocks: what is not known now refuses, unless nothing moves.
        """
        skill = skills[call.skill]
        self._check_ready(skill, skill.validate(call.arguments))

    def _check_ready(self, skill: Skill, arguments: Mapping[str, Any]) -> None:
        if self.moving is not None:
            self._look_ahead([(skill, arguments)], CancelToken(), 0.0)

    def _look_ahead(
        self, calls: Sequence[tuple[Skill, Mapping[str, Any]]], token: CancelToken, most_s: float
    ) -> None:
        """Raise if the first of these cannot begin now; they may change what later ones need.

        The first that moves counts as well if it would end another motion.
        """
        mover = next((one for one in calls if one[0].moves), None)
        if mover is None:
            return
        looked = [calls[0]]
        if mover is not calls[0] and self.moving is not None:
            looked.append(mover)
        for skill, arguments in looked:
            if skill.ready:
                skill.ready(token, most_s, **arguments)

    def begin(self, call: Call, skills: SkillSet, goal_id: str | None, way: Way, mark: int) -> Goal:
        """Run one call without a turn, and so without saying anything about it.

        A call that moves pre-empts the running motion; any other call only waits for its lane.
        `mark` is the interlock's mark when the call was asked for.
        """
        try:
            arguments = self.check_begin(call, skills, way, mark)
        except EdgeVoxError as error:
            if not isinstance(error, Denied) or way is Way.ACTION:  # else the guard reported
                self._reject(call, reason_of(error), way)
            raise
        goal = self._goal(skills[call.skill], arguments, 0, way, goal_id=goal_id)
        self._tell(goal, "action")
        self._stopping([goal])
        with self._gate:
            if held := self._held([goal.skill], mark):
                goal.drop(held)
            else:
                self._put(goal)
        return goal

    def launch(self, goal: Goal, may: Callable[[], bool]) -> bool:
        """Run a prepared goal, as `begin` would; False if `may` says no, after a stop.

        Raises `SkillFailed` while motion is forbidden.
        """
        with self._gate:
            if not may():
                return False
            if held := self._held([goal.skill], self._interlock.mark):
                raise SkillFailed(held)
            self._put(goal)
        return True

    def _put(self, goal: Goal) -> None:
        """Run the goal: in place of all that move, or after all in the background."""
        if goal.skill.moves:
            self._move([goal])
        elif self._full:
            goal.accept()
            goal.drop(_too_many_wait(goal.skill))
        else:
            self._background.append(Plan((goal,)))

    def _move(self, goals: Sequence[Goal]) -> None:
        goals[0].replaces = self.moving
        self._moving.replace(Plan(goals))

    @property
    def _full(self) -> bool:
        """True if one more background goal would be dropped."""
        return self._background.waiting >= MAX_BACKGROUND

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
        """Check a step of a program now and return its goal, for the program to run."""
        arguments = self.check(call, skills, way, turn, mark=mark, confirmed=confirmed)
        goal = self._goal(skills[call.skill], arguments, turn, way, confirmed=confirmed)
        self._tell(goal, "program")
        self._stopping([goal])
        return goal

    def perform(self, calls: Sequence[Call], skills: SkillSet, turn: Turn, source: str) -> None:
        """Check all calls, then acknowledge and run them in order; if one is wrong, none runs.

        A call that needs a yes by the policy is refused, because this method cannot ask.
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
        self,
        calls: Sequence[Call],
        skills: SkillSet,
        turn: Turn,
        *,
        confirmed: bool = False,
        later: bool = False,
    ) -> Sequence[Goal]:
        """Check the calls and return their goals for `run`.

        If a call is wrong, forbidden or, unless it is for `later`, cannot begin now, the turn says
        so, and no goals are returned: what moves the robot goes on. Raises `NeedsConfirmation` if
        the policy wants a yes and the calls are not `confirmed`.
        """
        try:
            goals = self._goals(calls, skills, turn, confirmed=confirmed)
            asked = [_asked(one.skill, one.arguments) for one in goals]
            self._guard.check(turn.way, asked, turn.number, confirmed=confirmed)
        except NeedsConfirmation:
            raise
        except Denied as denied:
            turn.say(self._phrases().refusal(denied.reason), Outcome.REFUSED)
        except (InvalidValue, SkillFailed) as error:
            self._say_why_not(error, turn)
        else:
            if held := self._held([goal.skill for goal in goals], turn.mark):
                self._refuse(goals, held, turn)
            elif later or self._ready(goals, turn):
                return goals
        return ()

    def _ready(self, goals: Sequence[Goal], turn: Turn) -> bool:
        """True if these goals can begin now; if not, say why."""
        calls = [(goal.skill, goal.arguments) for goal in goals]
        try:
            self._look_ahead(calls, turn.token, READY_S)
        except Cancelled:
            return False
        except SkillFailed as error:
            self._reject_all(goals, error.reason, turn)
            self._say_why_not(error, turn)
            return False
        return True

    def _say_why_not(self, error: InvalidValue | SkillFailed, turn: Turn) -> None:
        why, phrases = reason_of(error), self._phrases()
        say = phrases.failure if isinstance(error, SkillFailed) else phrases.refusal
        turn.say(say(why), Outcome.REFUSED, detail=detail(phrases, why))

    def run(self, goals: Sequence[Goal], turn: Turn, source: str) -> bool:
        """Acknowledge the goals and run them in order; if motion is forbidden, say so: False."""
        if held := self._held([goal.skill for goal in goals], turn.mark):
            self._refuse(goals, held, turn)
            return False
        turn.acted()
        for goal in goals:
            self._tell(goal, source)
        self._stopping(goals, turn)
        if any(goal.skill.moves for goal in goals):
            return self._run_beside(goals, turn)
        for goal in goals:
            self._answer(goal, turn)
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
        """A goal that the policy judges again when it begins, since it may have waited."""
        leave = self._guard.leave(way, _asked(skill, arguments), confirmed=confirmed)
        return Goal(skill, arguments, turn=turn, bus=self._bus, goal_id=goal_id, leave=leave)

    def _run_beside(self, goals: Sequence[Goal], turn: Turn) -> bool:
        """Say what the robot will do, then begin: planning a way first would delay the words."""
        moving = [goal for goal in goals if goal.skill.moves]
        phrases, skills = self._phrases(), [goal.skill for goal in goals]
        if not turn.token.cancelled and not self._held(skills, turn.mark):
            said = [phrases.acknowledge(goal.skill, goal.arguments) for goal in moving]
            if any(said) or not all(goal.skill.brief for goal in moving):
                turn.say(phrases.chained(said))
        with self._gate:
            if turn.token.cancelled:
                return False
            held = self._held(skills, turn.mark)
            if not held:
                self._move(goals)
        if held:  # motion became forbidden after the acknowledgement
            for goal in goals:
                goal.drop(held)
            turn.say(phrases.refusal(held), Outcome.REFUSED)
        return not held

    def _refuse(self, goals: Sequence[Goal], reason: Reason, turn: Turn) -> None:
        """Say why no goal runs, and publish a rejection for each."""
        self._reject_all(goals, reason, turn)
        turn.say(self._phrases().refusal(reason), Outcome.REFUSED)

    def _reject_all(self, goals: Sequence[Goal], reason: Reason, turn: Turn) -> None:
        for goal in goals:
            self._reject(Call(goal.skill.name, goal.arguments), reason, turn.way, turn.number)

    def _reject(self, call: Call, reason: Reason, way: Way, turn: int = 0) -> None:
        arguments = shorten(json.dumps(dict(call.arguments), default=str))
        self._bus.publish(GoalRejected(call.skill[:80], arguments, reason, str(way), turn))

    def _answer(self, goal: Goal, turn: Turn) -> None:
        """Run the goal, wait for its end, and say it."""
        forget = turn.token.on_cancel(lambda: goal.token.cancel(turn.token.why))
        self._answering.append(Plan((goal,), ANSWER_S))
        goal.wait()
        forget()
        phrases = self._phrases()
        turn.say(_report(phrases, goal), detail=detail(phrases, goal.reason))

    def _held(self, skills: Sequence[Skill], mark: int) -> Reason:
        """The reason why these skills may not run at this mark; empty if they may.

        The skill `stop` always may.
        """
        if any(skill.drives for skill in skills):
            return self._interlock.refusal(mark)
        if all(skill.name == STOP for skill in skills):
            return NO_REASON
        return self._interlock.outdated(mark)

    def _stand(self, reason: Reason) -> Tell:
        """End all motion and return a function that says why; later motion is refused."""
        tell_those = [follower.motion_forbidden(reason) for follower in self._followers]
        with self._gate:
            ended = self._moving.cancel(reason)

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
        if text and goal.status is GoalStatus.FAILED and goal.ended_another:
            text = f"{text} {phrases.say('stopped')}"
        goal.replaces = None  # else each goal would keep the one before it
        if text:
            self._announce(text, detail(phrases, goal.reason))
        for follower in self._followers:
            follower.goal_ended(goal)


def _too_many_wait(skill: Skill) -> Reason:
    return because("goals_wait", skill=skill.name, count=str(MAX_BACKGROUND))


def _report(phrases: Phrasebook, goal: Goal) -> str:
    """The sentence about a goal's end; empty for a cancelled goal."""
    if goal.status is GoalStatus.SUCCEEDED:
        return phrases.report(goal.skill, goal.arguments, goal.result)
    if goal.status is GoalStatus.FAILED:
        return phrases.failure(goal.reason)
    return ""


def _asked(skill: Skill, arguments: Mapping[str, Any]) -> CheckedCall:
    """The call in the form that the policy judges."""
    return CheckedCall(
        skill.name, arguments, skill.drives, skill.confirm, towards_rad=skill.towards_rad
    )
