"""What ROS 2 costs beside plain rclpy: messages, round trips, an idle robot, images.

Peers are processes of their own, as on a real robot.
"""

import array
import importlib
import random
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import UnionType
from typing import Any

from rclpy.context import Context
from rclpy.node import Node
from sensor_msgs.msg import Image
from std_msgs.msg import Float32, String

from benchmarks.core.figures import Figure, Measured
from benchmarks.core.stopwatch import percent_of
from benchmarks.core.talker import PLAIN, Talker, isolate, wait_until
from benchmarks.wire.listener import ECHOED, IMAGE_QOS, RELIABLE, SAID, listener
from edgevox.core import events
from edgevox.core.agent_events import AgentEvent, GoalChanged, GoalStatus
from edgevox.robots.flat.apartment import ApartmentRobot
from edgevox.ros2.contract import PUBLISHED, RATED, Rated
from edgevox.ros2.contract_rows import STRING, Published
from edgevox.ros2.messages import profile

MESSAGES = "Publishing one message, from the event to the wire"
TRIPS = "Round trips over ROS 2"
IDLE = "An idle node with the apartment robot"
RATES = "Rates heard of an idle node, of what the contract says"
IMAGES = "Images of 640 x 480, rgb8"
SETTLE_S = 3.0
"""Start and discovery are no part of what an idle node costs."""
IDLE_WANTED_PERCENT = 2.0
RATE_WANTED_PERCENT = 95.0
WIDTH, HEIGHT = 640, 480
SENTENCE = "I am in the living room, at x 4.3, y 0.8."
GOAL = GoalChanged(
    "0" * 32,
    "navigate_to",
    {"room": "kitchen"},
    GoalStatus.RUNNING,
    turn=1,
    feedback={"progress": 0.5, "distance_m": 2.25, "x": 4.313, "y": 0.842},
)


def measure(quick: bool = False) -> Measured:
    """All five, each on a domain of its own."""
    rounds = 2 if quick else 5
    return Measured(
        figures=(
            *messages(rounds, 200 if quick else 1000),
            *round_trips(rounds),
            *idle(4.0 if quick else 20.0),
            *rates(5.0 if quick else 60.0),
            *images(1.0 if quick else 5.0),
        )
    )


def messages(rounds: int, number: int) -> Iterator[Figure]:
    """Microseconds for each topic: unheard, heard, and heard as a plain, ready string."""
    event_of = _samples()
    domain = isolate()

    def cost(node: Node, row: Published, column: str, **more: object) -> Figure:
        event = event_of[row.event]
        ready = row.encode(event)
        encode = (lambda: ready) if column == "plain rclpy" else (lambda: row.encode(event))
        taken = costs_us(node, row, encode, column != "unheard", (rounds, number))
        name = column.partition(" ")[0]
        return Figure.of(
            f"publish.{row.topic}.{name}", MESSAGES, f"`{row.topic}`", taken, "µs",
            column=column, **more,
        )  # fmt: skip

    with a_node(domain) as node:
        yield from (cost(node, row, "unheard") for row in PUBLISHED)
    with a_node(domain) as node, listener("messages"):
        for row in PUBLISHED:
            yield cost(node, row, "plain rclpy")
            yield cost(node, row, "heard", baseline=f"publish.{row.topic}.plain")


def costs_us(
    node: Node, row: Published, encode: Callable[[], Any], heard: bool, rounds: tuple[int, int]
) -> list[float]:
    """The mean cost of one message, once for each round."""
    kind: Any = String if row.type == STRING else Float32
    publisher = node.create_publisher(kind, row.topic, profile(row.qos))
    if heard:
        wait_until(lambda: publisher.get_subscription_count() > 0, row.topic)
    taken = []
    for _ in range(rounds[0]):
        begun = time.perf_counter()
        for _ in range(rounds[1]):
            publisher.publish(kind(data=encode()))
        taken.append(1e6 * (time.perf_counter() - begun) / rounds[1])
    node.destroy_publisher(publisher)
    return taken


def round_trips(rounds: int) -> Iterator[Figure]:
    """From a message out to its answer in: a plain node that only echoes, and the agent."""
    plain: list[float] = []
    ours: list[float] = []
    with Talker("--llm=none") as talker, listener("echo"):
        echoed = talker.peer.listen(ECHOED, RELIABLE)
        for text in PLAIN * rounds * 2:
            heard = len(echoed.messages)
            begun = time.monotonic()
            talker.peer.send(SAID, text)
            echoed.wait_for(lambda _: True, since=heard)
            plain.append(1000 * (echoed.times[heard] - begun))
            ours.append(1000 * talker.acknowledged_s(text))
    # The first of each waits for what is discovered, opened and cached only once.
    yield Figure.of("echo", TRIPS, "a plain rclpy node that echoes", plain[1:], "ms")
    yield Figure.of(
        "round_trip", TRIPS, "`text_input` of a plain command to `bot_sentence`", ours[1:], "ms",
        baseline="echo",
    )  # fmt: skip


