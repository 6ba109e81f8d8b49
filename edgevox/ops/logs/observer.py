"""Writes down what happens on the bus: turns, goals, stops. No stage logs any of that itself."""

from collections import OrderedDict
from collections.abc import Callable, Mapping
from typing import Any, TypeVar

from edgevox.core.bus import Bus
from edgevox.core.clock import Clock, SystemClock
from edgevox.core.events import (
    AgentEvent,
    AgentEventKind,
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
            bus.subscribe(AgentEvent, self._on_deed),
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

    def _on_deed(self, event: AgentEvent) -> None:
        data = event.data
        match event.kind:
            case AgentEventKind.TOOL_CALL:
                if data["turn"]:
                    _keep(self._paths, data["turn"], data["source"])
                told = {"skill": data["skill"], "arguments": self._arguments(data)}
                log.info("skill_called", path=data["source"], **told, **_of(data["turn"]))
            case AgentEventKind.SKILL_GOAL | AgentEventKind.SKILL_CANCELLED:
                self._on_goal(data)
            case AgentEventKind.HANDOFF:
                log.info("handed_over", giver=data["from"], taker=data["to"], **_of(data["turn"]))
            case AgentEventKind.SAFETY_PREEMPT:
                log.info("safety_stop", word=data["word"], stopped=data["stopped"])

    def _on_goal(self, data: Mapping[str, Any]) -> None:
        if "feedback" in data:
            return
        goal, status = data["goal_id"], data["status"]
        ids = {"goal": goal, "skill": data["skill"], **_of(data["turn"])}
        if status == "running":
            _keep(self._began_s, goal, self._clock.now())
            log.info("goal_started", **ids, arguments=self._arguments(data))
            return
        if status in ("accepted", "rejected"):  # whoever rejects a goal says so itself
            return
        began_s = self._began_s.pop(goal, None)
        ran = {} if began_s is None else {"ran_s": round(self._clock.now() - began_s, _MS)}
        if status == "succeeded":
            log.info("goal_succeeded", **ids, **ran)
        elif status == "failed":
            log.warning("goal_failed", **ids, **ran, reason=self._reason(data, "error"))
        else:
            log.info("goal_cancelled", **ids, **ran, reason=self._reason(data, "reason"))

    def _arguments(self, data: Mapping[str, Any]) -> dict[str, Any]:
        return {
            name: Said(str(value)) if self._free(data["skill"], name) else value
            for name, value in data["arguments"].items()
        }

    def _reason(self, data: Mapping[str, Any], key: str) -> str:
        """Why it ended, without what somebody said: a reason may quote an argument."""
        reason = str(data.get(key, ""))
        for value in self._arguments(data).values():
            if isinstance(value, Said) and value.text:
                reason = reason.replace(value.text, repr(value))
        return reason


def _of(turn: int) -> dict[str, int]:
    """0 stands for no turn."""
    return {"turn": turn} if turn else {}


def _keep(kept: "OrderedDict[K, V]", key: K, value: V) -> None:
    kept[key] = value
    if len(kept) > MOST_OPEN:
        kept.popitem(last=False)
