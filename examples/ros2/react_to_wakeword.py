"""Do something the moment the robot hears its wake word, until Ctrl-C.

This prints a line; a robot would turn its head or switch on a light.
"""

import argparse

import rclpy
from std_msgs.msg import String


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--namespace", default="/edgevox", help="where the robot's topics are")
    arguments = parser.parse_args()

    rclpy.init()  # Ctrl-C shuts it down; to do so here, too, would race with that
    try:
        node = rclpy.create_node("react_to_wakeword", namespace=arguments.namespace)
        node.create_subscription(String, "wakeword", react, 10)
        while rclpy.ok():
            rclpy.spin_once(node, timeout_sec=1.0)  # Ctrl-C may not wake one that waits for ever
    except KeyboardInterrupt:
        pass
    except Exception:
        if rclpy.ok():  # else Ctrl-C came in the midst of something, which may raise what it likes
            raise


def react(phrase: String) -> None:
    print(f"Somebody said '{phrase.data}': I am all ears.", flush=True)


if __name__ == "__main__":
    main()
