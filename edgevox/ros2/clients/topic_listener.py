"""Hears a topic, and knows the newest message."""

from collections.abc import Callable, Sequence
from typing import Any

from rclpy.node import Node

from edgevox.core.cancel import CancelToken
from edgevox.core.clock import Clock
from edgevox.ros2.clients.interface_client import InterfaceClient
from edgevox.ros2.clients.waiting import Newest, TookTooLong
from edgevox.ros2.qos import interface_profile

READ_S = 5.0
"""What was heard so long ago is no answer; unless the topic is latched, which says it once."""


class TopicListener(InterfaceClient):
    """A topic's subscription, from the moment that it is made; `keeps` is as of `Newest`."""

    def __init__(
        self, node: Node, kind: Any, name: str, clock: Clock, *, latched: bool, keeps: int = 1
    ) -> None:
        super().__init__(node, kind, name, clock)
        self._latched = latched
        self._newest = Newest(clock, keeps)
        qos = interface_profile(latched=latched, heard=True)
        node.create_subscription(kind, name, self._newest.take, qos)

    def latest(self, token: CancelToken, timeout_s: float, oldest_s: float = READ_S) -> Any:
        """The newest message, if it is no older, else the next. Raises `SkillFailed`."""
        message = self._newest.young(float("inf") if self._latched else oldest_s)
        if message is not None:
            return message
        try:
            return self._newest.wait(lambda _: True, token, min(READ_S, timeout_s))
        except TookTooLong:
            raise self.failed("unheard") from None

    def wait_for(
        self,
        fits: Callable[[Any], bool],
        token: CancelToken,
        timeout_s: float,
        oldest_s: float = READ_S,
        since_s: float | None = None,
    ) -> Any:
        """The first message that fits, be it the newest, if that is no older.

        With `since_s`, of the `clock`, be it any that has come since then, rather than the newest.
        Raises `SkillFailed`, or `Cancelled`.
        """

        def known() -> Sequence[Any]:
            if since_s is not None and not self._latched:
                return self._newest.since(since_s)
            newest = self._newest.young(float("inf") if self._latched else oldest_s)
            return () if newest is None else (newest,)

        try:
            return self._newest.wait(fits, token, timeout_s, known)
        except TookTooLong:
            raise self.failed("not_so") from None
