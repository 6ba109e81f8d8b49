"""How fast a body's world is, next to the same steps in its simulator alone: what is compared."""

from collections.abc import Callable
from dataclasses import dataclass

from benchmarks.core.stopwatch import Spent


@dataclass(frozen=True, slots=True)
class Run:
    """Seconds of a world, and what they took."""

    world_s: float
    spent: Spent

    @property
    def cost(self) -> float:
        """Processor time of the whole process for a second of the world."""
        return self.spent.process_s / self.world_s

    @property
    def world_cost(self) -> float:
        """The same of the world's own thread."""
        return self.spent.thread_s / self.world_s


@dataclass(frozen=True, slots=True)
class Row:
    """One figure: seconds of the world in a second of the processor, all threads together.

    `alone` is that of the simulator alone in the same steps. `added` is which part of the
    simulator's own time our layer adds on the thread that steps the world; `added_s` is the same
    in seconds for each step.
    """

    body: str
    what: str
    factor: float
    alone: float | None = None
    added: float | None = None
    added_s: float | None = None

    @property
    def added_by_all(self) -> float | None:
        """As `added`, with whatever else the body does: it plans, or thinks where to step."""
        return None if self.alone is None else self.alone / self.factor - 1.0


def compare(
    body: str,
    what: str,
    whole: Callable[[], Run],
    alone: Callable[[], Run],
    layer: Callable[[], Run] | None = None,
    *,
    rounds: int,
) -> Row:
    """Rounds take turns, and the least disturbed of each counts.

    `layer` is the body without what it thinks, if that is on the world's thread too.
    """
    runs = [(whole(), layer() if layer else None, alone()) for _ in range(rounds)]
    whole_cost = min(one.cost for one, _, _ in runs)
    layer_cost = min((bare or one).world_cost for one, bare, _ in runs)
    alone_cost = min(one.cost for _, _, one in runs)
    return Row(body, what, 1 / whole_cost, 1 / alone_cost, layer_cost / alone_cost - 1)
