"""A peer for floods: it asks for everything, reads nothing, and talks until it is killed."""

import itertools
import sys
import time

import rclpy
from rclpy.qos import QoSProfile
from std_msgs.msg import String

TOPICS = ("response", "agent_event", "bot_sentence", "bot_token", "state", "robot_state")

rclpy.init()
node = rclpy.create_node("deaf")
kept = [
    node.create_subscription(String, f"/edgevox/{topic}", lambda _: None, QoSProfile(depth=1))
    for topic in TOPICS
]
publisher = node.create_publisher(String, "/edgevox/text_input", QoSProfile(depth=1))
while not publisher.get_subscription_count():
    time.sleep(0.05)
sys.stdout.write("talking\n")
sys.stdout.flush()
for _ in itertools.count():
    publisher.publish(String(data="where are you"))
    time.sleep(0.001)
