"""Print what the robot hears, until Ctrl-C: ``python3 listen_transcriptions.py``."""

import argparse
import contextlib

import rclpy
from rclpy.executors import ExternalShutdownException
from std_msgs.msg import String


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--namespace", default="/edgevox", help="where the robot's topics are")
    arguments = parser.parse_args()

    rclpy.init()  # Ctrl-C shuts it down; to do so here, too, would race with that
    with contextlib.suppress(KeyboardInterrupt, ExternalShutdownException):
        node = rclpy.create_node("listen_transcriptions", namespace=arguments.namespace)
        node.create_subscription(String, "transcription", heard, 10)
        rclpy.spin(node)


def heard(message: String) -> None:
    print(message.data, flush=True)


if __name__ == "__main__":
    main()
