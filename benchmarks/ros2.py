"""What ROS 2 costs: messages, round trips, an idle robot, images. Writes `ros2.md` beside itself.

Peers are processes of their own, as on a real robot; ``python benchmarks/ros2.py`` runs all of it.
"""

import array
import os
import random
import statistics
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import latency
from conftest import Agent
from latency import HERE, Bench  # puts the helpers of tests/ros2 on the path, too
from machine import machine
from peer import wait_until
from rclpy.context import Context
from rclpy.node import Node
from ros2_listener import IMAGE_QOS, listener
from sensor_msgs.msg import Image
from std_msgs.msg import Float32, String

from edgevox.core import events
from edgevox.core.errors import EdgeVoxError
from edgevox.robots.apartment import ApartmentRobot
from edgevox.ros2.contract import PUBLISHED, STRING, Published
from edgevox.ros2.topics import profile

ROUNDS, MESSAGES = 5, 1000
IDLE_S, IMAGES_S = 20.0, 5.0
SETTLE_S = 3.0
"""Start and discovery are no part of what an idle node costs."""
WIDTH, HEIGHT = 640, 480
SENTENCE = "I am in the living room, at x 4.3, y 0.8."
GOAL = {
    "goal_id": "0" * 32,
    "skill": "navigate_to",
    "arguments": {"room": "kitchen"},
    "status": "running",
    "turn": 1,
    "feedback": {"progress": 0.5, "distance_m": 2.25, "x": 4.313, "y": 0.842},
}


@dataclass(frozen=True)
class Table:
    """One table of the page."""

    title: str
    head: tuple[str, ...]
    rows: list[tuple[str, ...]]

    def __str__(self) -> str:
        rule = "|---|" + "---:|" * (len(self.head) - 1)
        lines = [f"| {' | '.join(row)} |" for row in (self.head, *self.rows)]
        return "\n".join([f"## {self.title}", "", lines[0], rule, *lines[1:], ""])


def samples() -> dict[type, object]:
    """An event of each kind that has a topic, as large as they usually are."""
    return {
        events.Transcribed: events.Transcribed("go to the kitchen"),
        events.Responded: events.Responded(SENTENCE),
        events.StateChanged: events.StateChanged(events.State.LISTENING),
        events.AudioLevel: events.AudioLevel(0.25),
        events.TurnMeasured: events.TurnMeasured(0.4, 0.9, 0.1, 1.2, 2.5),
        events.RobotState: events.RobotState(ApartmentRobot().state()),
        events.AgentEvent: events.AgentEvent(events.AgentEventKind.SKILL_GOAL, GOAL),
        events.TokenGenerated: events.TokenGenerated(" kitchen"),
        events.SentenceReady: events.SentenceReady(SENTENCE),
        events.WakeWordHeard: events.WakeWordHeard("hey jarvis"),
        events.Answered: events.Answered(
            "list_languages", {"current": "en", "languages": {"en": {"name": "English"}}}
        ),
    }


def messages() -> Table:
    """Microseconds to encode and publish one message on each topic."""
    event_of = samples()

    def costs(node: Node, heard: bool) -> list[float]:
        return [cost_us(node, row, event_of[row.event], heard) for row in PUBLISHED]

    with a_node() as node:
        alone = costs(node, heard=False)
    with a_node() as node, listener("messages"):
        heard = costs(node, heard=True)
    rows = [
        (f"`{row.topic}`", f"{a:.0f}", f"{h:.0f}")
        for row, a, h in zip(PUBLISHED, alone, heard, strict=True)
    ]
    return Table("Publishing one message, microseconds", ("topic", "unheard", "heard"), rows)


def cost_us(node: Node, row: Published, event: object, heard: bool) -> float:
    """Median over the rounds of the mean cost of one message."""
    kind: Any = String if row.type == STRING else Float32
    publisher = node.create_publisher(kind, row.topic, profile(row.qos))
    if heard:
        wait_until(lambda: publisher.get_subscription_count() > 0, row.topic)
    taken = []
    for _ in range(ROUNDS):
        begun = time.perf_counter()
        for _ in range(MESSAGES):
            publisher.publish(kind(data=row.encode(event)))
        taken.append((time.perf_counter() - begun) / MESSAGES)
    node.destroy_publisher(publisher)
    return 1e6 * statistics.median(taken)


def round_trips() -> Table:
    """Milliseconds from `text_input` out to the first sign of an answer in."""
    bare = Bench("--llm=none")
    try:
        plain = [bare.acknowledged_s(text) for text in latency.PLAIN * ROUNDS]
    finally:
        bare.close()
    rows = [timed("plain command to `bot_sentence`", plain)]
    try:
        rows.append(timed("sentence for the model to `bot_token`", tokens()))
    except (EdgeVoxError, AssertionError) as error:
        reason = str(error).partition("\n")[0]
        rows.append((f"sentence for the model to `bot_token`: not measured, {reason}", "", ""))
    return Table("Round trips from `text_input`, ms", ("to", "median", "largest"), rows)


