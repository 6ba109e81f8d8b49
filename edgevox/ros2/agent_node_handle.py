"""The node of an agent as skills have it: clients that are made when they are first used."""

import threading
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, TypeVar

from rclpy.node import Node

from edgevox.agent.skills import SkillFailed
from edgevox.agent.text.reasons import because
from edgevox.core.cancel import CancelToken
from edgevox.core.clock import Clock, SystemClock
from edgevox.core.errors import InvalidValue
from edgevox.ros2.clients import (
    READ_S,
    STEERING,
    THERE_S,
    ActionRunner,
    NodeBusy,
    ServiceCaller,
    TopicListener,
    TopicSender,
    on_node_thread,
    type_name,
)

T = TypeVar("T")


@dataclass(frozen=True, slots=True)
class _ClientKey:
    """A client as it is asked for; each is made once, and stays as long as the node."""

    make: Callable[..., Any]
    kind: Any
    name: str
    latched: bool | None = None

    def made(self, node: Node, clock: Clock) -> Any:
        how = {} if self.latched is None else {"latched": self.latched}
        return self.make(node, self.kind, self.name, clock, **how)


class AgentNodeHandle:
    """A `NodeHandle`. The owner of the node lends it with `open`, before it is spun."""

    def __init__(self, clock: Clock | None = None) -> None:
        self._clock = clock or SystemClock()
        self._node: Node | None = None
        self._listens: dict[_ClientKey, None] = {}
        self._clients: dict[_ClientKey, Any] = {}
        self._making = threading.Lock()

    def open(self, node: Node) -> None:
        """Use this node from now on."""
        self._clients = {one: one.made(node, self._clock) for one in self._listens}
        self._node = node

    def close(self) -> None:
        """Take the node back, before it is destroyed; waiting callers end by their tokens."""
        self._node = None
        self._clients = {}

    def call(
        self, kind: Any, name: str, request: Any, *, token: CancelToken, timeout_s: float = 10.0
    ) -> Any:
        token.check()
        return self._client(_ClientKey(ServiceCaller, kind, name)).call(request, token, timeout_s)

    def run(
        self,
        kind: Any,
        name: str,
        goal: Any,
        *,
        token: CancelToken,
        timeout_s: float = 60.0,
        hear: Callable[[Any], None] = lambda _: None,
    ) -> Any:
        token.check()
        return self._client(_ClientKey(ActionRunner, kind, name)).run(goal, token, timeout_s, hear)

    def publish(
        self, kind: Any, name: str, message: Any, *, token: CancelToken, latched: bool = False
    ) -> None:
        if type_name(kind) in STEERING:
            expected = "no velocity: a robot is driven by its body, with limits and a watchdog"
            raise InvalidValue(name, type_name(kind), expected)
        token.check()
        sender = self._client(_ClientKey(TopicSender, kind, name, latched))
        sender.until_heard(token, THERE_S)
        sender.send(message)

    def listen(self, kind: Any, name: str, *, latched: bool = False) -> None:
        wanted = _ClientKey(TopicListener, kind, name, latched)
        self._listens[wanted] = None
        if self._node is not None:
            self._client(wanted)

    def latest(
        self,
        kind: Any,
        name: str,
        *,
        token: CancelToken,
        oldest_s: float = READ_S,
        timeout_s: float = READ_S,
        latched: bool = False,
    ) -> Any:
        token.check()
        listener = self._client(_ClientKey(TopicListener, kind, name, latched))
        return listener.latest(token, timeout_s, oldest_s)

    def wait_for(
        self,
        kind: Any,
        name: str,
        fits: Callable[[Any], bool],
        *,
        token: CancelToken,
        timeout_s: float,
        oldest_s: float = READ_S,
        latched: bool = False,
    ) -> Any:
        token.check()
        listener = self._client(_ClientKey(TopicListener, kind, name, latched))
        return listener.wait_for(fits, token, timeout_s, oldest_s)

    def on_node(self, work: Callable[[Any], T]) -> T:
        if self._node is None:
            raise SkillFailed(because("switched_off"))
        try:
            return on_node_thread(self._node, work)
        except NodeBusy:
            raise SkillFailed(because("switched_off")) from None

    def _client(self, wanted: _ClientKey) -> Any:
        with self._making:
            if wanted not in self._clients:
                self._clients[wanted] = self.on_node(lambda node: wanted.made(node, self._clock))
            return self._clients[wanted]
