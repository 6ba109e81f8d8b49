"""A process that listens, so that what is published has somebody to go to."""

import os
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from diagnostic_msgs.msg import DiagnosticArray
from rclpy.context import Context
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from sensor_msgs.msg import Image
from std_msgs.msg import Float32, String

from edgevox.ros2.contract import PUBLISHED
from edgevox.ros2.contract_rows import STRING
from edgevox.ros2.messages import profile
from tf2_msgs.msg import TFMessage

IMAGE_QOS = QoSProfile(depth=5, reliability=ReliabilityPolicy.BEST_EFFORT)
RELIABLE = QoSProfile(depth=100, reliability=ReliabilityPolicy.RELIABLE)
SAID, ECHOED = "said", "echoed"
"""The topics of the plain node that answers each message with the same."""
STATE_QOS = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)


@contextmanager
def listener(what: str, domain: str = "") -> Iterator[None]:
    """Have one that listens to `messages`, a `robot`, `images` or `diagnostics`, or an `echo`."""
    environment = {**os.environ, "ROS_DOMAIN_ID": domain or os.environ["ROS_DOMAIN_ID"]}
    with subprocess.Popen([sys.executable, __file__, what], env=environment) as process:
        try:
            yield
        finally:
            process.terminate()


def listen(what: str) -> None:
    """Be that process, until it is ended."""
    context = Context()
    context.init(domain_id=int(os.environ["ROS_DOMAIN_ID"]))
    node = Node("listener", namespace="/edgevox", context=context)
    if what == "echo":
        answers = node.create_publisher(String, ECHOED, RELIABLE)
        node.create_subscription(String, SAID, answers.publish, RELIABLE)
    topics: dict[str, list[tuple[Any, str, QoSProfile]]] = {
        "messages": [
            (String if row.type == STRING else Float32, row.topic, profile(row.qos))
            for row in PUBLISHED
        ],
        "robot": [
            (TFMessage, "/tf", QoSProfile(depth=100)),
            (String, "robot_state", STATE_QOS),
        ],
        "images": [(Image, "image_raw", IMAGE_QOS)],
        "diagnostics": [(DiagnosticArray, "/diagnostics", QoSProfile(depth=10))],
    }
    for kind, topic, qos in topics.get(what, ()):
        node.create_subscription(kind, topic, lambda _: None, qos, raw=True)
    executor = SingleThreadedExecutor(context=context)
    executor.add_node(node)
    try:
        executor.spin()
    except (ExternalShutdownException, KeyboardInterrupt):
        return


if __name__ == "__main__":
    listen(sys.argv[1])
