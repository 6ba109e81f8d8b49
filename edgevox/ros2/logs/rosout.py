"""Our lines on ``/rosout``, where ``rqt_console`` and the like look for them."""

import logging
from collections import deque

from builtin_interfaces.msg import Time
from rcl_interfaces.msg import Log
from rclpy.duration import Duration
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy

from edgevox.core.log import ROOT
from edgevox.ops.logs import RateLimit
from edgevox.ros2.logs.rcutils import OF_RCUTILS
from edgevox.ros2.ticker import Ticker

TOPIC = "/rosout"
QOS = QoSProfile(
    depth=1000,
    reliability=ReliabilityPolicy.RELIABLE,
    durability=DurabilityPolicy.TRANSIENT_LOCAL,
    lifespan=Duration(seconds=10),
)
"""As ROS 2's own."""
PERIOD_S = 0.1
MOST_WAITING = 500


class Rosout(logging.Handler):
    """Publishes every line that our loggers show, but for what ROS 2 has published itself.

    Who logs only puts the line into a queue, which the ticker's thread empties: no line waits for
    the middleware, and none comes of a line. Of too many, the oldest are dropped. What people say
    is never in them.
    """

    def __init__(self, node: Node, ticker: Ticker) -> None:
        super().__init__()
        self._node, self._name = node, node.get_logger().name
        self._publisher = node.create_publisher(Log, TOPIC, QOS)
        self._waiting: deque[Log] = deque(maxlen=MOST_WAITING)
        self.addFilter(RateLimit())
        self._stop = ticker.every(PERIOD_S, self._publish)
        logging.getLogger(ROOT).addHandler(self)

    def emit(self, record: logging.LogRecord) -> None:
        """Queue it."""
        if not hasattr(record, OF_RCUTILS):
            self._waiting.append(_message(record, self._name))

    def close(self) -> None:
        """Publish what waits, and no more."""
        logging.getLogger(ROOT).removeHandler(self)
        self._stop()
        self._publish()
        self._node.destroy_publisher(self._publisher)
        super().close()

    def _publish(self) -> None:
        while self._waiting:
            self._publisher.publish(self._waiting.popleft())


def _message(record: logging.LogRecord, node: str) -> Log:
    """Under the node's name, as ROS 2 knows it, and that of our module."""
    second, part = divmod(record.created, 1.0)
    text = record.getMessage()
    if record.exc_info and record.exc_info[1]:
        text += f": {type(record.exc_info[1]).__name__}: {record.exc_info[1]}"
    return Log(
        stamp=Time(sec=int(second), nanosec=int(part * 1e9)),
        level=record.levelno,
        name=node + record.name.removeprefix(ROOT),
        msg=text,
        file=record.pathname,
        function=record.funcName or "",
        line=record.lineno,
    )
