"""Send the robot a text on one of its topics, once it listens: ``python3 publish.py TOPIC TEXT``.

tts_request "Dinner is ready."    speak
interrupt now                     stop what it says, thinks and does
set_language fr                   switch the language
set_voice af_bella                switch the voice; query_voices.py lists them
"""

import argparse
import sys
import time

import rclpy
from rclpy.duration import Duration
from std_msgs.msg import String

PATIENCE_S = 10.0


def main() -> int:
    form = argparse.RawDescriptionHelpFormatter
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=form)
    parser.add_argument("topic", help="its name, within the namespace")
    parser.add_argument("text", help="what to send")
    parser.add_argument("--namespace", default="/edgevox", help="where the robot's topics are")
    arguments = parser.parse_args()

    rclpy.init()
    try:
        node = rclpy.create_node("publish", namespace=arguments.namespace)
        publisher = node.create_publisher(String, arguments.topic, 10)
        deadline = time.monotonic() + PATIENCE_S
        while publisher.get_subscription_count() == 0:
            if time.monotonic() > deadline:
                print(f"Nobody listens on {publisher.topic_name}.", file=sys.stderr)
                return 1
            time.sleep(0.05)
        publisher.publish(String(data=arguments.text))
        publisher.wait_for_all_acked(Duration(seconds=PATIENCE_S))
    finally:
        rclpy.try_shutdown()
    return 0


if __name__ == "__main__":
    sys.exit(main())
