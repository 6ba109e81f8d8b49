"""Writes down what happens on the bus: turns, goals, stops. Nothing else logs any of that."""

import logging
from collections import OrderedDict
from collections.abc import Callable
from typing import Any, TypeVar

from edgevox.core.agent_events import (
    AgentEvent,
    Confirmation,
    DrainChanged,
    DrainStatus,
    GoalCancelled,
    GoalChanged,
    GoalStatus,
    HandedOver,
    ProgramChanged,
    SafetyPreempted,
    SoftwareStopChanged,
    ToolCalled,
    UtteranceLeft,
)
from edgevox.core.bus import Bus
from edgevox.core.clock import Clock, SystemClock
from edgevox.core.events import (
    ControlChanged,
    Interrupted,
    Responded,
    StateChanged,
    Transcribed,
    TurnEnded,
    TurnMeasured,
    WakeWordHeard,
)
from edgevox.core.log import Said, get_logger

log = get_logger(__name__)

MOST_OPEN = 256
"""So many turns and goals that have not ended are remembered; of more, the oldest is forgotten."""
_MS = 3

K = TypeVar("K")
V = TypeVar("V")

IsFree = Callable[[str, str], bool]
"""Whether this argument of this skill takes any words: then it may hold what somebody said."""


class BusLog:
    """One line for each turn's beginning and end, each goal's, each stop, each change.

    `free` says which arguments of skills are words of the person; they are treated as such.
    """

    def __init__(self, bus: Bus, free: IsFree, clock: Clock | None = None) -> None:
        self._free = free
        self._clock = clock or SystemClock()
        self._took: OrderedDict[int, TurnMeasured] = OrderedDict()
        self._paths: OrderedDict[int, str] = OrderedDict()
        self._began_s: OrderedDict[str, float] = OrderedDict()
        self._forget = [
            bus.subscribe(Transcribed, self._on_words),
            bus.subscribe(Responded, self._on_answer),
            bus.subscribe(StateChanged, self._on_state),
            bus.subscribe(TurnMeasured, lambda event: _keep(self._took, event.turn, event)),
            bus.subscribe(TurnEnded, self._on_end),
            bus.subscribe(
                Interrupted, lambda event: log.info("interrupted", cause=str(event.cause))
            ),
            bus.subscribe(WakeWordHeard, lambda event: log.info("wake_word", phrase=event.phrase)),
            bus.subscribe(ControlChanged, self._on_change),
            bus.subscribe(
                UtteranceLeft, lambda event: log.info("utterance_left", robot=event.robot)
            ),
            bus.subscribe(AgentEvent, self._on_agent_event),
        ]

    def close(self) -> None:
        """Write nothing more."""
        for forget in self._forget:
            forget()

    def _on_words(self, event: Transcribed) -> None:
        if event.turn:
            log.info("turn_began", turn=event.turn, text=Said(event.text))

    def _on_answer(self, event: Responded) -> None:
        log.info("answered", text=Said(event.text), cut=event.cut, **_of(event.turn))

    def _on_state(self, event: StateChanged) -> None:
        if log.isEnabledFor(logging.DEBUG):  # three a turn, which hardly anybody reads
            log.debug("state", state=str(event.state), **_of(event.turn))

    def _on_end(self, event: TurnEnded) -> None:
        took = self._took.pop(event.turn, None)
        path = self._paths.pop(event.turn, "")
        if event.outcome is None or took is None:
            return
        log.info(
            "turn_ended",
            turn=event.turn,
            outcome=str(event.outcome),
            path=path or ("model" if took.llm else "none"),
            stt_s=round(took.stt, _MS),
            llm_s=round(took.llm, _MS),
            tts_s=round(took.tts, _MS),
            ttfs_s=round(took.ttfs, _MS),
            total_s=round(took.total, _MS),
        )

    def _on_change(self, event: ControlChanged) -> None:
        log.info("control_changed", control=event.name, value=event.value)

    def _on_agent_event(self, event: AgentEvent) -> None:
        match event:
            case ToolCalled(source=source, turn=turn):
                if turn:
                    _keep(self._paths, turn, source)
                told = {"skill": event.skill, "arguments": self._arguments(event)}
                log.info("skill_called", path=source, **told, **_of(turn))
            case GoalChanged(feedback=None):
                self._on_goal(event)
            case GoalCancelled():
                reason = self._reason(event, str(event.reason))
                log.info("goal_cancelled", **_ids(event), **self._ran(event), reason=reason)
            case HandedOver(giver=giver, taker=taker):
                log.info("handed_over", giver=giver, taker=taker, **_of(event.turn))
            case SafetyPreempted(word=word, stopped=stopped, heard_by=heard_by):
                log.info("safety_stop", word=word, stopped=stopped, heard_by=str(heard_by))
            case Confirmation(status=status, question=question):
                log.info("confirmation", status=str(status), text=Said(question), **_of(event.turn))
            case ProgramChanged(program_id=program, status=status, reason=reason):
                how = {"status": str(status), "reason": str(reason or "")}
                log.info(
                    "program", program=program, text=Said(event.text), **how, **_of(event.turn)
                )
            case SoftwareStopChanged(engaged=engaged, by=by):
                log.warning("software_stop", engaged=engaged, by=by)
            case DrainChanged(status=DrainStatus.NOT_STANDING, by=by):
                log.error("drain_not_standing", by=by)
            case DrainChanged(status=status, by=by, within_s=within_s):
                log.info("drain", status=str(status), by=by, within_s=within_s)
            case _:  # how far a goal is; and whoever rejects a goal says so itself
                pass

    def _on_goal(self, goal: GoalChanged) -> None:
        match goal.status:
            case GoalStatus.RUNNING:
                _keep(self._began_s, goal.goal_id, self._clock.now())
                log.info("goal_started", **_ids(goal), arguments=self._arguments(goal))
            case GoalStatus.SUCCEEDED:
                log.info("goal_succeeded", **_ids(goal), **self._ran(goal))
            case GoalStatus.FAILED:
                reason = self._reason(goal, str(goal.reason or ""))
                log.warning("goal_failed", **_ids(goal), **self._ran(goal), reason=reason)

    def _ran(self, goal: GoalChanged | GoalCancelled) -> dict[str, float]:
        """How long it ran, if it did."""
        began_s = self._began_s.pop(goal.goal_id, None)
        return {} if began_s is None else {"ran_s": round(self._clock.now() - began_s, _MS)}

    def _arguments(self, event: ToolCalled | GoalChanged | GoalCancelled) -> dict[str, Any]:
        return {
            name: Said(str(value)) if self._free(event.skill, name) else value
            for name, value in event.arguments.items()
        }

    def _reason(self, goal: GoalChanged | GoalCancelled, reason: str) -> str:
        """Why it ended, without what somebody said: a reason may quote an argument."""
        for value in self._arguments(goal).values():
            if isinstance(value, Said) and value.text:
                reason = reason.replace(value.text, repr(value))
        return reason


def _ids(goal: GoalChanged | GoalCancelled) -> dict[str, Any]:
    return {"goal": goal.goal_id, "skill": goal.skill, **_of(goal.turn)}


def _of(turn: int) -> dict[str, int]:
    """0 stands for no turn."""
    return {"turn": turn} if turn else {}


def _keep(kept: "OrderedDict[K, V]", key: K, value: V) -> None:
    kept[key] = value
    if len(kept) > MOST_OPEN:
        kept.popitem(last=False)
