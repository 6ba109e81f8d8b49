"""A loudspeaker on the wire: speech goes out on the topic `audio_out`."""

from array import array

from rclpy.node import Node

from edgevox.ros2.qos import profile
from edgevox.ros2.standard_topics import AUDIO_OUT
from edgevox.voice.audio import Samples
from edgevox.voice.sinks.relay import Relay
from edgevox_msgs.msg import AudioData

TOPIC = AUDIO_OUT.topic


class AudioOut:
    """Publishes on a node, in its namespace, reliably; nothing while nobody speaks.

    Messages are `edgevox_msgs/msg/AudioData`: 16 kHz, mono, 16 bit little-endian, of at most 40 ms.
    They come at the pace of speech, 60 ms before they are due: whoever plays them should start with
    the first, wait for no more than that, and so is silent that soon after an interruption.
    """

    def __init__(self, node: Node, relay: Relay) -> None:
        self._relay = relay
        self._publisher = node.create_publisher(AudioData, TOPIC, profile(AUDIO_OUT.qos))
        relay.name = node.resolve_topic_name(TOPIC)
        relay.connect(self._publish)

    def close(self) -> None:
        """To be called before the node is destroyed: what is spoken later goes nowhere."""
        self._relay.close()

    def _publish(self, samples: Samples) -> None:
        message = AudioData()
        message.data = array("B", samples.astype("<i2").tobytes())
        self._publisher.publish(message)
