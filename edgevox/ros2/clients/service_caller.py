"""Calls a service, and waits for its answer."""

from collections.abc import Callable
from typing import Any

from rclpy.node import Node

from edgevox.core.cancel import Cancelled, CancelToken
from edgevox.core.clock import Clock
from edgevox.ros2.clients.interface_client import InterfaceClient
from edgevox.ros2.clients.waiting import TookTooLong, wait_for


class ServiceCaller(InterfaceClient):
    """A service's client."""

    def __init__(self, node: Node, kind: Any, name: str, clock: Clock) -> None:
        super().__init__(node, kind, name, clock)
        self._client = node.create_client(kind, name)

    def call(
        self,
        request: Any,
        token: CancelToken,
        timeout_s: float,
        give_up: Callable[[], None] = lambda: None,
    ) -> Any:
        """Its answer. Raises `SkillFailed` where it is not there or silent, or `Cancelled`.

        `give_up` is called where it was silent for so long: it may still be at it.
        """
        self.until_there(self._client.service_is_ready, token, timeout_s, "not_there")
        future = self._client.call_async(request)
        try:
            return wait_for(future, token, timeout_s)
        except (TookTooLong, Cancelled) as end:
            self._client.remove_pending_request(future)
            if isinstance(end, Cancelled):
                raise
            give_up()
            raise self.failed("no_answer") from None
