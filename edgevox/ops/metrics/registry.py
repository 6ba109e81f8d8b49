"""The metrics of one agent, in a registry of their own.

What components say of themselves is shown as the table says. What happens, and how often and how
long, is counted here as it passes on the bus: a status says how something is now.

Serves metrics over HTTP, as Prometheus asks for them: GET /metrics.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence

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

from edgevox.core.log import get_logger, worth_a_line
from edgevox.core.status import Components
from edgevox.ops.http_server import HttpServer, Page
from edgevox.ops.metrics.metric_table import METRICS, Kind, Metric

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