def tokens() -> list[float]:
    """Seconds to the first token. Raises where the model is not on this machine."""
    from edgevox.models import locate

    locate("qwen2.5-coder-0.5b-instruct")
    bench = Bench()
    try:
        bench.acknowledged_s(latency.PLAIN[0])
        return [first_token_s(bench) for _ in range(ROUNDS)]
    finally:
        bench.close()


def first_token_s(bench: Bench) -> float:
    """Seconds to the first token of a long answer, which is then stopped."""
    heard = len(bench.token.messages)
    begun = bench.say(latency.STORY)
    bench.token.wait_for(lambda _: True, timeout_s=60, since=heard)
    taken = bench.token.times[heard] - begun
    bench.acknowledged_s("stop")
    return taken


def timed(name: str, seconds: list[float]) -> tuple[str, str, str]:
    """A row: the median and the largest, in milliseconds."""
    milliseconds = [1000 * one for one in seconds]
    return name, f"{statistics.median(milliseconds):.1f}", f"{max(milliseconds):.1f}"


def idle() -> Table:
    """Percent of one core that a standing robot takes, its TF at 30 Hz."""
    domain = random.Random().randrange(1, 100)
    agent = Agent("robot-apartment", "--text-mode", "--ros2", "--llm=none", domain=domain)
    try:
        agent.wait_for_line("is ready")
        time.sleep(SETTLE_S)
        unheard = percent_of(agent.process.pid, IDLE_S)
        with listener("robot", str(domain)):
            time.sleep(SETTLE_S)
            heard = percent_of(agent.process.pid, IDLE_S)
    finally:
        agent.terminate()
    rows = [
        ("nobody listens", f"{unheard:.1f}"),
        ("`/tf`, `robot_state` are heard", f"{heard:.1f}"),
    ]
    return Table("An idle node with the apartment robot", ("when", "% of one core"), rows)


def percent_of(process: int, seconds: float) -> float:
    """How much of one core a process takes in the next seconds."""
    before = cpu_s(process)
    time.sleep(seconds)
    return 100 * (cpu_s(process) - before) / seconds


def cpu_s(process: int) -> float:
    """Seconds that a process has worked so far."""
    fields = Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def images() -> Table:
    """What images of 640 x 480 cost, by what their data is given as; heard by one process."""
    pixels = random.Random(1).randbytes(WIDTH * HEIGHT * 3)
    ways: dict[str, Callable[[], Any]] = {
        "`array.array`": lambda: array.array("B", pixels),
        "`bytes`": lambda: pixels,
        "list": lambda: list(pixels),
    }
    rows = []
    with a_node() as node, listener("images"):
        publisher = node.create_publisher(Image, "image_raw", IMAGE_QOS)
        wait_until(lambda: publisher.get_subscription_count() > 0, "image_raw")

        def send(data: Callable[[], Any]) -> None:
            message = Image(height=HEIGHT, width=WIDTH, encoding="rgb8", step=3 * WIDTH)
            message.data = data()
            publisher.publish(message)

        fastest = 0.0
        for name, data in ways.items():
            one_ms = 1000 * statistics.median(paced(lambda d=data: send(d), 5.0)[0])
            fastest = fastest or one_ms
            rates = [paced(lambda d=data: send(d), hz) for hz in (5.0, 30.0)]
            cells = [f"{hz:.1f} Hz, {cpu:.1f} %" for _, hz, cpu in rates]
            rows.append((name, f"{one_ms:.2f}", f"{one_ms / fastest:.0f}", *cells))
    head = (
        "data given as",
        "ms an image",
        "ratio",
        "at 5 Hz, of one core",
        "at 30 Hz, of one core",
    )
    return Table("Images of 640 x 480, rgb8", head, rows)


def paced(work: Callable[[], None], hz: float) -> tuple[list[float], float, float]:
    """Do it `hz` times a second; seconds of each, the rate that was held, percent of one core."""
    taken, begun, before = [], time.perf_counter(), time.process_time()
    for number in range(round(IMAGES_S * hz)):
        time.sleep(max(0.0, begun + number / hz - time.perf_counter()))
        start = time.perf_counter()
        work()
        taken.append(time.perf_counter() - start)
    time.sleep(max(0.0, begun + IMAGES_S - time.perf_counter()))
    whole = time.perf_counter() - begun
    return taken, len(taken) / whole, 100 * (time.process_time() - before) / whole


@contextmanager
def a_node() -> Iterator[Node]:
    """A node with nothing but what is measured."""
    context = Context()
    context.init(domain_id=int(os.environ["ROS_DOMAIN_ID"]))
    node = Node("edgevox", namespace="/edgevox", context=context)
    try:
        yield node
    finally:
        node.destroy_node()
        context.try_shutdown()


def main() -> None:
    """Measure, write the page, print it."""
    os.environ["ROS_AUTOMATIC_DISCOVERY_RANGE"] = "LOCALHOST"
    os.environ["ROS_DOMAIN_ID"] = str(random.Random().randrange(1, 100))
    tables = [messages(), round_trips(), idle(), images()]
    page = "\n".join([f"# What ROS 2 costs\n\nMeasured on {machine()}.\n", *map(str, tables)])
    (HERE / "ros2.md").write_text(page, encoding="utf-8")
    print(page)


if __name__ == "__main__":
    main()
