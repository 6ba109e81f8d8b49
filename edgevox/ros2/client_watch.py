"""Notices that a client is gone: ROS 2 does not tell a server that its client died."""

from collections.abc import Callable

from rclpy.clock import Clock
from rclpy.clock_type import ClockType
from rclpy.node import Node

LOOK_EVERY_S = 0.5
GRACE_S = 2.0
"""How long the graph must be without a client; discovery may lag behind the first request."""


class ClientWatch:
    """Calls `gone` when a service has had no client at all for a while, as long as it looks.

    The graph counts a service's clients and does not name them: while another client of the same
    service lives, the death of one is not seen. A client that leaves is missed at once, one that
    was killed when the middleware gives it up, with Fast DDS after 20 s. All calls on the
    executor's thread.
    """

    def __init__(self, node: Node, service: str, gone: Callable[[], None]) -> None:
        self._node = node
        self._service = node.resolve_service_name(service)  # the graph knows its remapped name
        self._gone = gone
        self._alone_for_s = 0.0
        # Real time: a paused simulation must not hide a client's death.
        self._timer = node.create_timer(
            LOOK_EVERY_S, self._look, clock=Clock(clock_type=ClockType.STEADY_TIME)
        )
        self._timer.cancel()

    def begin(self) -> None:
        """Look from now on."""
        if self._timer.is_canceled():
            self._alone_for_s = 0.0
            self._timer.reset()

    def end(self) -> None:
        """Look no more."""
        self._timer.cancel()

    def _look(self) -> None:
        if self._node.count_clients(self._service):
            self._alone_for_s = 0.0
            return
        self._alone_for_s += LOOK_EVERY_S
        if self._alone_for_s >= GRACE_S:
            self.end()
            self._gone()
