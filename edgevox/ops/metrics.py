"""The metrics of one agent, in a registry of their own; Prometheus asks for them at /metrics.

`metric_table` declares every metric once. What components say of themselves is shown as the table
says. What happens, and how often and how long, is counted here as it passes on the bus: a status
says how something is now. Nothing here is imported unless metrics are on.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import partial

from prometheus_client import (
    CollectorRegistry,
    Counter,
    Gauge,
    Histogram,
    ProcessCollector,
    disable_created_metrics,
    generate_latest,
)
from prometheus_client.core import CounterMetricFamily, GaugeMetricFamily
from prometheus_client.exposition import CONTENT_TYPE_PLAIN_0_0_4
from prometheus_client.registry import Collector

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
from edgevox.core.log import get_logger, worth_a_line
from edgevox.core.status import Components
from edgevox.ops.http_server import HttpServer, Page
from edgevox.ops.metric_table import METRICS, STAGES, Kind, Metric

log = get_logger(__name__)

Values = float | Mapping[str, float] | Mapping[tuple[str, ...], float]
"""What is read: a number, or one for each value of the label, or of all labels in their order."""
Look = Callable[[], Values]
"""Reads a metric, quickly, without a lock that a stuck thread may hold."""
_ASKED = frozenset(
    place.partition(".")[0]
    for metric in METRICS.values()
    if isinstance(metric.read, Mapping)
    for place in metric.read.values()
)
"""The components of which anything is shown: no disk is asked, which may not answer."""

_FAMILIES = {Kind.COUNTER: CounterMetricFamily, Kind.GAUGE: GaugeMetricFamily}


class Registry(Collector):
    """Counts what `METRICS` declares, and reads the rest when it is asked for its text.

    What the table has in a status is what `components` say then; a value nobody knows yet is 0.
    What could not be read, of a component or by a look, is a failure of the part ``metrics``.
    `sets` holds, by the words that the table has for them, the values that only an agent knows. A
    counter of a known set is there from the start, with 0. With None nothing is counted, only read.
    """

    def __init__(
        self, sets: Mapping[str, Sequence[str]] | None, components: Components | None = None
    ) -> None:
        self._components = components or Components()
        # Else each counter has a series more, which nobody looks at.
        disable_created_metrics()  # type: ignore[no-untyped-call]
        self._registry = CollectorRegistry()
        self._counters: dict[str, Counter] = {}
        self._gauges: dict[str, Gauge] = {}
        self._histograms: dict[str, Histogram] = {}
        self._looks: dict[str, Look] = {}
        self.failures = 0
        for metric in METRICS.values():
            if sets is not None and not metric.read:
                self._make(metric, sets)
        self._registry.register(self)
        ProcessCollector(registry=self._registry)

    def counter(self, name: str) -> Counter:
        """A counter that counts what happens."""
        return self._counters[name]

    def gauge(self, name: str) -> Gauge:
        """A gauge that follows what happens."""
        return self._gauges[name]

    def histogram(self, name: str) -> Histogram:
        """A histogram of what happens."""
        return self._histograms[name]

    def read(self, name: str, look: Look) -> None:
        """From now on, read this metric so, and not in a status."""
        if not METRICS[name].read:
            raise ValueError(f"{name} is counted, not read")
        self._looks = {**self._looks, name: look}

    def text(self) -> bytes:
        """All of it, as Prometheus reads it."""
        return generate_latest(self._registry)

    def describe(self) -> Iterator[CounterMetricFamily | GaugeMetricFamily]:
        """Nothing, so that nothing is read before somebody asks."""
        return iter(())

    def collect(self) -> Iterator[CounterMetricFamily | GaugeMetricFamily]:
        """What is read. One that cannot be is left out; the others are still of use."""
        yield from self._shown()
        for name, look in self._looks.items():
            try:
                yield _family(METRICS[name], look())
            except Exception as error:  # noqa: BLE001 - whoever is read may raise what he likes
                self.failures += 1
                if worth_a_line(self.failures):
                    log.warning("metric_unreadable", metric=name, error=repr(error))

    def _shown(self) -> Iterator[CounterMetricFamily | GaugeMetricFamily]:
        """What the table has in a status."""
        told = {
            f"{status.name}.{name}": float(value or 0.0)
            for status in self._components.statuses(_ASKED)
            for name, value in status.values.items()
            if not isinstance(value, str)
        }
        told["metrics.unreadable"] = float(self.failures + self._components.failures)
        for metric in METRICS.values():
            if isinstance(metric.read, Mapping) and metric.name not in self._looks:
                places = metric.read.items()
                values = {label: told[place] for label, place in places if place in told}
                if values:
                    yield _family(metric, values.get("", values))

    def _make(self, metric: Metric, sets: Mapping[str, Sequence[str]]) -> None:
        name, about, labels = metric.name, metric.help, tuple(metric.labels)
        made: Counter | Gauge | Histogram
        match metric.kind:
            case Kind.COUNTER:
                made = self._counters[name] = Counter(name, about, labels, registry=self._registry)
            case Kind.GAUGE:
                made = self._gauges[name] = Gauge(name, about, labels, registry=self._registry)
            case Kind.HISTOGRAM:
                made = self._histograms[name] = Histogram(
                    name, about, labels, registry=self._registry, buckets=metric.buckets
                )
        for values in _combinations(metric, sets):
            made.labels(*values)


def _combinations(metric: Metric, sets: Mapping[str, Sequence[str]]) -> list[tuple[str, ...]]:
    """All values that the labels of a metric can have together."""
    found: list[tuple[str, ...]] = [()]
    for known in metric.labels.values():
        values = sets.get(known, ()) if isinstance(known, str) else known
        found = [(*before, value) for before in found for value in values]
    return [values for values in found if values]


def _family(metric: Metric, values: Values) -> CounterMetricFamily | GaugeMetricFamily:
    kind = _FAMILIES[metric.kind]
    family: CounterMetricFamily | GaugeMetricFamily
    family = kind(metric.name, metric.help, labels=tuple(metric.labels))
    if isinstance(values, Mapping):
        for key, value in values.items():
            family.add_metric((key,) if isinstance(key, str) else key, value)
    else:
        family.add_metric((), values)
    return family


class MetricsServer(HttpServer):
    """Raises `InvalidValue` where it cannot listen."""

    def __init__(self, registry: Registry, host: str, port: int) -> None:
        pages = {"/metrics": lambda: Page(registry.text(), CONTENT_TYPE_PLAIN_0_0_4)}
        super().__init__(pages, host, port, setting="metrics_port", name="edgevox-metrics")


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
