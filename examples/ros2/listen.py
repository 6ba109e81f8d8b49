"""Print what the robot publishes on one of its topics, until Ctrl-C: ``python3 listen.py TOPIC``.

transcription    what it hears
bot_sentence     what it says
wakeword         the wake word, the moment it is heard: a robot could turn its head
"""

import argparse

import rclpy
from std_msgs.msg import String


def main() -> None:
    form = argparse.RawDescriptionHelpFormatter
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=form)
    parser.add_argument("topic", help="its name, within the namespace")
    parser.add_argument("--namespace", default="/edgevox", help="where the robot's topics are")
    arguments = parser.parse_args()

    rclpy.init()  # Ctrl-C shuts it down; to do so here, too, would race with that
    try:
        node = rclpy.create_node("listen", namespace=arguments.namespace)
        node.create_subscription(String, arguments.topic, react, 10)
        while rclpy.ok():
            rclpy.spin_once(node, timeout_sec=1.0)  # Ctrl-C may not wake one that waits for ever
    except KeyboardInterrupt:
        pass
    except Exception:
        if rclpy.ok():  # else Ctrl-C came in the midst of something, which may raise what it likes
            raise


def react(message: String) -> None:
    print(message.data, flush=True)


if __name__ == "__main__":
    main()
