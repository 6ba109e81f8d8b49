"""Switch the voice: ``python3 switch_voice.py af_bella``; query_voices.py lists the voices."""

import argparse
import sys
import time

import rclpy
from rclpy.duration import Duration
from std_msgs.msg import String

PATIENCE_S = 10.0


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("voice", help="name of a text-to-speech voice")
    parser.add_argument("--namespace", default="/edgevox", help="where the robot's topics are")
    arguments = parser.parse_args()

    rclpy.init()
    try:
        node = rclpy.create_node("switch_voice", namespace=arguments.namespace)
        publisher = node.create_publisher(String, "set_voice", 10)
        deadline = time.monotonic() + PATIENCE_S
        while publisher.get_subscription_count() == 0:
            if time.monotonic() > deadline:
                print(f"Nobody listens on {publisher.topic_name}.", file=sys.stderr)
                return 1
            time.sleep(0.05)
        publisher.publish(String(data=arguments.voice))
        publisher.wait_for_all_acked(Duration(seconds=PATIENCE_S))
    finally:
        rclpy.try_shutdown()
    return 0


if __name__ == "__main__":
    sys.exit(main())
