"""Runs inside a container, by stdin: subscribes to topics, may say something, tells what it heard.

Usage: python3 - SECONDS TOPIC[#COUNT][=TEXT] ... [--say TOPIC=WORDS]
It ends when every topic was heard (with its text in it, if one is given), when all the topics with
a count were heard so often, or when the seconds are over. It writes how many messages of each came
and whether the text did, as JSON. What it says it says again every few seconds, until it ends: a
subscription may not know of a new publisher yet, and misses its first message.
"""

import json
import sys
import time

import rclpy
from rclpy.node import Node
from rclpy.qos import QoSProfile
from std_msgs.msg import String

SAYS_AGAIN_S = 5.0

arguments = sys.argv[1:]
said = arguments[arguments.index("--say") + 1] if "--say" in arguments else ""
asked = arguments[1 : arguments.index("--say")] if said else arguments[1:]
wanted, enough = {}, {}
for one in asked:
    listened, _, text = one.partition("=")
    topic, _, number = listened.partition("#")
    wanted[topic] = text
    if number:
        enough[topic] = int(number)
count = dict.fromkeys(wanted, 0)
found = dict.fromkeys(wanted, False)


def listen(node: Node, topic: str) -> None:
    def hear(message: String) -> None:
        count[topic] += 1
        found[topic] |= wanted[topic] in message.data

    node.create_subscription(String, topic, hear, QoSProfile(depth=10))


def over() -> bool:
    """Whether all was heard that it waits for."""
    if enough:
        return all(count[topic] >= number for topic, number in enough.items())
    return all(found.values())


rclpy.init()
node = rclpy.create_node("probe")
for topic in wanted:
    listen(node, topic)
deadline = time.monotonic() + float(arguments[0])
if said:
    topic, _, words = said.partition("=")
    publisher = node.create_publisher(String, topic, 10)
    while not publisher.get_subscription_count() and time.monotonic() < deadline:
        time.sleep(0.02)
    publisher.publish(String(data=words))
    node.create_timer(SAYS_AGAIN_S, lambda: publisher.publish(String(data=words)))
executor = rclpy.executors.SingleThreadedExecutor()
executor.add_node(node)
while not over() and time.monotonic() < deadline:
    executor.spin_once(timeout_sec=0.1)
sys.stdout.write(json.dumps({"count": count, "found": found}) + "\n")
executor.shutdown()
node.destroy_node()
rclpy.shutdown()
