"""Switch the language by the node's parameter, and print the reason if that fails.

``python3 switch_language_parameter.py fr``, or ``ros2 param set /edgevox/edgevox language fr``.
"""

import argparse
import sys

import rclpy
from rclpy.parameter import Parameter
from rclpy.parameter_client import AsyncParameterClient

PATIENCE_S = 10.0


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("language", help="ISO 639-1 code")
    parser.add_argument("--namespace", default="/edgevox", help="where the robot's node is")
    arguments = parser.parse_args()

    rclpy.init()
    try:
        node = rclpy.create_node("switch_language", namespace=arguments.namespace)
        client = AsyncParameterClient(node, "edgevox")
        if not client.wait_for_services(timeout_sec=PATIENCE_S):
            print(f"There is no node edgevox in {arguments.namespace}.", file=sys.stderr)
            return 1
        language = Parameter("language", value=arguments.language)
        future = client.set_parameters([language])
        rclpy.spin_until_future_complete(node, future, timeout_sec=PATIENCE_S)
        if not future.done():
            print("No answer.", file=sys.stderr)
            return 1
        (result,) = future.result().results
    finally:
        rclpy.try_shutdown()
    if not result.successful:
        print(f"Refused: {result.reason}", file=sys.stderr)
        return 1
    print(f"The language is {arguments.language} now.")
    return 0


if __name__ == "__main__":
    sys.exit(main())
