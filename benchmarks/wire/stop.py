"""How soon a robot stands, by every way to stop it, whatever it is doing: seen over ROS 2.

From sending the word to zero velocity at a peer, which hears it 100 times a second. Frozen: for
3 s, timed from when the process continues. Generating: a model server that never ends its answer.
Starved: on one core, beside a program that takes all it gets.
"""

import time
from collections.abc import Iterator

from stop_rig import SITUATIONS, WAYS, Robot, settle

from benchmarks.core.figures import Figure, Measured
from benchmarks.core.talker import isolate

TABLE = "From the word to zero velocity"
WANTED_MS = 200.0
STATE_HZ = 100
ROUNDS = 3


def measure(quick: bool = False) -> Measured:
    """A table of what it is busy with against how it is told."""
    robot = Robot(isolate(), state_hz=STATE_HZ)
    try:
        return Measured(figures=tuple(_all(robot, 1 if quick else ROUNDS)))
    finally:
        robot.close()


def _all(robot: Robot, rounds: int) -> Iterator[Figure]:
    for situation in SITUATIONS:
        for way in WAYS:
            samples = [1000 * stopped_s(robot, situation, way) for _ in range(rounds)]
            identifier = f"{situation}.{way}".replace(" ", "_")
            yield Figure.of(
                identifier, TABLE, situation, samples, "ms", column=way, wanted=WANTED_MS
            )


def stopped_s(robot: Robot, situation: str, way: str) -> float:
    """Seconds until it stands, and goes on standing."""
    settle(robot)
    with SITUATIONS[situation](robot) as goal:
        since, begun = len(robot.state.messages), time.monotonic()
        WAYS[way](robot, goal)
    if situation == "frozen":
        begun = time.monotonic()
    robot.client.end_of(goal)
    return max(0.0, robot.state.times[robot.stood(since)] - begun)
