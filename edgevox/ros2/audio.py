"""A microphone on the wire: the topic `audio_in` fills a source of sound.

A loudspeaker on the wire: speech goes out on the topic `audio_out`.
"""

from array import array
from collections import Counter
from collections.abc import Mapping

import numpy as np
from rclpy.node import Node

from edgevox.core.clock import Clock, SystemClock
from edgevox.core.errors import Refusal
from edgevox.core.log import get_logger
from edgevox.ros2.messages import profile
from edgevox.ros2.standard_topics import AUDIO_IN, AUDIO_OUT
from edgevox.voice.audio import RATE_HZ, Samples
from edgevox.voice.sinks.paced import Relay
from edgevox.voice.sources.pushed import FormCheck, Pushed
from edgevox_msgs.msg import AudioData

log = get_logger(__name__)


TOPIC_OUT = AUDIO_OUT.topic


class AudioOut:
    """Publishes speech on a node, in its namespace, reliably; silence is not published.

    Messages are `edgevox_msgs/msg/AudioData`: 16 kHz, mono, 16 bit little-endian, of at most 40 ms.
    They come at the pace of speech, 60 ms before they are due. A player should start with the first
    message and buffer no more than those 60 ms; then it falls silent that soon after an
    interruption.
    """

    def __init__(self, node: Node, relay: Relay) -> None:
        self._relay = relay
        self._publisher = node.create_publisher(AudioData, TOPIC_OUT, profile(AUDIO_OUT.qos))
        relay.name = node.resolve_topic_name(TOPIC_OUT)
        relay.connect(self._publish)

    def close(self) -> None:
        """Stop publishing, before the node is destroyed: later speech goes nowhere."""
        self._relay.close()

    def _publish(self, samples: Samples) -> None:
        message = AudioData()
        message.data = array("B", samples.astype("<i2").tobytes())
        self._publisher.publish(message)


TOPIC_IN = AUDIO_IN.topic
SAMPLE_BYTES = 2
MAX_BYTES = SAMPLE_BYTES * RATE_HZ
"""One second. A longer message is refused: it would be heard late."""
WAITING = 200
"""Messages that may wait for a busy processor: 2 s of 10 ms each, as much as waits in `Pushed`."""


class AudioIn:
    """Subscribes to a microphone's topic, best effort; the callback only queues.

    Messages are `edgevox_msgs/msg/AudioData`: 16 kHz, mono, 16 bit little-endian. A message that is
    empty, cut within a sample or longer than a second is refused, counted, logged and told. Sound
    of another form is told after `WINDOW_S`.
    """

    def __init__(self, node: Node, source: Pushed, clock: Clock | None = None) -> None:
        self._source = source
        self._clock, self._form = clock or SystemClock(), FormCheck()
        self.refused: Counter[Refusal] = Counter({Refusal.INVALID: 0, Refusal.TOO_LONG: 0})
        self._node = node
        self._subscription = node.create_subscription(
            AudioData, TOPIC_IN, self._hear, profile(AUDIO_IN.qos, at_least=WAITING)
        )
        source.name = node.resolve_topic_name(TOPIC_IN)

    @property
    def refusals(self) -> Mapping[tuple[str, ...], int]:
        """The number of messages that were refused, by topic and reason."""
        return {(TOPIC_IN, reason): count for reason, count in self.refused.items()}

    def _judge(self, samples: Samples) -> None:
        """Tell once that sound of another form comes."""
        doubt = self._form.judge(samples, self._clock.now())
        if doubt and not self._source.doubt:
            log.warning("sound_odd", topic=self._source.name, reason=doubt)
        self._source.doubt = self._source.doubt if doubt is None else doubt

    def close(self) -> None:
        """Hear nothing more."""
        self._node.destroy_subscription(self._subscription)

    def _hear(self, message: AudioData) -> None:
        size = len(message.data)
        if 0 < size <= MAX_BYTES and size % SAMPLE_BYTES == 0:
            samples = np.frombuffer(message.data, "<i2").astype(np.int16)
            self._judge(samples)
            self._source.push(samples)
            return
        reason = Refusal.TOO_LONG if size > MAX_BYTES else Refusal.INVALID
        self.refused[reason] += 1
        expected = f"16 bit samples, 1 to {MAX_BYTES} bytes"
        self._source.doubt = f"a message of {size} bytes was refused; expected {expected}"
        log.warning(
            "sound_refused",
            topic=self._source.name,
            reason=reason,
            bytes=size,
            expected=expected,
        )
