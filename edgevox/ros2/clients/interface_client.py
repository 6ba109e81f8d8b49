"""What clients of all kinds of interfaces share: where they live, and how they fail."""

from collections.abc import Callable
from typing import Any

from rclpy.node import Node

from edgevox.agent.skills import SkillFailed
from edgevox.core.cancel import CancelToken
from edgevox.core.clock import Clock
from edgevox.core.log import get_logger
from edgevox.ros2.clients.interface_reasons import interface_reason
from edgevox.ros2.clients.waiting import TookTooLong, wait_until

log = get_logger(__name__)

THERE_S = 3.0
"""So long an interface may take to be discovered."""


class InterfaceClient:
    """A client of the interface of this type and name, on a node.

    Make it on the thread that spins the node, or before anything spins it; use it on others.
    """

    def __init__(self, node: Node, kind: Any, name: str, clock: Clock) -> None:
        self.name = name
        self._node, self._kind, self._clock = node, kind, clock

    def failed(self, code: str) -> SkillFailed:
        """What to raise where it has failed; logged with the interface."""
        log.warning("interface_failed", interface=self.name, why=code)
        return SkillFailed(interface_reason(code, what=self.name))

    def until_there(
        self, look: Callable[[], bool], token: CancelToken, timeout_s: float, code: str
    ) -> None:
        """Wait until it is discovered. Raises `SkillFailed` by this code, or `Cancelled`."""
        try:
            wait_until(look, token, min(THERE_S, timeout_s), self._clock)
        except TookTooLong:
            raise self.failed(code) from None
