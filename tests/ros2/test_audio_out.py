"""Speech on the wire, as another node hears it."""

import threading

import numpy as np
import pytest
from interop_rig import Messages
from peer import RELIABLE, Peer
from waiting import wait_until

from edgevox.core.cancel import CancelToken
from edgevox.ros2.audio import AudioOut
from edgevox.ros2.node import RosNode
from edgevox.voice.audio import Chunk
from edgevox.voice.sinks import open_sink
from edgevox.voice.sinks.paced import Relay
from edgevox_msgs.msg import AudioData

TOPIC = "/edgevox/audio_out"


@pytest.fixture
def heard(peer) -> tuple[Peer, Messages]:
    other, messages = peer(), Messages()
    other.node.create_subscription(AudioData, TOPIC, messages.add, RELIABLE)
    return other, messages


@pytest.fixture
def sink(domain, monkeypatch, heard):
    monkeypatch.setenv("ROS_DOMAIN_ID", str(domain))
    relay = Relay()
    ros = RosNode("/edgevox", ())
    audio = AudioOut(ros.node, relay)
    ros.start()
    other, _ = heard
    (speech,) = (one for one in ros.node.publishers if one.topic_name == TOPIC)
    wait_until(
        lambda: other.node.count_publishers(TOPIC) and speech.get_subscription_count(),
        "a listener for the speech",
    )
    sink = open_sink("ros2", relay=relay)
    yield sink
    sink.close()
    audio.close()
    ros.close()


def test_speech_arrives_whole_in_short_blocks_at_16_khz(sink, heard):
    _, messages = heard
    ramp = np.arange(8000, dtype=np.int16)
    sink.play(Chunk(ramp, 16_000), CancelToken())
    sink.drain(CancelToken())
    messages.wait_for(lambda one: sum(len(m.data) for m in messages.messages) == 16_000)
    assert max(len(one.data) for one in messages.messages) <= 2 * 640
    data = b"".join(bytes(one.data) for one in messages.messages)
    assert np.array_equal(np.frombuffer(data, "<i2"), ramp)


def test_after_a_stop_nothing_more_is_sent(sink, heard):
    _, messages = heard
    token = CancelToken()
    playing = threading.Thread(
        target=lambda: sink.play(Chunk(np.ones(160_000, np.int16), 16_000), token)
    )
    playing.start()
    messages.wait_for(lambda one: len(messages.messages) >= 3)
    token.cancel()
    playing.join()
    unplayed_s = sink.stop()
    sent = sum(len(one.data) for one in messages.messages) / 32_000
    assert unplayed_s > 5.0
    sink.play(Chunk(np.full(16, 7, np.int16), 16_000), CancelToken())
    messages.wait_for(lambda one: one.data[0] == 7)
    assert sum(len(one.data) for one in messages.messages) / 32_000 < sent + 0.5
