"""The backlog: voids orders that were in the middleware's queues when the robot was stopped.

Neither a time nor a number in a message can tell whether it was sent before a stop: clocks differ
between hosts, and rclpy gives an action request no time at all. The order of a queue can tell. All
callbacks run on the executor's thread. An order that this thread takes after a stop, but before it
has emptied the queue once, may have been there before the stop; a later order has come since.

So each queue has a mark, the interlock's at the time when the queue was last found empty, and each
order that is taken from the queue carries that mark. A stop empties the queues at once, so that
orders sent after the stop was told count again. Nothing can overtake this, because emptying and
callbacks share one thread.

An order that was lost on the way and repeated by the middleware comes later still. Therefore the
send time in a message is used as well, but only to refuse: an order sent within `LATE_S` before the
stop is void, so a host with a wrong clock is ignored for no longer than that.
"""

import threading
import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from functools import partial
from typing import Any

from rclpy.node import Node
from rclpy.qos import QoSProfile
from rclpy.subscription import Subscription

from edgevox.core.log import get_logger
from edgevox.core.motion.interlock import Interlock

log = get_logger(__name__)

LATE_S = 3.0
"""Delay with which a reliable sender repeats a lost message, seen with Fast DDS."""
Receive = Callable[[Any, int], None]
"""Takes a message and its mark."""


class Queue:
    """A queue of orders.

    Args:
        take: Handles one waiting order; returns False if there is none.
        depth: The most orders that it holds. Once this many are taken, none of those that were
            there is left, however fast others come.
        mark: The interlock's mark when the queue was last found empty.
    """

    def __init__(self, backlog: "Backlog", take: Callable[[], bool], depth: int, mark: int) -> None:
        self.take = take
        self.depth = depth
        self.mark = mark
        self._backlog = backlog

    @contextmanager
    def served(self, sent_ns: int = 0) -> Iterator[int]:
        """Mark the block as the handling of one order from this queue; yields the queue's mark.

        `sent_ns` is the order's send time, in nanoseconds of Unix time; 0 if unknown.
        """
        with self._backlog.serving(self, sent_ns):
            yield self.mark


class Backlog:
    """The queues of one node whose executor runs in one thread, from its making to `close`."""

    def __init__(self, node: Node, interlock: Interlock) -> None:
        self._node = node
        self._interlock = interlock
        self._queues: list[Queue] = []
        self._serving: Queue | None = None
        self._thread = 0
        self._emptying = False
        self._open = True
        self._sent_ns = self._stopped_ns = 0
        interlock.on_stop(self._stopped)

    def close(self) -> None:
        """Empty nothing any more."""
        self._open = False

    def subscribe(self, kind: Any, topic: str, receive: Receive, qos: QoSProfile) -> None:
        """Have each message of a topic received with its mark."""

        def serve(message: Any, info: Mapping[str, int]) -> None:
            with queue.served(info["source_timestamp"]) as mark:
                receive(message, min(mark, self._interlock.mark - 1) if self._is_late() else mark)

        callback: Any = serve  # whoever takes two arguments is also given what is known of it
        subscription = self._node.create_subscription(kind, topic, callback, qos)
        queue = self.add(partial(_take_message, subscription, serve), qos.depth)

    def add(self, take: Callable[[], bool], depth: int) -> Queue:
        """A queue that a stop has emptied by `take`."""
        queue = Queue(self, take, depth, self._interlock.mark)
        self._queues.append(queue)
        return queue

    @contextmanager
    def serving(self, queue: Queue, sent_ns: int) -> Iterator[None]:
        """An order from this queue is handled, on the executor's thread."""
        before = self._serving, self._sent_ns
        self._serving, self._sent_ns = queue, sent_ns
        self._thread = threading.get_ident()
        try:
            yield
        finally:
            self._serving, self._sent_ns = before

    def _stopped(self, mark: int) -> None:
        """React to a stop, or its release, on any thread; the interlock is at `mark`."""
        if not self._open or (self._emptying and self._is_here()):
            return  # whoever empties looks again
        here = self._serving is not None and self._is_here()
        self._stopped_ns = (here and self._sent_ns) or time.time_ns()
        if self._serving is not None and here:
            if self._serving.mark == mark - 1:
                self._serving.mark = mark  # what waits behind the order that stopped came after it
            self._empty(but=self._serving)
        elif self._node.executor:
            self._node.executor.create_task(self._empty)

    def _is_late(self) -> bool:
        """Return whether the order being handled was sent shortly before the last stop."""
        return self._sent_ns > 0 and 0 < self._stopped_ns - self._sent_ns < LATE_S * 1e9

    def _is_here(self) -> bool:
        return threading.get_ident() == self._thread

    def _empty(self, but: Queue | None = None) -> None:
        """Handle all that waits, with the mark that it has; on the executor's thread."""
        self._emptying, self._thread = True, threading.get_ident()
        try:
            while self._open:
                mark = self._interlock.mark
                behind = [one for one in self._queues if one is not but and one.mark != mark]
                if not behind:
                    break
                for queue in behind:
                    _empty_one(queue)
                    queue.mark = mark
        finally:
            self._emptying = False
        if but and but.mark != self._interlock.mark and self._node.executor:
            self._node.executor.create_task(self._empty)


def _empty_one(queue: Queue) -> None:
    for _ in range(queue.depth):
        try:
            if not queue.take():
                return
        except Exception:  # one order that breaks must not keep the others from being void
            log.exception("ros_callback_failed")


def _take_message(subscription: Subscription, receive: Callable[[Any, Any], None]) -> bool:
    with subscription.handle:
        taken = subscription.handle.take_message(subscription.msg_type, subscription.raw)
    if taken is None:
        return False
    receive(*taken)
    return True
