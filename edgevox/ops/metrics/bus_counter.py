"""Counts what happens on the bus."""

from collections.abc import Callable
from functools import partial

from edgevox.core.agent_events import (
    GOAL_ENDS,
    AgentEvent,
    GoalCancelled,
    GoalChanged,
    GoalStatus,
    HeardBy,
    SafetyPreempted,
    ToolCalled,
)
from edgevox.core.bus import Bus
from edgevox.core.clock import Clock, SystemClock
from edgevox.core.events import (
    Cause,
    Interrupted,
    State,
    StateChanged,
    TurnEnded,
    TurnMeasured,
    WakeWordHeard,
)
from edgevox.ops.metrics.metric_table import STAGES
from edgevox.ops.metrics.registry import Registry


def observe(bus: Bus, registry: Registry, clock: Clock | None = None) -> Callable[[], None]:
    """Count from now on. Returns a way to end it."""
    observer = _Observer(registry, clock or SystemClock())
    wake_words = registry.counter("edgevox_wake_words_total")
    forget = [
        bus.subscribe(TurnEnded, observer.turn_ended),
        bus.subscribe(TurnMeasured, observer.turn_measured),
        bus.subscribe(AgentEvent, observer.agent_event),
        bus.subscribe(Interrupted, lambda event: observer.interrupted(event.cause)),
        bus.subscribe(StateChanged, observer.state_changed),
        bus.subscribe(WakeWordHeard, lambda _: wake_words.inc()),
    ]

    def end() -> None:
        for one in forget:
            one()

    return end


class _Observer:
    """Each method is called on the thread that published, so none of them waits for anything.

    The events of one goal come in order; `_running` is kept by goals, so that none counts twice.
    """

    def __init__(self, registry: Registry, clock: Clock) -> None:
        self._clock = clock
        self._turns = registry.counter("edgevox_turns_total")
        stages = registry.histogram("edgevox_turn_stage_seconds")
        self._stages = {stage: stages.labels(stage) for stage in STAGES}
        self._tokens = registry.counter("edgevox_llm_tokens_total")
        self._calls = registry.counter("edgevox_skill_calls_total")
        self._goals = registry.counter("edgevox_skill_goals_total")
        self._goals_running = registry.gauge("edgevox_skill_goals_running")
        self._goal_s = registry.histogram("edgevox_skill_goal_seconds")
        self._interrupts = registry.counter("edgevox_interrupts_total")
        self._safety_stops = registry.counter("edgevox_safety_stops_total")
        state = registry.gauge("edgevox_state")
        self._state: State | None = None
        for one in State:
            state.labels(one).set_function(partial(self._is_in, one))
        self._running: dict[str, float] = {}

    def turn_ended(self, event: TurnEnded) -> None:
        if event.outcome is not None:
            self._turns.labels(event.outcome).inc()
        self._tokens.inc(event.tokens)

    def turn_measured(self, event: TurnMeasured) -> None:
        for stage, histogram in self._stages.items():
            seconds = getattr(event, stage)
            if seconds > 0:
                histogram.observe(seconds)

    def interrupted(self, cause: Cause) -> None:
        self._interrupts.labels(cause).inc()

    def state_changed(self, event: StateChanged) -> None:
        self._state = event.state

    def _is_in(self, state: State) -> float:
        """Looked up when somebody fetches the metrics, which is less often than it changes."""
        return float(state is self._state)

    def agent_event(self, event: AgentEvent) -> None:
        match event:
            case GoalChanged() | GoalCancelled():
                self._goal(event.goal_id, event.skill, event.status)
            case ToolCalled(source=source):
                self._calls.labels(source).inc()
            case SafetyPreempted(stopped=stopped, heard_by=heard_by):
                spotted = heard_by is HeardBy.SPOTTER
                self.interrupted(Cause.STOP_SPOTTER if spotted else Cause.STOP_WORD)
                self._safety_stops.inc(stopped)

    def _goal(self, goal: str, skill: str, status: GoalStatus) -> None:
        if status is GoalStatus.RUNNING:
            if goal not in self._running:
                self._running[goal] = self._clock.now()
                self._goals_running.labels(skill).inc()
        elif status in GOAL_ENDS:
            self._goals.labels(skill, status).inc()
            began_s = self._running.pop(goal, None)
            if began_s is not None:
                self._goals_running.labels(skill).dec()
                self._goal_s.labels(skill).observe(self._clock.now() - began_s)
