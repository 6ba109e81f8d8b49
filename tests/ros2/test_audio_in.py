"""A microphone node on the wire, and the source that it fills."""

import threading

import numpy as np
import pytest
from guards import HUNG_S
from peer import Peer
from rclpy.qos import QoSProfile, ReliabilityPolicy
from waiting import wait_until

from edgevox.ros2.audio import MAX_BYTES, AudioIn
from edgevox.voice.audio import FRAME_SAMPLES
from edgevox.voice.sources.pushed import Pushed
from edgevox_msgs.msg import AudioData


@pytest.fixture
def node(domain):
    peer = Peer(domain)
    yield peer.node
    peer.close()


@pytest.fixture
def robot(node):
    """A node that listens, and the source that it fills."""
    source = Pushed("audio_in")
    yield AudioIn(node, source), source
    source.close()


@pytest.fixture
def microphone(domain, node, robot):
    """A publisher that the robot knows, too: what comes from others is lost."""
    microphone = Peer(domain)
    qos = QoSProfile(depth=100, reliability=ReliabilityPolicy.BEST_EFFORT)
    publisher = microphone.node.create_publisher(AudioData, "audio_in", qos)
    wait_until(lambda: publisher.get_subscription_count() > 0, "audio_in")
    (listening,) = (one for one in node.subscriptions if one.topic_name.endswith("audio_in"))
    wait_until(lambda: listening.get_publisher_count() > 0, "the microphone")
    yield publisher
    microphone.close()


def test_what_a_microphone_node_publishes_is_heard_sample_by_sample(robot, microphone):
    _, source = robot
    sound = np.arange(-FRAME_SAMPLES, FRAME_SAMPLES, dtype="<i2")

    for piece in np.split(sound, 4):
        microphone.publish(AudioData(data=piece.tobytes()))
    frames = [source.read(10.0), source.read(10.0)]

    assert all(frames)
    assert np.array_equal(np.concatenate([frame.samples for frame in frames]), sound)


def test_sound_that_comes_while_the_processor_is_busy_is_heard_later(
    robot, microphone, monkeypatch
):
    _, source = robot
    busy, push = threading.Event(), source.push

    def pushed_later(samples: np.ndarray) -> None:
        busy.wait(HUNG_S)
        push(samples)

    monkeypatch.setattr(source, "push", pushed_later)
    sound = np.arange(40 * FRAME_SAMPLES, dtype="<i2")
    for piece in np.split(sound, 80):
        microphone.publish(AudioData(data=piece.tobytes()))
    busy.set()
    for piece in np.split(sound, 40):
        frame = source.read(HUNG_S)
        assert frame
        assert np.array_equal(frame.samples, piece)


@pytest.mark.parametrize("size", [0, 3, MAX_BYTES + 2])
def test_a_message_that_cannot_be_sound_is_refused_and_said(robot, microphone, size, caplog):
    audio_in, source = robot

    def refused() -> int:
        """Sound is sent with best effort: one message may be lost."""
        microphone.publish(AudioData(data=bytes(size)))
        return sum(audio_in.refusals.values())

    wait_until(refused, "refusal")

    assert source.read(0.0) is None
    reason = "too_long" if size > MAX_BYTES else "invalid"
    assert audio_in.refusals["audio_in", reason] == sum(audio_in.refusals.values())
    assert f"bytes={size}" in caplog.text
    assert source.doubt.startswith(f"a message of {size} bytes was refused")
