"""How a robot stopped, by its own states alone: however late a word reaches it on a busy machine.

When it has let go of its goal it brakes. How long that takes passes by its own clock, and how far
it still had to go tells that it was stopped and had not arrived.
"""

import json
import math
from collections.abc import Sequence
from dataclasses import dataclass

from peer import STATE, Peer
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


def settle(peer: Peer, agents: int = 1) -> None:
    """Wait until what was sent until now was received, end it, and wait until the robot stands.

    A topic keeps its order only for itself. What an executor has not seen when it looked for the
    first answer, it has when it looked for the second, and handled before the third.
    """
    info, state = peer.listen("info", publishers=agents), peer.listen("robot_state", STATE)
    for command in (*["list_languages"] * 3, "reset", "list_languages"):
        answers = len(info.messages) + agents * (command != "reset")
        peer.send("command", command, subscribers=agents)
        info.wait_until(lambda: len(info.messages) >= answers)  # noqa: B023
    state.wait_for(_rests, since=len(state.messages))


def _rests(message: str) -> bool:
    """It stands for good, or nobody knows whether it does."""
    return json.loads(message)["velocity"] is None or stands_for_good(message)
