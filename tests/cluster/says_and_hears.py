"""Runs in a pod beside a robot: says a sentence to it, and prints all that it answers and does."""

import os
import sys

import rclpy
from rclpy.node import Node
from std_msgs.msg import String

SAY_AGAIN_S = 5.0
heard = []


def told(message: String) -> None:
    heard.append(message.data)
    sys.stdout.write(f"{message.data}\n")
    sys.stdout.flush()


rclpy.init()
node = Node("operator")
robot = os.environ["ROBOT"]
node.create_subscription(String, f"{robot}/response", told, 100)
node.create_subscription(String, f"{robot}/agent_event", told, 100)
words = node.create_publisher(String, f"{robot}/text_input", 10)


def say() -> None:
    """Until something is heard: who is matched on this side may not have matched this one yet."""
    if not heard and words.get_subscription_count():
        words.publish(String(data=os.environ["SAY"]))


node.create_timer(SAY_AGAIN_S, say)
rclpy.spin(node)
