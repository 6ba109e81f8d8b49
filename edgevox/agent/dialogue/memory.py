"""The memory of the dialogue: the last exchanges, motions, and the drive to correct.

`Dialogue` holds what was heard, understood, called and reached; `LastDrive` holds the drive that
"no, the bedroom" corrects.
"""

import threading
from collections import deque
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from edgevox.agent.agents import Agent
from edgevox.agent.nlu.meaning import Program, calls_of
from edgevox.agent.skills import STOP, Call, Skill, SkillFailed
from edgevox.core.agent_events import (
    GOAL_ENDS,
    Confirmation,
    ConfirmationStatus,
    GoalCancelled,
    GoalChanged,
    GoalStatus,
    SafetyPreempted,
    ToolCalled,
)
from edgevox.core.bus import Bus
from edgevox.core.clock import Clock
from edgevox.core.events import Cause, Interrupted, Transcribed
from edgevox.core.files.validation import is_number
from edgevox.core.transforms import Pose2D, distance_on_floor

CORRECTED_S = 20.0
"""Seconds after its end for which a drive can still be corrected."""


@dataclass(frozen=True, slots=True)
class DriveCall:
    """A call that set the body in motion."""

    agent: Agent
    """The agent whose skill was called."""
    call: Call
    """The call."""
    turn: int
    """Number of the turn that called."""


class LastDrive:
    """Remembers the last drive that words asked for.

    One thread sets and reads it; the bus reports its end on any thread.
    """

    def __init__(self, bus: Bus, clock: Clock) -> None:
        self._clock = clock
        self._drive: DriveCall | None = None
        self._ends_s: dict[int, float] = {}
        bus.subscribe(GoalChanged, self._on_goal)
        bus.subscribe(GoalCancelled, self._on_goal)

    @property
    def corrigible(self) -> DriveCall | None:
        """The drive, if it may still be corrected."""
        drive = self._drive
        if drive is None:
            return None
        ended_s = self._ends_s.get(drive.turn)
        late = ended_s is not None and self._clock.now() - ended_s > CORRECTED_S
        return None if late else drive

    def begin(self, drive: DriveCall) -> None:
        """Remember this drive; call this before it begins, so that its end is not missed."""
        self._drive, self._ends_s = drive, {}

    def forget(self) -> None:
        """Forget the drive."""
        self._drive = None

    def _on_goal(self, event: GoalChanged | GoalCancelled) -> None:
        drive = self._drive
        mine = drive and (event.turn, event.skill) == (drive.turn, drive.call.skill)
        if mine and event.status in GOAL_ENDS:
            self._ends_s[event.turn] = self._clock.now()


MOST_EXCHANGES = 8
"""Number of exchanges and number of motions that are remembered."""
REMEMBERED_S = 600.0
"""Seconds for which exchanges and motions are remembered: later, nobody asks about them or wants
to go back to where they began."""
_ELSEWHERE_M = 0.15
"""Least distance in metres for another position: a drive ends this near to its goal."""
REPEATABLE_S = 60.0
"""Seconds after its end for which "again" can mean an action: later, another person may speak."""

PROGRAM = "program"
"""The `source` of calls that are steps of a program."""

_HUSHED = (Cause.BARGE_IN, Cause.WAKE_WORD)
"""Causes that only cut the speech and stop nothing."""


@dataclass(slots=True)
class DialogueExchange:
    """One utterance or command, and its effects."""

    turn: int
    """Number of the turn; 0 for none."""
    words: str
    """The words; empty for a command."""
    last_s: float
    """The clock's time of the last event that belongs to it."""
    meant: str = ""
    """For a yes: the words that it said yes to."""
    source: str = ""
    """The stage that understood the words; empty if none did."""
    confidence: float = 1.0
    """Confidence of that stage, from 0 to 1."""
    calls: list[Call] = field(default_factory=list)
    """The calls that were made at once."""
    program: Program | None = None
    """The program that was kept for later; its calls are not in `calls`."""
    about_dialogue: bool = False
    """True for a question about the conversation, which the next such question leaves out."""
    stopped: bool = False
    """True if it was stopped, or stopped others."""

    @property
    def acted(self) -> bool:
        """True if words led to a call or a program."""
        return bool(self.words and (self.calls or self.program))


