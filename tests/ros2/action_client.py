"""A program that starts one goal of `execute_skill`, says so, and waits to be killed."""

import sys

import rclpy
from rclpy.action import ActionClient

from edgevox_msgs.action import ExecuteSkill

rclpy.init()
node = rclpy.create_node("short_lived")
client = ActionClient(node, ExecuteSkill, sys.argv[1])
client.wait_for_server()
sent = client.send_goal_async(ExecuteSkill.Goal(skill_name=sys.argv[2], arguments_json=sys.argv[3]))
rclpy.spin_until_future_complete(node, sent)
result = sent.result().get_result_async()
sys.stdout.write("accepted\n")
sys.stdout.flush()
rclpy.spin_until_future_complete(node, result)
