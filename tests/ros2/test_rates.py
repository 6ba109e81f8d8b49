"""Everything that the contract promises at a rate comes at that rate, on the wire.

The test holds the time by which a whole bridge ticks: in so many seconds of it exactly so many
messages reach a peer, on whatever machine. What a machine makes of it in real time is measured by
`benchmarks/wire/ros2.py`.
"""

import importlib
import json
import math
import time

import numpy as np
import pytest
from held_ticks import HeldTime
from interop_rig import hear
from peer import STATE, Peer
from rclpy.qos import QoSProfile
from waiting import wait_until

from edgevox.core.bus import Bus
from edgevox.core.controls import Controls
from edgevox.core.settings import Settings
from edgevox.core.status import Components
from edgevox.robots.capabilities import (
    CameraImage,
    CameraSpec,
    LidarScan,
    Pose2D,
    Twist2D,
)
from edgevox.ros2.bridge import RosBridge
from edgevox.ros2.contract import QUERIES, RATED
from edgevox.ros2.open import BridgeContext

HELD_S = 2


class Equipped:
    """A body with all that goes out at a rate; its time is the one that is held."""

    name = "equipped"
    skills = ()
    camera_spec = CameraSpec(4, 3, math.pi / 2)

    def __init__(self, held):
        self._held = held

    @property
    def time_s(self):
        return self._held.now()

    def state(self):
        return {"time": self.time_s}

    def halt(self, reason):
        return False

    def reset(self):
        """It is always as it was at the start."""

    def start(self):
        """It does nothing by itself."""

    def close(self):
        """It has nothing to end."""

    def pose(self):
        return Pose2D(self.time_s, 0.0, 0.0)

    def velocity(self):
        return Twist2D(1.0, 0.0)

    def scan(self):
        return LidarScan(self.time_s, 0.0, 0.1, 0.1, 5.0, np.ones(3, np.float32))

    def camera(self):
        return CameraImage(self.time_s, np.zeros((3, 4, 3), np.uint8))


@pytest.fixture(scope="module")
def rig(domain):
    """A held time, and a peer of the bridge that ticks by it."""
    held, bus = HeldTime(), Bus()
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("ROS_DOMAIN_ID", str(domain))
        bridge = RosBridge(
            BridgeContext(
                settings=Settings(publish_clock=True),
                bus=bus,
                submit=lambda _: None,
                controls=Controls(bus, language="en", voices=lambda _: ()),
                queries=dict.fromkeys(QUERIES, dict),
                body=Equipped(held),
                components=Components(),
            ),
            tickers=held.ticker,
        )
        bridge.start()
        peer = Peer(domain)
        presence = peer.listen("presence", STATE)

        def settled():  # which it says at once, between two beats
            held.advance(1.0)
            return any(json.loads(claim)["term"] for claim in list(presence.messages))

        wait_until(settled, "an agent that has been here alone")
        yield held, peer
        peer.close()
        bridge.close()


@pytest.mark.parametrize("row", RATED, ids=lambda row: row.topic.strip("/"))
def test_so_many_messages_come_in_a_held_second_as_the_contract_says(rig, row):
    held, peer = rig
    heard = hear_all(peer, row)
    wait_until(lambda: held.advance(1.0) or heard.messages, "a first message: both ends know")

    begun_ns = [next_message(held, heard, 1.0 / row.rate_hz) for _ in range(steps(row))]
    ended_ns = next_message(held, heard, 1.0)  # what came before it on its topic is here by now

    sent_ns = [one for one in heard.sent_ns if begun_ns[0] <= one < ended_ns]
    edges_ns = [*begun_ns, ended_ns]
    a_step, _ = np.histogram(sent_ns, edges_ns)
    assert a_step.tolist() == [1] * steps(row)


def test_what_a_scan_says_of_its_rate_is_its_rate(rig):
    held, peer = rig
    (row,) = (one for one in RATED if one.topic == "scan")
    heard = hear_all(peer, row)
    wait_until(lambda: held.advance(1.0) or heard.messages, "a scan")
    assert heard.messages[0].scan_time == pytest.approx(1.0 / row.rate_hz)


def steps(row):
    number = HELD_S * row.rate_hz
    assert number.is_integer()
    return int(number)


def hear_all(peer, row):
    package, _, name = row.type.split("/")
    kind = getattr(importlib.import_module(f"{package}.msg"), name)
    topic = row.topic if row.topic.startswith("/") else f"/edgevox/{row.topic}"
    wait_until(lambda: peer.node.count_publishers(topic) == 1, topic)
    (publisher,) = peer.node.get_publishers_info_by_topic(topic)
    reliability = publisher.qos_profile.reliability
    return hear(peer, kind, topic, QoSProfile(depth=100, reliability=reliability))


def next_message(held, heard, seconds):
    """Let so much time pass, and wait for a message that was sent in it; when that began."""
    begun_ns = time.time_ns()
    held.advance(seconds)
    heard.wait_until(lambda: heard.sent_ns[-1] >= begun_ns)
    return begun_ns
