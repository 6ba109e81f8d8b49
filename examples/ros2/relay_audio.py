"""Connect the robot's microphone and speaker nodes, such as those of audio_common.

``python3 relay_audio.py --microphone /audio/audio --speaker /play/audio`` copies sound to
``audio_in`` and from ``audio_out``, until Ctrl-C. Any type with a field ``uint8[] data`` works,
if it holds 16 bit little-endian samples, mono, at 16000 Hz, without a header.
"""

import argparse
from importlib import import_module

import rclpy
from rclpy.qos import qos_profile_sensor_data

SOUND = "edgevox_msgs/msg/AudioData"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--microphone", metavar="TOPIC", help="where the microphone node publishes")
    parser.add_argument("--speaker", metavar="TOPIC", help="where the speaker node listens")
    parser.add_argument("--type", default="audio_common_msgs/msg/AudioData", help="of these topics")
    parser.add_argument("--namespace", default="/edgevox", help="where the robot's topics are")
    arguments = parser.parse_args()

    rclpy.init()  # Ctrl-C shuts it down; doing it here as well would race with that
    try:
        node = rclpy.create_node("relay_audio", namespace=arguments.namespace)
        theirs, ours = message_type(arguments.type), message_type(SOUND)
        if arguments.microphone:  # best effort: a lost piece of sound is not worth waiting for
            hears, best_effort = arguments.microphone, qos_profile_sensor_data
            relay(node, (theirs, hears), (ours, "audio_in"), best_effort)
        if arguments.speaker:
            relay(node, (ours, "audio_out"), (theirs, arguments.speaker), 10)
        while rclpy.ok():
            rclpy.spin_once(node, timeout_sec=1.0)  # Ctrl-C may not wake a wait without a timeout
    except KeyboardInterrupt:
        pass
    except Exception:
        if rclpy.ok():  # otherwise Ctrl-C interrupted a call, which may raise anything
            raise


def relay(node, source, target, qos) -> None:
    publisher = node.create_publisher(*target, qos)
    kind = target[0]
    node.create_subscription(*source, lambda m: publisher.publish(kind(data=m.data)), qos)


def message_type(name: str) -> type:
    package, _, kind = name.partition("/msg/")
    return getattr(import_module(f"{package}.msg"), kind)


if __name__ == "__main__":
    main()
