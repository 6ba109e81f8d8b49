"""What was heard, who understood it, what was called and how it ended: the last exchanges only.

The last drive that somebody asked for in words: what "no, the bedroom" corrects.
"""

import math
import threading
from collections import deque
from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass, field
from typing import Any

from edgevox.agent.agents import Agent
from edgevox.agent.nlu.orders import Program
from edgevox.agent.skills import STOP, Call, Skill, SkillFailed
from edgevox.core.agent_events import (
    GOAL_ENDS,
    GoalCancelled,
    GoalChanged,
    GoalStatus,
    SafetyPreempted,
    ToolCalled,
)
from edgevox.core.bus import Bus
from edgevox.core.clock import Clock
from edgevox.core.events import Cause, Interrupted, Transcribed
from edgevox.core.files.json_reader import is_number
from edgevox.core.transforms import Pose2D

CORRECTED_S = 20.0
"""A drive can be corrected while it runs and for so long after its end."""


@dataclass(frozen=True, slots=True)
class DriveCall:
    """A call that set the body in motion, in which turn, and whose skill it is."""

    agent: Agent
    call: Call
    turn: int


class LastDrive:
    """Remembers it. Begun and looked at from one thread; how it ends comes from any."""

    def __init__(self, bus: Bus, clock: Clock) -> None:
        self._clock = clock
        self._drive: DriveCall | None = None
        self._ends_s: dict[int, float] = {}
        bus.subscribe(GoalChanged, self._on_goal)
        bus.subscribe(GoalCancelled, self._on_goal)

    @property
    def corrigible(self) -> DriveCall | None:
        """The drive, if somebody may still correct it."""
        drive = self._drive
        if drive is None:
            return None
        ended_s = self._ends_s.get(drive.turn)
        late = ended_s is not None and self._clock.now() - ended_s > CORRECTED_S
        return None if late else drive

    def begin(self, drive: DriveCall) -> None:
        """Remember this one instead; before it begins, so that no end is missed."""
        self._drive, self._ends_s = drive, {}

    def forget(self) -> None:
        """There is none to correct."""
        self._drive = None

    def _on_goal(self, event: GoalChanged | GoalCancelled) -> None:
        drive = self._drive
        mine = drive and (event.turn, event.skill) == (drive.turn, drive.call.skill)
        if mine and event.status in GOAL_ENDS:
            self._ends_s[event.turn] = self._clock.now()


MOST_EXCHANGES = 8
"""So many exchanges are remembered, and as many motions."""
REMEMBERED_S = 600.0
"""What is older is forgotten: nobody asks of it, and nobody drives back to where it began."""
_ELSEWHERE_M = 0.15
"""Nearer to where it stands a body has not come from: a drive ends so near to its goal."""
REPEATABLE_S = 60.0
"""So long after it ended something can be meant by "again": who says it then is another person."""

PROGRAM = "program"
"""Who calls the steps of a program."""

_HUSHED = (Cause.BARGE_IN, Cause.WAKE_WORD)
"""These cut what is said, and stop nothing."""


@dataclass(slots=True)
class DialogueExchange:
    """What somebody said, or a command asked; `source` is who understood it, if anybody did.

    `meant` are the words that it said yes to. What was kept for later is its `program`; what that
    calls is not in `calls`.

    `about_dialogue` is a question about the conversation: it is not what the next question asks
    about.
    """

    turn: int
    words: str
    last_s: float
    meant: str = ""
    source: str = ""
    confidence: float = 1.0
    calls: list[Call] = field(default_factory=list)
    program: Program | None = None
    about_dialogue: bool = False
    stopped: bool = False

    @property
    def acted(self) -> bool:
        """Whether words led to something."""
        return bool(self.words and (self.calls or self.program))


@dataclass(slots=True)
class MotionRecord:
    """A goal that sets the body in motion, once it `began`; `start` is where, if the body knows."""

    goal_id: str
    skill: str
    arguments: Mapping[str, Any]
    turn: int
    last_s: float
    status: GoalStatus
    began: bool = False
    start: Pose2D | None = None
    progress: float | None = None


