"""What a metric is, before anybody counts."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import StrEnum

PREFIX = "edgevox_"


class Kind(StrEnum):
    """What Prometheus calls its type."""

    COUNTER = "counter"
    GAUGE = "gauge"
    HISTOGRAM = "histogram"


@dataclass(frozen=True, slots=True)
class Metric:
    """One metric. `help` is a sentence without its full stop.

    `labels` gives by name what its values are: all of them, or a word for a set that only a running
    agent knows, such as its skills; free text is never one. `of` says which agents have it.

    One that is `read` is looked up when somebody asks, the others are counted as things happen. By
    the values of its label (an empty one, if it has no label) `read` says which value of which
    component's status that is, as ``sim.stalled_s``; True is for what no status can say.
    """

    name: str
    kind: Kind
    help: str
    labels: Mapping[str, tuple[str, ...] | str] = field(default_factory=dict)
    buckets: tuple[float, ...] = ()
    of: str = "every agent"
    read: bool | Mapping[str, str] = False

    @property
    def series(self) -> frozenset[str]:
        """The names under which samples of it appear."""
        if self.kind is Kind.HISTOGRAM:
            return frozenset(f"{self.name}_{part}" for part in ("bucket", "count", "sum"))
        return frozenset({self.name})
