"""Robots that share one server: each asks it again some seconds after its answer."""

import itertools
import random
import statistics
import threading
import time
from collections.abc import Callable, Iterable, Sequence
from concurrent.futures import ThreadPoolExecutor
from typing import TypeVar

R = TypeVar("R")
T = TypeVar("T")

PAUSE_S = 5.0


def take_turns(
    robots: Sequence[R], asked: Sequence[T], seconds: float, ask: Callable[[R, T], None]
) -> float:
    """Have all robots ask for so long; they begin spread over one pause. Return the seconds."""
    over = threading.Event()
    began_s = time.monotonic()
    end_s = began_s + seconds

    def work(robot: R, chance: random.Random) -> None:
        over.wait(chance.uniform(0.0, min(PAUSE_S, seconds / 2)) if len(robots) > 1 else 0.0)
        for one in itertools.cycle(chance.sample(asked, len(asked))):
            if time.monotonic() >= end_s:
                return
            ask(robot, one)
            over.wait(min(PAUSE_S, max(0.0, end_s - time.monotonic())))

    with ThreadPoolExecutor(len(robots)) as pool:
        list(pool.map(work, robots, map(random.Random, range(len(robots)))))
    return time.monotonic() - began_s


def waiting(waits_s: Iterable[float]) -> Sequence[tuple[str, str, str, float]]:
    """Key, column, unit and value of how long robots wait."""
    waits = sorted(waits_s)
    late_s = waits[min(len(waits) - 1, int(0.95 * len(waits)))]
    return (
        ("wait-p50", "waiting, p50", "s", statistics.median(waits)),
        ("wait-p95", "waiting, p95", "s", late_s),
    )
