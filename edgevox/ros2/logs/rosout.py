"""Our lines on ``/rosout``, where ``rqt_console`` and the like look for them."""

import logging
from collections import deque
from copy import copy
from typing import NamedTuple

from builtin_interfaces.msg import Time
from rcl_interfaces.msg import Log
from rclpy.duration import Duration
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy

from edgevox.core.clock import Clock, SystemClock
from edgevox.core.log import ROOT, LogLine
from edgevox.core.text import one_line
from edgevox.ops.logs import RateLimit
from edgevox.ros2.logs.rcutils import OF_RCUTILS
from edgevox.ros2.ticker import Ticker

TOPIC = "/rosout"
LIFESPAN_S = 10.0
MOST_WAITING = 1000
QOS = QoSProfile(
    depth=MOST_WAITING,
    reliability=ReliabilityPolicy.RELIABLE,
    durability=DurabilityPolicy.TRANSIENT_LOCAL,
    lifespan=Duration(seconds=LIFESPAN_S),
)
"""As ROS 2's own."""
PERIOD_S = 0.1


class _KeptRecord(NamedTuple):
    """A record that waits since `since_s`, its text not yet written if it is one of ours.

    What could keep others' things alive, such as a traceback its frames, is written at once.
    """

    since_s: float
    record: logging.LogRecord


class Rosout(logging.Handler):
    """Publishes every line that our loggers show, but for what ROS 2 has published itself.

    Who logs only puts the line into a queue, which the ticker's thread empties: no line waits for
    the middleware, and none comes of a line. While nobody listens, lines wait there as long as the
    topic would keep them, and no message is made. Of too many, the oldest are dropped. What people
    say is never in them.
    """

    def __init__(self, node: Node, ticker: Ticker, clock: Clock | None = None) -> None:
        super().__init__()
        self._clock = clock or SystemClock()
        self._node, self._name = node, node.get_logger().name
        self._publisher = node.create_publisher(Log, TOPIC, QOS)
        self._waiting: deque[_KeptRecord] = deque(maxlen=MOST_WAITING)
        self.addFilter(RateLimit())
        self._stop = ticker.every(PERIOD_S, self._publish)
        logging.getLogger(ROOT).addHandler(self)

    def emit(self, record: logging.LogRecord) -> None:
        """Queue it."""
        if not hasattr(record, OF_RCUTILS):
            self._waiting.append(_kept(record, self._clock.now()))

    @property
    def listeners(self) -> int:
        """How many subscriptions its publisher knows of."""
        return self._publisher.get_subscription_count()

    def close(self) -> None:
        """Publish what waits, and no more."""
        logging.getLogger(ROOT).removeHandler(self)
        self._stop()
        self._publish()
        self._waiting.clear()  # logging closes every handler again when the program ends
        self._node.destroy_publisher(self._publisher)
        super().close()

    def _publish(self) -> None:
        oldest_s = self._clock.now() - LIFESPAN_S
        while self._waiting and self._waiting[0].since_s < oldest_s:
            self._waiting.popleft()
        if self._waiting and self.listeners:
            while self._waiting:
                self._publisher.publish(_message(self._waiting.popleft().record, self._name))


def _kept(record: logging.LogRecord, now_s: float) -> _KeptRecord:
    if isinstance(record.msg, LogLine) and not record.exc_info:
        return _KeptRecord(now_s, record)
    text = record.getMessage()
    if record.exc_info and record.exc_info[1]:
        text += f": {type(record.exc_info[1]).__name__}: {record.exc_info[1]}"
    bare = copy(record)
    bare.msg, bare.args, bare.exc_info = text, (), None
    return _KeptRecord(now_s, bare)


def _message(record: logging.LogRecord, node: str) -> Log:
    """Under the node's name, as ROS 2 knows it, and that of our module."""
    second, part = divmod(record.created, 1.0)
    return Log(
        stamp=Time(sec=int(second), nanosec=int(part * 1e9)),
        level=record.levelno,
        name=node + record.name.removeprefix(ROOT),
        msg=one_line(record.getMessage()),
        file=record.pathname,
        function=record.funcName or "",
        line=record.lineno,
    )
