"""The example that connects other people's microphone and speaker nodes."""

import queue
import signal
import subprocess
import sys
from pathlib import Path

import pytest
from agent_process import HEARS_CTRL_C
from guards import HUNG_S
from peer import RELIABLE, SENSOR
from std_msgs.msg import UInt8MultiArray
from waiting import wait_until

from edgevox_msgs.msg import AudioData

RELAY = Path(__file__).resolve().parent.parent.parent / "examples" / "ros2" / "relay_audio.py"
SOUND = bytes(range(64))


@pytest.fixture
def relay(domain, monkeypatch):
    """The relay, between any sound and a type that only looks like it; ends on Ctrl-C."""
    monkeypatch.setenv("ROS_DOMAIN_ID", str(domain))
    arguments = ["--microphone=/mic", "--speaker=/speaker", "--type=std_msgs/msg/UInt8MultiArray"]
    process = subprocess.Popen([*HEARS_CTRL_C, sys.executable, RELAY, *arguments])
    yield process
    process.send_signal(signal.SIGINT)
    assert process.wait(HUNG_S) == 0


def carried(node, source, target, qos):
    """What arrives on the target of what was published on the source."""
    arrived = queue.SimpleQueue()
    node.create_subscription(*target, lambda message: arrived.put(bytes(message.data)), qos)
    publisher = node.create_publisher(*source, qos)
    wait_until(
        lambda: publisher.get_subscription_count() and node.count_publishers(target[1]), target[1]
    )
    for _ in range(20):  # best effort may lose the first
        publisher.publish(source[0](data=SOUND))
        try:
            return arrived.get(timeout=1.0)
        except queue.Empty:
            continue
    return None


@pytest.mark.usefixtures("relay")
def test_a_microphone_node_is_heard_and_a_speaker_node_speaks(peer):
    node = peer().node

    heard = carried(node, (UInt8MultiArray, "/mic"), (AudioData, "/edgevox/audio_in"), SENSOR)
    played = carried(
        node, (AudioData, "/edgevox/audio_out"), (UInt8MultiArray, "/speaker"), RELIABLE
    )

    assert heard == SOUND
    assert played == SOUND