def idle(seconds: float) -> Iterator[Figure]:
    """Percent of one core that a standing robot takes, its TF at 30 Hz."""
    with Talker("--llm=none") as talker:
        pid = talker.pid
        talker.peer.close()
        time.sleep(SETTLE_S)
        unheard = percent_of(pid, seconds)
        with listener("robot"):
            time.sleep(SETTLE_S)
            heard = percent_of(pid, seconds)
    for identifier, what, share in (
        ("idle_unheard", "nobody listens", unheard),
        ("idle_heard", "`/tf`, `robot_state` are heard", heard),
    ):
        yield Figure.of(identifier, IDLE, what, [share], "% of a core", wanted=IDLE_WANTED_PERCENT)


def rates(seconds: float) -> Iterator[Figure]:
    """What a peer hears of each topic that the robot of the apartment has, in percent."""
    with Talker("--llm=none") as talker:
        node = talker.peer.node
        heard: list[tuple[Rated, list[float]]] = []
        for row in RATED:
            topic = row.topic if row.topic.startswith("/") else talker.peer.name(row.topic)
            if not node.count_publishers(topic):
                continue  # a camera; a clock that nobody asked for
            times: list[float] = []
            node.create_subscription(
                message_class(row.type),
                topic,
                lambda _, times=times: times.append(time.monotonic()),
                IMAGE_QOS,
                raw=True,
            )
            heard.append((row, times))
        time.sleep(SETTLE_S + seconds)
    for row, times in heard:
        since = [one for one in times if one >= times[-1] - seconds]
        hz = (len(since) - 1) / (since[-1] - since[0])
        yield Figure.of(
            f"rate.{row.topic.strip('/')}", RATES, f"`{row.topic}`, {row.rate_hz:g} Hz",
            [100 * hz / row.rate_hz], "%", wanted=RATE_WANTED_PERCENT, more_is_better=True,
        )  # fmt: skip


def message_class(kind: str) -> type:
    """The class of a message by its full name."""
    package, _, name = kind.split("/")
    return getattr(importlib.import_module(f"{package}.msg"), name)


def images(seconds: float) -> Iterator[Figure]:
    """What images cost, by what their data is given as; heard by one process."""
    pixels = random.Random(1).randbytes(WIDTH * HEIGHT * 3)
    ways: dict[str, Callable[[], Any]] = {
        "array": lambda: array.array("B", pixels),
        "bytes": lambda: pixels,
        "list": lambda: list(pixels),
    }
    with a_node(isolate()) as node, listener("images"):
        publisher = node.create_publisher(Image, "image_raw", IMAGE_QOS)
        wait_until(lambda: publisher.get_subscription_count() > 0, "image_raw")

        def send(data: Callable[[], Any]) -> None:
            message = Image(height=HEIGHT, width=WIDTH, encoding="rgb8", step=3 * WIDTH)
            message.data = data()
            publisher.publish(message)

        for name, data in ways.items():
            what = f"data given as {name}"
            for hz in (5.0, 30.0):
                taken, share = paced(lambda d=data: send(d), hz, seconds)
                if hz == 5.0:
                    yield Figure.of(f"image.{name}", IMAGES, what, taken, "ms", column="one image")
                yield Figure.of(
                    f"image.{name}.{hz:.0f}hz", IMAGES, what, [share], "% of a core",
                    column=f"at {hz:.0f} Hz",
                )  # fmt: skip


def paced(work: Callable[[], None], hz: float, seconds: float) -> tuple[list[float], float]:
    """Do it `hz` times a second; milliseconds of each, percent of one core."""
    taken, begun, before = [], time.perf_counter(), time.process_time()
    for number in range(round(seconds * hz)):
        time.sleep(max(0.0, begun + number / hz - time.perf_counter()))
        start = time.perf_counter()
        work()
        taken.append(1000 * (time.perf_counter() - start))
    time.sleep(max(0.0, begun + seconds - time.perf_counter()))
    whole = time.perf_counter() - begun
    return taken, 100 * (time.process_time() - before) / whole


@contextmanager
def a_node(domain: int) -> Iterator[Node]:
    """A node with nothing but what is measured."""
    context = Context()
    context.init(domain_id=domain)
    node = Node("edgevox", namespace="/edgevox", context=context)
    try:
        yield node
    finally:
        node.destroy_node()
        context.try_shutdown()


def _samples() -> dict[type | UnionType, object]:
    """An event of each kind that has a topic, as large as they usually are, by its type."""
    return {
        events.Transcribed: events.Transcribed("go to the kitchen"),
        events.Responded: events.Responded(SENTENCE),
        events.StateChanged: events.StateChanged(events.State.LISTENING),
        events.AudioLevel: events.AudioLevel(0.25),
        events.TurnMeasured: events.TurnMeasured(0.4, 0.9, 0.1, 1.2, 2.5),
        events.RobotState: events.RobotState(ApartmentRobot().state()),
        AgentEvent: GOAL,
        events.TokenGenerated: events.TokenGenerated(" kitchen"),
        events.SentenceReady: events.SentenceReady(SENTENCE),
        events.WakeWordHeard: events.WakeWordHeard("hey jarvis"),
        events.Answered: events.Answered(
            "list_languages", {"current": "en", "languages": {"en": {"name": "English"}}}
        ),
    }
