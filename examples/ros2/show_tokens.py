"""Show answers piece by piece, as the model generates them, until Ctrl-C.

Tokens are published best effort, so a display may miss one. `response` has the whole answer.
"""

import argparse

import rclpy
from rclpy.qos import qos_profile_sensor_data
from std_msgs.msg import String


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--namespace", default="/edgevox", help="where the robot's topics are")
    arguments = parser.parse_args()

    rclpy.init()  # Ctrl-C shuts it down; to do so here, too, would race with that
    try:
        node = rclpy.create_node("show_tokens", namespace=arguments.namespace)
        node.create_subscription(String, "bot_token", show, qos_profile_sensor_data)
        node.create_subscription(String, "response", end_line, 10)
        while rclpy.ok():
            rclpy.spin_once(node, timeout_sec=1.0)  # Ctrl-C may not wake one that waits for ever
    except KeyboardInterrupt:
        pass
    except Exception:
        if rclpy.ok():  # else Ctrl-C came in the midst of something, which may raise what it likes
            raise


def show(token: String) -> None:
    print(token.data, end="", flush=True)


def end_line(_: String) -> None:
    print(flush=True)


if __name__ == "__main__":
    main()
