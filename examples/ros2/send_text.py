"""Tell the robot something, and print its answer: ``python3 send_text.py "where are you"``."""

import argparse
import sys
import time

import rclpy
from rclpy.task import Future
from std_msgs.msg import String

PATIENCE_S = 10.0
ANSWER_S = 60.0


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("text", help="what to say to the robot")
    parser.add_argument("--namespace", default="/edgevox", help="where the robot's topics are")
    arguments = parser.parse_args()

    rclpy.init()
    try:
        node = rclpy.create_node("send_text", namespace=arguments.namespace)
        answer = Future()
        node.create_subscription(String, "response", lambda m: answer.set_result(m.data), 10)
        publisher = node.create_publisher(String, "text_input", 10)
        deadline = time.monotonic() + PATIENCE_S
        while publisher.get_subscription_count() == 0 or node.count_publishers("response") == 0:
            if time.monotonic() > deadline:
                print(f"Nobody listens on {publisher.topic_name}.", file=sys.stderr)
                return 1
            time.sleep(0.05)
        publisher.publish(String(data=arguments.text))
        rclpy.spin_until_future_complete(node, answer, timeout_sec=ANSWER_S)
        print(answer.result() if answer.done() else "No answer.")
    finally:
        rclpy.try_shutdown()
    return 0 if answer.done() else 1


if __name__ == "__main__":
    sys.exit(main())
