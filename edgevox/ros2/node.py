"""The node: its rclpy context, its name, and the thread that spins it."""

import math
import sys
import threading
from collections.abc import Sequence

from rclpy.clock import Clock
from rclpy.clock_type import ClockType
from rclpy.context import Context
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor

from edgevox.core.errors import EdgeVoxError
from edgevox.core.heartbeat import Heartbeat
from edgevox.core.log import get_logger
from edgevox.ops.logs import is_set_up
from edgevox.ros2.contract import NODE_NAME
from edgevox.ros2.fast_dds import choose_profile
from edgevox.ros2.logs import LoggerLevels, RcutilsStream, apply_log_levels
from edgevox.ros2.qos_events import QuietNode
from edgevox.ros2.spin import end_spin, spin_until

log = get_logger(__name__)

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
        choose_profile()
        self._context = Context()
        self._lines = RcutilsStream() if is_set_up() else None
        try:
            self._init(list(ros_args) or sys.argv)
            self.node = QuietNode(name, namespace=namespace, context=self._context)
            LoggerLevels(self.node)
            self.executor = SingleThreadedExecutor(context=self._context)
        except Exception as error:
            self._shut_down()
            raise RosBridgeFailed(f"ROS 2 could not be started: {error}") from error
        self.executor.add_node(self.node)
        self._heartbeat = Heartbeat(period_s=BEAT_S)
        # Of its own clock, which goes on when that of the robot stands still.
        steady = Clock(clock_type=ClockType.STEADY_TIME)
        self.node.create_timer(BEAT_S, self._beat, clock=steady)
        self.failed = 0
        """Callbacks that raised."""
        self._closing = threading.Event()
        self._thread = threading.Thread(target=self._spin, name="edgevox-ros2")

    def start(self) -> None:
        self._heartbeat.begin()
        self._thread.start()

    def close(self) -> None:
        """Leave the graph: the thread joined, shared memory freed."""
        end_spin(self._closing, self.executor, self._thread)
        self.node.destroy_node()
        self._shut_down()

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

    @property
    def lag_s(self) -> float:
        """The longest that callbacks had to wait in the last minute; 0 unless it spins."""
        begun = self._thread.ident is not None and not self._closing.is_set()
        return self._heartbeat.lag_s if begun else 0.0

    def _beat(self) -> None:
        self._heartbeat.beat()
        self.node.look()

    def _init(self, ros_args: list[str]) -> None:
        """Where a program's lines go to one stream, ROS 2 must not write its own beside it."""
        quiet = ["--ros-args", "--disable-stdout-logs"] if self._lines else []
        self._context.init([*ros_args, *quiet])
        apply_log_levels(ros_args)
        if self._lines:
            self._lines.open()

    def _shut_down(self) -> None:
        if self._lines:
            self._lines.close()
        self._context.try_shutdown()

    def _spin(self) -> None:
        """Run callbacks until the end; one that fails is logged and must not end the others."""
        while not self._closing.is_set():
            try:
                spin_until(self._closing, self.executor)
            except ExternalShutdownException:
                return
            except Exception:
                self.failed += 1
                log.exception("ros_callback_failed")
