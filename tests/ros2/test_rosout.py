"""What waits for somebody who listens to /rosout, in a process of the test's own."""

import pytest
from held_ticks import HeldTime
from rcl_interfaces.msg import Log
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from waiting import wait_until

from edgevox.core.log import get_logger
from edgevox.ros2.logs import LIFESPAN_S, PERIOD_S, Rosout
from edgevox.ros2.node import RosNode

log = get_logger("edgevox.test")
LATE = QoSProfile(
    depth=1000,
    reliability=ReliabilityPolicy.RELIABLE,
    durability=DurabilityPolicy.TRANSIENT_LOCAL,
)


@pytest.fixture
def time():
    return HeldTime()


@pytest.fixture
def rosout(domain, time, monkeypatch):
    monkeypatch.setenv("ROS_DOMAIN_ID", str(domain))
    ros = RosNode("/edgevox", ("--ros-args", "--disable-rosout-logs"))
    ticker = time.ticker("rosout")
    one = Rosout(ros.node, ticker, time)
    ros.start()
    ticker.start()
    yield one
    one.close()
    ticker.close()
    ros.close()


def listens(peer, rosout):
    """Somebody who is known to the one that publishes: what was heard."""
    heard = []
    one = peer()
    one.node.create_subscription(Log, "/rosout", heard.append, LATE)
    wait_until(lambda: rosout.listeners > 0, "that it knows of the subscription")
    return heard


def texts(heard):
    return [one.msg for one in list(heard)]


def test_who_comes_late_hears_what_was_said_in_the_last_ten_seconds(rosout, time, peer):
    log.warning("long_ago")
    time.advance(LIFESPAN_S - 1.0)
    log.warning("lately", number=7)
    time.advance(2.0)
    heard = listens(peer, rosout)

    time.advance(PERIOD_S)
    wait_until(lambda: len(heard) == 1, "what was said lately")
    log.error("now")
    time.advance(PERIOD_S)

    wait_until(lambda: len(heard) == 2, "what is said now")
    assert texts(heard) == ["lately number=7", "now"]


def test_of_too_many_that_wait_the_oldest_are_dropped(rosout, time, peer):
    for number in range(1200):
        log.error(f"event_{number}")
    heard = listens(peer, rosout)

    time.advance(PERIOD_S)

    wait_until(lambda: len(heard) == 1000, "as many as the topic keeps")
    assert texts(heard)[0] == "event_200"
