"""List the robot's voices, by its service: ``python3 query_voices.py``."""

import argparse
import json
import sys

import rclpy
from std_srvs.srv import Trigger

PATIENCE_S = 10.0


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--namespace", default="/edgevox", help="where the robot's services are")
    arguments = parser.parse_args()

    rclpy.init()
    try:
        node = rclpy.create_node("query_voices", namespace=arguments.namespace)
        client = node.create_client(Trigger, "list_voices")
        if not client.wait_for_service(timeout_sec=PATIENCE_S):
            print(f"Nobody offers {client.service_name}.", file=sys.stderr)
            return 1
        future = client.call_async(Trigger.Request())
        rclpy.spin_until_future_complete(node, future, timeout_sec=PATIENCE_S)
        if not future.done():
            print("No answer.", file=sys.stderr)
            return 1
        known = json.loads(future.result().message)
        print(f"language {known['language']}, voice {known['current_voice']!r}")
        for voice in known["voices"]:
            print(voice)
    finally:
        rclpy.try_shutdown()
    return 0


if __name__ == "__main__":
    sys.exit(main())