@dataclass(slots=True)
class MotionRecord:
    """A goal that sets the body in motion."""

    goal_id: str
    """The goal's id."""
    skill: str
    """The name of its skill."""
    arguments: Mapping[str, Any]
    """The skill's arguments."""
    turn: int
    """Number of the turn that asked for it; 0 for none."""
    last_s: float
    """The clock's time of the goal's last event."""
    status: GoalStatus
    """The goal's last status."""
    began: bool = False
    """True once the goal ran."""
    start: Pose2D | None = None
    """The body's pose when the goal began; None if the body does not know it."""
    progress: float | None = None
    """The last reported progress, from 0 to 1."""
    began_s: float | None = None
    """The clock's time when the goal began to run."""
    told: str = ""
    """What the skill last told of it in words."""


MOST_TOLD = 200
"""Characters of what a skill tells of its motion that are kept."""


class Dialogue:
    """Remembers what the bus reports. Any thread may ask; the memory is bounded.

    `skills` are all skills of the robot, and `pose` returns the body's pose. Of calls of
    `dialogue_skills` only what they name is remembered, because they only ask about other calls.
    """

    def __init__(
        self,
        bus: Bus,
        clock: Clock,
        skills: Mapping[str, Skill],
        *,
        dialogue_skills: Collection[str] = (),
        pose: Callable[[], Pose2D] | None = None,
    ) -> None:
        self._clock = clock
        self._skills = skills
        self._dialogue_skills = dialogue_skills
        self._pose = pose
        self._lock = threading.Lock()
        self._exchanges: deque[DialogueExchange] = deque(maxlen=MOST_EXCHANGES)
        self._motions: deque[MotionRecord] = deque(maxlen=MOST_EXCHANGES)
        self._named: deque[tuple[float, Call]] = deque(maxlen=MOST_EXCHANGES)
        bus.subscribe(Transcribed, self._on_words)
        bus.subscribe(ToolCalled, self._on_call)
        bus.subscribe(Confirmation, self._on_question)
        bus.subscribe(GoalChanged | GoalCancelled, self._on_goal)
        bus.subscribe(SafetyPreempted, lambda _: self._on_stop())
        bus.subscribe(Interrupted, self._on_interrupt)

    def decided(self, turn: int, source: str, confidence: float, *, about_dialogue: bool) -> None:
        """Record the stage that understood the words of this turn, and its confidence."""
        with self._lock:
            one = self._of(turn)
            one.source, one.confidence, one.about_dialogue = source, confidence, about_dialogue

    def confirmed(self, turn: int, asked: int) -> None:
        """Record that this turn said yes to the words of the turn `asked`."""
        with self._lock:
            said = next((one for one in self._exchanges if one.turn == asked), None)
            if said:
                yes = self._of(turn)
                yes.meant = said.meant or said.words
                yes.source, yes.confidence = said.source, said.confidence

    def kept(self, turn: int, program: Program) -> None:
        """Record the program that this turn asked for."""
        with self._lock:
            self._of(turn).program = program
            self._name(calls_of(program))

    def heard(self) -> DialogueExchange | None:
        """The last exchange with words, without questions about the conversation."""
        return self._last(lambda one: bool(one.words) and not one.about_dialogue)

    def asked(
        self, fits: Callable[[DialogueExchange], bool] = lambda _: True
    ) -> DialogueExchange | None:
        """The last exchange whose words led to a call or a program and that `fits`."""
        return self._last(lambda one: one.acted and not one.about_dialogue and fits(one))

    def repeatable(self, exchange: DialogueExchange) -> bool:
        """True if the exchange ended recently enough to repeat it."""
        return self._clock.now() - exchange.last_s <= REPEATABLE_S

    def exchange(self, turn: int) -> DialogueExchange | None:
        """The exchange of this turn, or None."""
        return self._last(lambda one: turn > 0 and one.turn == turn)

    def named(self) -> Sequence[Call]:
        """The last calls that words named, whether they were made or only asked about or kept.

        Those of questions to the robot as well; the last one first.
        """
        begun_s = self._clock.now() - REPEATABLE_S
        with self._lock:
            return [call for said_s, call in reversed(self._named) if said_s >= begun_s]

    def running(self) -> MotionRecord | None:
        """The motion that runs now, or None."""
        with self._lock:
            live = [one for one in self._motions if one.status is GoalStatus.RUNNING]
            return live[-1] if live else None

    def left_s(self, running: MotionRecord) -> float | None:
        """Seconds that a running motion still takes, if it goes on as it did until now; or None."""
        if running.began_s is None or not running.progress:
            return None
        return (self._clock.now() - running.began_s) * (1 / running.progress - 1)

    def took_s(self, motion: MotionRecord) -> int | None:
        """Whole seconds that a motion took, at least one; until now if it runs. None if unknown."""
        if motion.began_s is None:
            return None
        runs = motion.status is GoalStatus.RUNNING
        return max(1, round((self._clock.now() if runs else motion.last_s) - motion.began_s))

    def moved(self) -> MotionRecord | None:
        """The last motion, running or ended, or None."""
        return next(iter(self._ran()), None)

    def came_from(self) -> Pose2D | None:
        """The pose where the last motion began, or None.

        If that motion reached its goal: the start of the last motion that began elsewhere.
        """
        ran, here = self._ran(), self._where()
        if not ran or here is None or ran[0].status is not GoalStatus.SUCCEEDED:
            return ran[0].start if ran else None
        starts = (one.start for one in ran if one.start)
        return next((one for one in starts if distance_on_floor(one, here) > _ELSEWHERE_M), None)

    def _ran(self) -> list[MotionRecord]:
        """The recent motions that ran, the last first."""
        begun_s = self._clock.now() - REMEMBERED_S
        with self._lock:
            ran = [one for one in self._motions if one.began and one.last_s >= begun_s]
        return ran[::-1]

    def _last(self, fits: Callable[[DialogueExchange], bool]) -> DialogueExchange | None:
        begun_s = self._clock.now() - REMEMBERED_S
        with self._lock:
            fit = [one for one in self._exchanges if one.last_s >= begun_s and fits(one)]
            return fit[-1] if fit else None

    def _of(self, turn: int, words: str = "") -> DialogueExchange:
        for one in self._exchanges:
            if turn and one.turn == turn:
                return one
        self._exchanges.append(DialogueExchange(turn, words, self._clock.now()))
        return self._exchanges[-1]

    def _on_words(self, event: Transcribed) -> None:
        with self._lock:
            self._of(event.turn, event.text)

    def _on_call(self, event: ToolCalled) -> None:
        if not event.turn or event.source == PROGRAM:
            return
        with self._lock:
            call = Call(event.skill, event.arguments)
            if any(one.turn == event.turn and one.words for one in self._exchanges):
                self._name([call])
            if event.skill in self._dialogue_skills:
                return
            one = self._of(event.turn)
            one.source = one.source or event.source
            one.calls.append(call)
            one.stopped = one.stopped or event.skill == STOP

    def _on_question(self, event: Confirmation) -> None:
        if event.status is ConfirmationStatus.ASKED:
            with self._lock:
                self._name([Call(one.skill, one.arguments) for one in event.calls])

    def _name(self, calls: Iterable[Call]) -> None:
        self._named += [(self._clock.now(), call) for call in calls if call.arguments]

    def _on_goal(self, event: GoalChanged | GoalCancelled) -> None:
        begins = event.status is GoalStatus.RUNNING and getattr(event, "feedback", None) is None
        start = self._where() if begins else None
        with self._lock:
            self._touch(event)
            skill = self._skills.get(event.skill)
            if skill is None or not skill.drives:
                return
            motion = self._motion(event)
            motion.status, motion.last_s = event.status, self._clock.now()
            motion.began = motion.began or begins
            motion.start = motion.start or start
            if begins:
                motion.began_s = motion.last_s
            if isinstance(event, GoalChanged) and event.feedback:
                motion.progress = _part(event.feedback.get("progress"))
                motion.told = str(event.feedback.get("text", ""))[:MOST_TOLD]

    def _where(self) -> Pose2D | None:
        """The body's pose; None if it does not know it."""
        try:
            return self._pose() if self._pose else None
        except SkillFailed:
            return None

    def _touch(self, event: GoalChanged | GoalCancelled) -> None:
        for one in self._exchanges:
            if event.turn and one.turn == event.turn:
                one.last_s = self._clock.now()
                one.stopped = one.stopped or event.status is GoalStatus.CANCELLED

    def _motion(self, event: GoalChanged | GoalCancelled) -> MotionRecord:
        for one in self._motions:
            if one.goal_id == event.goal_id:
                return one
        now_s = self._clock.now()
        about = (event.goal_id, event.skill, event.arguments, event.turn)
        self._motions.append(MotionRecord(*about, now_s, event.status))
        return self._motions[-1]

    def _on_stop(self) -> None:
        with self._lock:
            for one in self._exchanges:
                one.stopped = True

    def _on_interrupt(self, event: Interrupted) -> None:
        if event.cause is Cause.RESET:
            with self._lock:
                self._exchanges.clear()
                self._named.clear()
                live = [one for one in self._motions if one.status not in GOAL_ENDS]
                self._motions = deque(live, MOST_EXCHANGES)
        elif event.cause not in _HUSHED:
            self._on_stop()


def _part(progress: Any) -> float | None:
    """The progress from 0 to 1 that a skill reported; None for any other value."""
    return float(progress) if is_number(progress) and 0 <= progress <= 1 else None
