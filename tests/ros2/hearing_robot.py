"""A robot's part in its group, in a process of its own: what it hears comes as lines on stdin.

    python tests/ros2/hearing_robot.py NAME

A line is JSON: `{"heard": LEVEL_DB, "number": N}` for an utterance that ended now, and
`{"words": TEXT, "number": N}` once its words are known. Prints who is there, and what is decided.
"""

import json
import sys
import threading
import time

from edgevox.core.commands import Heard
from edgevox.core.hearers import Hearers, UtteranceHeard
from edgevox.core.motion.interlock import Interlock
from edgevox.ros2.node import RosNode
from edgevox.ros2.presence import Presence
from edgevox.ros2.ticker import Ticker

LASTED_S = 1.5


class Robot:
    """The node, with nothing but its presence."""

    def __init__(self, name: str) -> None:
        self.node = RosNode(f"/{name.lower()}")
        self.ticker = Ticker("ticker")
        self.hearers = Hearers(name, "hall")
        self.presence = Presence(self.node.node, "", Interlock(), self.ticker, self.hearers)
        self.heard: dict[int, UtteranceHeard] = {}
        self.last_s = float("-inf")
        self.told: tuple[str, ...] = ()
        self.ticker.every(0.05, self._tell_who)

    def _tell_who(self) -> None:
        """Say who is there, when that has changed."""
        if self.hearers.names != self.told:
            self.told = self.hearers.names
            say("here", *self.told)

    def take(self, line: str) -> None:
        told = json.loads(line)
        number = told["number"]
        if "heard" in told:
            ended_s = time.monotonic()
            began_s, self.last_s = max(self.last_s, ended_s - LASTED_S), ended_s
            self.heard[number] = UtteranceHeard(began_s, ended_s, told["heard"])
            self.hearers.heard(self.heard[number])
        else:
            one = self.heard[number]
            heard = Heard(told["words"], one.ended_s, began_s=one.began_s)
            self.hearers.settle(heard, lambda other: say("answers", number, other or "I"))

    def run(self) -> None:
        self.node.start()
        self.ticker.start()
        say("ready")
        for line in sys.stdin:
            self.take(line)
        self.presence.close()
        self.ticker.close()
        self.node.close()


_LOCK = threading.Lock()


def say(*words: object) -> None:
    with _LOCK:
        sys.stdout.write(" ".join(map(str, words)) + "\n")
        sys.stdout.flush()


if __name__ == "__main__":
    Robot(sys.argv[1]).run()