class Dialogue:
    """Listens on the bus, and can be asked from any thread. All it holds is bounded.

    `skills` are all that there are, `pose` is the body's, and calls of `dialogue_skills` are not
    kept: they ask about the others.
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
        bus.subscribe(Transcribed, self._on_words)
        bus.subscribe(ToolCalled, self._on_call)
        bus.subscribe(GoalChanged | GoalCancelled, self._on_goal)
        bus.subscribe(SafetyPreempted, lambda _: self._on_stop())
        bus.subscribe(Interrupted, self._on_interrupt)

    def decided(self, turn: int, source: str, confidence: float, *, about_dialogue: bool) -> None:
        """Who understood the words of this turn, and how sure."""
        with self._lock:
            one = self._of(turn)
            one.source, one.confidence, one.about_dialogue = source, confidence, about_dialogue

    def confirmed(self, turn: int, asked: int) -> None:
        """The words of this turn are a yes: what is done in it was said in the one that `asked`."""
        with self._lock:
            said = next((one for one in self._exchanges if one.turn == asked), None)
            if said:
                yes = self._of(turn)
                yes.meant = said.meant or said.words
                yes.source, yes.confidence = said.source, said.confidence

    def kept(self, turn: int, program: Program) -> None:
        """The words of this turn are a program, which is kept."""
        with self._lock:
            self._of(turn).program = program

    def heard(self) -> DialogueExchange | None:
        """What was said last, unless that asks about it."""
        return self._last(lambda one: bool(one.words) and not one.about_dialogue)

    def asked(
        self, fits: Callable[[DialogueExchange], bool] = lambda _: True
    ) -> DialogueExchange | None:
        """What was last asked for in words, and called or kept, of what `fits`."""
        return self._last(lambda one: one.acted and not one.about_dialogue and fits(one))

    def repeatable(self, exchange: DialogueExchange) -> bool:
        """Whether it is not too long ago that this ended."""
        return self._clock.now() - exchange.last_s <= REPEATABLE_S

    def exchange(self, turn: int) -> DialogueExchange | None:
        """What was said in this turn; None for that of no turn."""
        return self._last(lambda one: turn > 0 and one.turn == turn)

    def running(self) -> MotionRecord | None:
        """What uses the body now."""
        with self._lock:
            live = [one for one in self._motions if one.status is GoalStatus.RUNNING]
            return live[-1] if live else None

    def moved(self) -> MotionRecord | None:
        """What used the body last, or uses it."""
        return next(iter(self._ran()), None)

    def came_from(self) -> Pose2D | None:
        """Where the last motion began; if it came to its end, the last that began elsewhere."""
        ran, here = self._ran(), self._where()
        if not ran or here is None or ran[0].status is not GoalStatus.SUCCEEDED:
            return ran[0].start if ran else None
        starts = (one.start for one in ran if one.start)
        return next((one for one in starts if _distance_m(one, here) > _ELSEWHERE_M), None)

    def _ran(self) -> list[MotionRecord]:
        """What used the body not too long ago, the last first."""
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
        if not event.turn or event.skill in self._dialogue_skills or event.source == PROGRAM:
            return
        with self._lock:
            one = self._of(event.turn)
            one.source = one.source or event.source
            one.calls.append(Call(event.skill, event.arguments))
            one.stopped = one.stopped or event.skill == STOP

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
            if isinstance(event, GoalChanged) and event.feedback:
                motion.progress = _part(event.feedback.get("progress"))

    def _where(self) -> Pose2D | None:
        """Where the body is, if it knows."""
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
                live = [one for one in self._motions if one.status not in GOAL_ENDS]
                self._motions = deque(live, MOST_EXCHANGES)
        elif event.cause not in _HUSHED:
            self._on_stop()


def _distance_m(one: Pose2D, other: Pose2D) -> float:
    return math.hypot(one.x_m - other.x_m, one.y_m - other.y_m)


def _part(progress: Any) -> float | None:
    """How far something is, as a skill reported it: it may be anything."""
    return float(progress) if is_number(progress) and 0 <= progress <= 1 else None
