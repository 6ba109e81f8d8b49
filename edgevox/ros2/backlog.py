"""What waits in the middleware's queues when the robot is stopped is void, as all that came before.

Neither a time nor a number in a message can say what came before a stop: clocks differ between
hosts, and rclpy gives a request for an action without any time. The order of a queue can. All
callbacks run on the executor's thread, so this is what that thread knows: what it takes from a
queue after a stop, and before it has emptied that queue once, may have been there before the stop;
what it takes later has come since. So each queue has a mark, the interlock's when the queue was
last found empty, and whatever is taken from it carries that mark. A stop empties the queues at
once, and so what is sent after the stop was told counts again. Nothing can overtake this: the
emptying and the callbacks are on one thread.

What was lost on the way and is repeated by the middleware comes later still. For that the time at
which a message says that it was sent is looked at, too, but only to refuse: within `LATE_S` before
the stop it is void, so that a host whose clock is wrong is not deaf for longer than that.
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
"""So late a reliable sender repeats what was lost, seen with Fast DDS."""
Receive = Callable[[Any, int], None]
"""Takes a message and its mark."""


class Queue:
    """One queue of orders. `take` handles one that waits; False if none does.

    `depth` is how many it holds at most: after so many are taken, none of those that were there is
    left, however fast others come.
    """

    def __init__(self, backlog: "Backlog", take: Callable[[], bool], depth: int, mark: int) -> None:
        self.take = take
        self.depth = depth
        self.mark = mark
        self._backlog = backlog

    @contextmanager
    def served(self, sent_ns: int = 0) -> Iterator[int]:
        """Whatever runs inside handles one order from this queue; gives its mark.

        `sent_ns` is the Unix time at which it says that it was sent, 0 where that is not known.
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
        """Everything was stopped, or allowed again, on any thread; the interlock is at `mark`."""
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
        """Whether what is served says that it was sent shortly before the last stop."""
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
