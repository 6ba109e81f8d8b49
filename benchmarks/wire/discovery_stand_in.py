"""One process with the endpoints of an agent, and nothing behind them.

    python benchmarks/wire/discovery_stand_in.py NUMBER ALL

Endpoints come as a line of JSON on stdin; at the next line it makes them, and writes the clock as
soon as its `/tf` has all the others' as subscriptions. Then it stays until it is ended.
"""

import importlib
import json
import sys
import time
from typing import Any

import rclpy
from rclpy.node import Node
from std_srvs.srv import Trigger

from tf2_msgs.msg import TFMessage

LOOK_EVERY_S = 0.01


def main(number: str, count: int) -> None:
    """Be that process."""
    endpoints = json.loads(sys.stdin.readline())
    types = {kind: _class(kind) for _, kind in endpoints["heard"] + endpoints["said"]}
    sys.stdout.write("ready\n")
    sys.stdout.flush()
    sys.stdin.readline()
    rclpy.init()
    node = Node("edgevox", namespace=f"/robot{number}")
    for topic, kind in endpoints["heard"]:
        node.create_subscription(types[kind], _own(topic), lambda _: None, 10)
    for topic, kind in endpoints["said"]:
        node.create_publisher(types[kind], _own(topic), 10)
    for index in range(endpoints["services"]):
        node.create_service(Trigger, f"~/service{index}", lambda _, answer: answer)
    node.create_subscription(TFMessage, "/tf", lambda _: None, 10)
    shared = node.create_publisher(TFMessage, "/tf", 10)
    while shared.get_subscription_count() < count:
        time.sleep(LOOK_EVERY_S)
    sys.stdout.write(f"{time.monotonic()}\n")
    sys.stdout.flush()
    rclpy.spin(node)


def _class(kind: str) -> Any:
    """Of a message, such as std_msgs/msg/String."""
    package, _, name = kind.split("/")
    return getattr(importlib.import_module(f"{package}.msg"), name)


def _own(topic: str) -> str:
    """The topic in the stand-in's namespace, if it was in the agent's."""
    return topic.removeprefix("/edgevox/")


if __name__ == "__main__":
    main(sys.argv[1], int(sys.argv[2]))
