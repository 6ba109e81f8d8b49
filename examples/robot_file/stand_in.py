"""What robots that stand in for real ones share: plain rclpy, nothing of edgevox imported.

What such a robot was asked stands on ``asked``, as JSON. A string on ``do`` changes it while it
runs: refuse, hang, abort, lie or obey.
"""

import argparse
import contextlib
import json
import threading
from collections.abc import Callable
from typing import Any

import rclpy
from rclpy.action import ActionServer, CancelResponse, GoalResponse
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import ExternalShutdownException, MultiThreadedExecutor
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile
from std_msgs.msg import String

PERIOD_S = 0.1
PAUSE_S = 0.05
LATCHED = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
"""Of a topic whose last message is kept for whoever comes later."""
THREADS = 8


class StandIn(Node):
    """A robot's node. A subclass adds interfaces, and says its state in `say`."""

    def __init__(self, namespace: str) -> None:
        super().__init__("stand_in", namespace=namespace)
        self.mode = "obey"
        self.over = threading.Event()
        self.group = ReentrantCallbackGroup()
        kept = QoSProfile(depth=100, durability=DurabilityPolicy.TRANSIENT_LOCAL)
        self.asked = self.create_publisher(String, "asked", kept)
        self.create_subscription(String, "do", self._do, 10)
        self.create_timer(PERIOD_S, self.say, self.group)

    def say(self) -> None:
        """Publish its state; called again and again."""

    def change(self, change: str) -> bool:  # noqa: ARG002 - it has nothing to change
        """Change something of one's own; whether this was such a change."""
        return False

    def tell(self, what: str, value: object) -> None:
        self.asked.publish(String(data=json.dumps([what, value])))

    def pause(self) -> bool:
        """A moment of work; whether it goes on."""
        return not self.over.wait(PAUSE_S)

    def hears(self, kind: type, name: str, hear: Callable[[Any], None] | None = None) -> None:
        """A topic: what comes is told, and heard."""

        def take(message: Any) -> None:
            self.tell(name, plain(message))
            if hear:
                hear(message)

        self.create_subscription(kind, name, take, 10, callback_group=self.group)

    def acts(self, kind: Any, name: str, work: Callable[[Any], bool | None], result: Any) -> None:
        """An action: `work` takes the goal until it is done (true), gave up, or was cancelled.

        `result` makes what comes back.
        """

        def run(goal: Any) -> Any:
            self.tell(name, plain(goal.request))
            done = self._hang(goal) if self.mode == "hang" else work(goal)
            if goal.is_cancel_requested:
                self.tell("cancelled", name)
                goal.canceled()
            elif done and self.mode != "abort":
                goal.succeed()
            else:
                goal.abort()
            return result()

        ActionServer(
            self,
            kind,
            name,
            run,
            goal_callback=lambda _: (
                GoalResponse.REJECT if self.mode == "refuse" else GoalResponse.ACCEPT
            ),
            cancel_callback=lambda _: CancelResponse.ACCEPT,
            callback_group=self.group,
        )

    def _hang(self, goal: Any) -> bool:
        while self.mode == "hang" and not goal.is_cancel_requested and self.pause():
            pass
        return True

    def _do(self, message: String) -> None:
        if not self.change(message.data):
            self.mode = message.data
        self.tell("do", message.data)


def plain(value: Any) -> Any:
    """A message as JSON has it."""
    if hasattr(value, "get_fields_and_field_types"):
        return {name: plain(getattr(value, name)) for name in value.get_fields_and_field_types()}
    if isinstance(value, str | bool | int | float):
        return value
    return [plain(one) for one in value]


def main(robot: Callable[[str], StandIn], about: str | None) -> None:
    """Run it until the process is ended."""
    parser = argparse.ArgumentParser(description=about)
    parser.add_argument("--namespace", default="/")
    options = parser.parse_args()
    rclpy.init(args=[])
    node = robot(options.namespace)
    executor = MultiThreadedExecutor(THREADS)
    executor.add_node(node)
    try:
        with contextlib.suppress(ExternalShutdownException, KeyboardInterrupt):
            while rclpy.ok():
                executor.spin_once(timeout_sec=1.0)  # a wake-up may be lost
    finally:  # whatever a shutdown in the middle raises: who hangs is waited for at the exit
        node.over.set()
