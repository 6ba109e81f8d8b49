"""A node that looks for incompatible peers once in a while, not with every message.

rclpy gives each publisher and each subscription an event handler, which warns of a peer whose QoS
or type does not fit, and its executor prepares and checks all of them whenever it wakes: with some
fifty topics that was half of the work of an answer. Here they are looked at when `look` is called,
together; they warn as ever, a moment later.
"""

from contextlib import ExitStack
from typing import Any

from rclpy.event_handler import EventHandler
from rclpy.exceptions import InvalidHandle
from rclpy.impl.implementation_singleton import rclpy_implementation as rcl
from rclpy.node import Node
from rclpy.publisher import Publisher
from rclpy.subscription import Subscription
from rclpy.waitable import Waitable


class QuietNode(Node):
    """A node whose executor waits for messages, services and timers only."""

    def __init__(self, *args: Any, **options: Any) -> None:
        self._events: list[EventHandler] = []
        super().__init__(*args, **options)

    def look(self) -> None:
        """Call those whose event has come; on the executor's thread, in a timer."""
        context = self.context.handle
        if context is None:
            return
        with ExitStack() as held, context:
            alive = [one for one in list(self._events) if _enters(held, one)]
            wait_set = rcl.WaitSet(0, 0, 0, 0, 0, len(alive), context)
            wait_set.clear_entities()
            for one in alive:
                one.add_to_wait_set(wait_set)
            wait_set.wait(0)
            come = [(one, one.take_data()) for one in alive if one.is_ready(wait_set)]
        for one, what in come:
            one.callback(what)

    def add_waitable(self, waitable: Waitable) -> None:
        """Where rclpy adds the handlers of every publisher and subscription it creates."""
        if isinstance(waitable, EventHandler):
            self._events.append(waitable)
        else:
            super().add_waitable(waitable)

    def destroy_publisher(self, publisher: Publisher) -> bool:
        self._give_back(publisher.event_handlers)
        return bool(super().destroy_publisher(publisher))

    def destroy_subscription(self, subscription: Subscription) -> bool:
        self._give_back(subscription.event_handlers)
        return bool(super().destroy_subscription(subscription))

    def _give_back(self, handlers: Any) -> None:
        """Put them where rclpy believes them to be, and removes them from."""
        for one in handlers:
            if one in self._events:
                self._events.remove(one)
                super().add_waitable(one)


def _enters(held: ExitStack, handler: EventHandler) -> bool:
    """Keep it from being destroyed meanwhile; False if it is already."""
    try:
        held.enter_context(handler)
    except InvalidHandle:
        return False
    return True
