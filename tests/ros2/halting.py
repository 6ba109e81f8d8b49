"""How a robot stopped, by its own states alone: however late a word reaches it on a busy machine.

When it has let go of its goal it brakes. How long that takes passes by its own clock, and how far
it still had to go tells that it was stopped and had not arrived.
"""

import json
import math
from collections.abc import Sequence
from dataclasses import dataclass

from robot_states import standing

BRAKED_S = 1.0
"""The longest that any of the robots brakes, of its own time; a drive takes many more."""
LEFT_M = 0.5
"""Whoever has so far to go has not arrived, nor is braking for it."""


@dataclass(frozen=True, slots=True)
class Halt:
    """Seconds of its own from letting go of its goal to standing, and the way that was left."""

    braked_s: float
    left_m: float


def stands_for_good(message: str) -> bool:
    """It stands, and nothing is left that would move it."""
    return standing(message) and json.loads(message)["goal"] is None


def halt_of(messages: Sequence[str]) -> Halt:
    """The halt in these states, up to one in which it stands for good.

    A goal that came and went between two states is in none of them.
    """
    states = [json.loads(message) for message in messages]
    under_way = [number for number, state in enumerate(states) if state["goal"]]
    moved = [number for number, message in enumerate(messages) if not standing(message)]
    if not under_way and not moved:
        return Halt(0.0, math.inf)
    last = under_way[-1] if under_way else moved[0] - 1
    stood = next(n for n in range(last + 1, len(states)) if stands_for_good(messages[n]))
    left_m = states[last]["goal"]["distance"] if under_way else math.inf
    return Halt(states[stood]["time"] - states[min(last + 1, stood)]["time"], left_m)
