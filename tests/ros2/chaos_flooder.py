"""A peer that joins, floods one input of the node, named by its argument, until it is killed."""

import itertools
import math
import random
import sys
import time

import rclpy
from geometry_msgs.msg import PoseStamped, Twist
from rcl_interfaces.srv import SetParameters
from rclpy.action import ActionClient
from rclpy.parameter import Parameter
from std_msgs.msg import String

from edgevox_msgs.action import ExecuteSkill

PAUSE_S = 0.0005
ROOMS = ("kitchen", "bedroom", "office", "moon")


def strings(node, topic, texts):
    publisher = node.create_publisher(String, f"/edgevox/{topic}", 10)
    return lambda number: publisher.publish(String(data=texts[number % len(texts)]))


def velocities(node):
    publisher = node.create_publisher(Twist, "/edgevox/cmd_vel", 10)

    def send(number):
        message = Twist()
        message.linear.x = (0.2, math.nan, -0.2, math.inf)[number % 4]
        message.angular.z = random.uniform(-1, 1)
        publisher.publish(message)

    return send


def poses(node):
    publisher = node.create_publisher(PoseStamped, "/edgevox/goal_pose", 10)

    def send(number):
        message = PoseStamped()
        message.header.frame_id = ("map", "base_link", "moon")[number % 3]
        message.pose.position.x = random.uniform(-1, 9)
        message.pose.position.y = random.uniform(-1, 7)
        message.pose.orientation.w = 1.0
        publisher.publish(message)

    return send


def goals(node):
    client = ActionClient(node, ExecuteSkill, "/edgevox/execute_skill")

    def send(number):
        room = ROOMS[number % len(ROOMS)]
        goal = ExecuteSkill.Goal(skill_name="navigate_to", arguments_json=f'{{"room": "{room}"}}')
        client.send_goal_async(goal)
        rclpy.spin_once(node, timeout_sec=0)

    return send


def parameters(node):
    client = node.create_client(SetParameters, "/edgevox/edgevox/set_parameters")
    values = [
        Parameter("muted", value=True),
        Parameter("muted", value=False),
        Parameter("language", value="xx"),
        Parameter("voice", value=7),
        Parameter("nowhere", value="x"),
    ]

    def send(number):
        one = values[number % len(values)].to_parameter_msg()
        client.call_async(SetParameters.Request(parameters=[one]))
        rclpy.spin_once(node, timeout_sec=0)

    return send


KINDS = {
    "text": lambda node: strings(node, "text_input", ("where are you", "blah", "go to the office")),
    "interrupt": lambda node: strings(node, "interrupt", ("",)),
    "language": lambda node: strings(node, "set_language", ("fr", "en", "xx", "de")),
    "velocity": velocities,
    "goal_pose": poses,
    "goals": goals,
    "parameters": parameters,
}

if __name__ == "__main__":
    rclpy.init()
    flooder = rclpy.create_node("flooder")
    flood = KINDS[sys.argv[1]](flooder)
    time.sleep(0.5)
    for count in itertools.count():
        flood(count)
        time.sleep(PAUSE_S)
