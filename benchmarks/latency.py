"""How fast a running agent answers and stops, and how much memory it takes, seen over ROS 2.

Starts `edgevox-agent` as users do, in a process of its own, and talks to it as any ROS 2 node
would. Run it with ``make bench``; it prints the table and writes `latency.md` beside this file.
"""

import json
import os
import random
import statistics
import sys
import time
from collections.abc import Callable
from pathlib import Path

HERE = Path(__file__).parent
sys.path.insert(0, str(HERE.parent / "tests" / "ros2"))

import sim  # noqa: E402
from conftest import Agent  # noqa: E402
from machine import machine  # noqa: E402
from peer import RELIABLE, SENSOR, STATE, Heard, Peer  # noqa: E402

PLAIN = ("where are you", "go to the kitchen", "go to the bedroom", "what is your battery level")
FOR_THE_MODEL = (
    "I feel like having a snack",
    "my bed is calling me",
    "I ought to answer my mail now",
    "would you mind checking how much power remains",
)
ROUNDS = 5
SETTLE_S = 0.3
"""Two topics have no order between them; after this long the first message has arrived."""
STORY = "why is the sky blue and why do people like to look at it"
"""Answered in many words, so that there is time to interrupt."""


class Bench:
    """One agent and a peer that listens to it."""

    def __init__(self, *arguments: str) -> None:
        domain = random.Random().randrange(1, 100)
        os.environ["ROS_AUTOMATIC_DISCOVERY_RANGE"] = "LOCALHOST"
        started = time.monotonic()
        self.agent = Agent(
            "robot-apartment", "--text-mode", "--ros2", "--ros2-state-hz=100", *arguments,
            domain=domain,
        )  # fmt: skip
        self.agent.wait_for_line("is ready", timeout_s=120)
        self.start_s = time.monotonic() - started
        self.peer = Peer(domain)
        self.sentence = self.peer.listen("bot_sentence", RELIABLE)
        self.token = self.peer.listen("bot_token", SENSOR)
        self.state = self.peer.listen("state", STATE)
        self.robot = self.peer.listen("robot_state", STATE)

    def close(self) -> None:
        self.peer.close()
        self.agent.terminate()

    def resident_mb(self) -> float:
        status = Path(f"/proc/{self.agent.process.pid}/status").read_text()
        return next(int(x.split()[1]) for x in status.splitlines() if x.startswith("VmRSS")) / 1024

    def say(self, text: str) -> float:
        self.peer.send("text_input", text)
        return time.monotonic()

    def acknowledged_s(self, text: str) -> float:
        """Seconds from the message out to the first sentence in; then the robot is stopped."""
        heard = len(self.sentence.messages)
        begun = self.say(text)
        self.sentence.wait_for(lambda _: True, timeout_s=60, since=heard)
        taken = self.sentence.times[heard] - begun
        self._stop()
        return taken

    def stopped_s(self) -> float:
        """Seconds from "stop" out to zero velocity in, while the robot drives and a model works."""
        self.peer.send("command", "reset")  # no history, so that each round is like the first
        time.sleep(SETTLE_S)
        self.say(random.choice(("go to the bedroom", "go to the office", "go to the kitchen")))
        _wait(self.robot, lambda m: json.loads(m)["velocity"]["linear"] > 0.3)
        heard = len(self.token.messages)
        self.say(STORY)
        self.token.wait_for(lambda _: True, timeout_s=60, since=heard)
        seen = len(self.robot.messages)
        begun = self.say("stop")
        self.robot.wait_for(_standing, since=seen)
        index = next(i for i in range(seen, 10**9) if _standing(self.robot.messages[i]))
        taken = self.robot.times[index] - begun
        self._stop()
        return taken

    def _stop(self) -> None:
        heard = len(self.sentence.messages)
        self.say("stop")
        self.sentence.wait_for(lambda m: m in ("Stopped.", "I am standing still."), since=heard)
        self.state.wait_for(lambda m: m == "listening", since=len(self.state.messages) - 1)


def _standing(message: str) -> bool:
    velocity = json.loads(message)["velocity"]
    return abs(velocity["linear"]) < 0.005 and abs(velocity["angular"]) < 0.005


def _wait(heard: Heard, wanted: Callable[[str], bool]) -> None:
    heard.wait_for(wanted, timeout_s=30, since=len(heard.messages))


def measure() -> dict[str, dict[str, float]]:
    """All figures, by name; seconds in milliseconds as median and largest."""
    rows: dict[str, dict[str, float]] = {}
    bare = Bench("--llm=none")
    rows["memory without a model, MB"] = {"median": bare.resident_mb()}
    bare.close()
    bench = Bench()
    try:
        rows["start to ready, s"] = {"median": bench.start_s}
        rows["first sentence for the model, right after the start, ms"] = {
            "median": 1000 * bench.acknowledged_s(FOR_THE_MODEL[0])
        }
        rows["plain command to acknowledgement, ms"] = _ms(
            [bench.acknowledged_s(text) for text in PLAIN * ROUNDS]
        )
        rows["sentence for the model to acknowledgement, ms"] = _ms(
            [bench.acknowledged_s(text) for text in FOR_THE_MODEL * ROUNDS]
        )
        rows['"stop" to zero velocity while the model generates, ms'] = _ms(
            [bench.stopped_s() for _ in range(2 * ROUNDS)]
        )
        rows["memory with the small model, MB"] = {"median": bench.resident_mb()}
    finally:
        bench.close()
    return rows


def _ms(seconds: list[float]) -> dict[str, float]:
    return {"median": 1000 * statistics.median(seconds), "largest": 1000 * max(seconds)}


def table(rows: dict[str, dict[str, float]]) -> str:
    """The figures as a Markdown table."""
    lines = [f"Measured on {machine()}.", "", "| what | median | largest |", "|---|---:|---:|"]
    for name, row in rows.items():
        largest = f"{row['largest']:,.1f}" if "largest" in row else ""
        lines.append(f"| {name} | {row['median']:,.1f} | {largest} |")
    return "\n".join(lines) + "\n"


def main() -> None:
    """Measure, write the table, print it."""
    rows = measure()
    rows |= {sim.UNITS[name]: {"median": value} for name, value in sim.measure().items()}
    text = table(rows)
    (HERE / "latency.md").write_text(text, encoding="utf-8")
    print(text)


if __name__ == "__main__":
    main()
