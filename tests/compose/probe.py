"""Runs inside a container, by stdin: subscribes to topics, may say something, tells what it heard.

Usage: python3 - SECONDS TOPIC[=TEXT] ... [--say TOPIC=WORDS]
It ends when every topic was heard (with its text in it, if one is given) or the seconds are over,
and writes how many messages of each came and whether the text did, as JSON.
"""

import json
import sys
import time

import rclpy
from rclpy.node import Node
from rclpy.qos import QoSProfile
from std_msgs.msg import String

arguments = sys.argv[1:]
said = arguments[arguments.index("--say") + 1] if "--say" in arguments else ""
asked = arguments[1 : arguments.index("--say")] if said else arguments[1:]
wanted = {topic: text for topic, _, text in (one.partition("=") for one in asked)}
count = dict.fromkeys(wanted, 0)
found = dict.fromkeys(wanted, False)


def listen(node: Node, topic: str) -> None:
    def hear(message: String) -> None:
        count[topic] += 1
        found[topic] |= wanted[topic] in message.data

    node.create_subscription(String, topic, hear, QoSProfile(depth=10))


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
executor = rclpy.executors.SingleThreadedExecutor()
executor.add_node(node)
while not all(found.values()) and time.monotonic() < deadline:
    executor.spin_once(timeout_sec=0.1)
sys.stdout.write(json.dumps({"count": count, "found": found}) + "\n")
executor.shutdown()
node.destroy_node()
rclpy.shutdown()
