"""The node: its rclpy context, its name, and the thread that spins it."""

import logging
import math
import threading
from collections.abc import Sequence

from rclpy.clock import Clock
from rclpy.clock_type import ClockType
from rclpy.context import Context
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from rclpy.node import Node

from edgevox.core.errors import EdgeVoxError
from edgevox.core.heartbeat import Heartbeat
from edgevox.ros2.contract import NODE_NAME

log = logging.getLogger(__name__)

BEAT_S = 1.0
"""How often the executor gives a sign of life; each costs it about 1 ms."""


class RosBridgeFailed(EdgeVoxError):
    """ROS 2 is here but cannot be used; the message is its own reason."""


class RosNode:
    """Owns an rclpy node. One thread runs all of its callbacks, so none of them may block.

    Raises `RosBridgeFailed` where the context or the node cannot be made.
    """

    def __init__(
        self, namespace: str, ros_args: Sequence[str] = (), *, name: str = NODE_NAME
    ) -> None:
        self._context = Context()
        try:
            self._context.init(list(ros_args) or None)
            self.node = Node(
                name, namespace=namespace, context=self._context, enable_logger_service=True
            )
            self.executor = SingleThreadedExecutor(context=self._context)
        except Exception as error:
            self._context.try_shutdown()
            raise RosBridgeFailed(f"ROS 2 could not be started: {error}") from error
        self.executor.add_node(self.node)
        self._heartbeat = Heartbeat()
        # Of its own clock, which goes on when that of the robot stands still.
        steady = Clock(clock_type=ClockType.STEADY_TIME)
        self.node.create_timer(BEAT_S, self._heartbeat.beat, clock=steady)
        self._closing = threading.Event()
        self._thread = threading.Thread(target=self._spin, name="edgevox-ros2")

    def start(self) -> None:
        self._heartbeat.beat()
        self._thread.start()

    def close(self) -> None:
        """Leave the graph: the thread joined, shared memory freed."""
        self._closing.set()
        self.executor.shutdown()
        if self._thread.is_alive():
            self._thread.join()
        self.node.destroy_node()
        self._context.try_shutdown()

    @property
    def name(self) -> str:
        """The node's full name."""
        return str(self.node.get_fully_qualified_name())

    @property
    def stalled_s(self) -> float:
        """For how long a callback holds up all others; infinite if the thread has ended by itself.

        0 before `start` and after `close`.
        """
        if self._thread.ident is None or self._closing.is_set():
            return 0.0
        late_s = max(0.0, self._heartbeat.silent_s - BEAT_S)
        return late_s if self._thread.is_alive() else math.inf

    def _spin(self) -> None:
        """Run callbacks until the end; one that fails is logged and must not end the others."""
        while not self._closing.is_set():
            try:
                self.executor.spin()
            except ExternalShutdownException:
                return
            except Exception:
                log.exception("a ROS 2 callback failed")
