"""Waits of a skill for something that happens on the node's thread."""

import threading
from collections import deque
from collections.abc import Callable, Iterable
from typing import Any

from rclpy.task import Future

from edgevox.core.cancel import CancelToken
from edgevox.core.clock import Clock

LOOK_AGAIN_S = 0.05


class TookTooLong(Exception):
    """The awaited event did not come in time."""


def wait_for(future: Future, token: CancelToken, timeout_s: float) -> Any:
    """The result of a future. Raises `Cancelled`, or `TookTooLong`."""
    done = threading.Event()
    future.add_done_callback(lambda _: done.set())
    forget = token.on_cancel(done.set)
    try:
        done.wait(timeout_s)
    finally:
        forget()
    if future.done():
        return future.result()
    token.check()
    raise TookTooLong


def wait_until(
    look: Callable[[], bool], token: CancelToken, timeout_s: float, clock: Clock
) -> None:
    """Block until the graph shows something that has no event. Raises as `wait_for` does."""
    until_s = clock.now() + timeout_s
    while not look():
        token.check()
        if clock.now() >= until_s:
            raise TookTooLong
        token.wait(LOOK_AGAIN_S)


class Newest:
    """The newest messages of a topic, taken on the node's thread and awaited on others.

    A waiting caller gets every message, however fast they come. `keeps` is the number of messages
    that are kept for a caller who begins to wait after they came.
    """

    def __init__(self, clock: Clock, keeps: int = 1) -> None:
        self._clock = clock
        self._changed = threading.Condition()
        self._kept: deque[tuple[float, Any]] = deque(maxlen=keeps)
        self._waiting: list[deque[Any]] = []

    def take(self, message: Any) -> None:
        """A message has come."""
        with self._changed:
            self._kept.append((self._clock.now(), message))
            for waits in self._waiting:
                waits.append(message)
            self._changed.notify_all()

    def young(self, oldest_s: float) -> Any:
        """The newest message, unless it is older; None if there is none."""
        with self._changed:
            if not self._kept:
                return None
            at_s, message = self._kept[-1]
            return message if self._clock.now() - at_s <= oldest_s else None

    def since(self, begun_s: float) -> list[Any]:
        """Return the kept messages that came since then, the oldest first."""
        with self._changed:
            return [message for at_s, message in self._kept if at_s >= begun_s]

    def wait(
        self,
        fits: Callable[[Any], bool],
        token: CancelToken,
        timeout_s: float,
        known: Callable[[], Iterable[Any]] = tuple,
    ) -> Any:
        """The first message that fits: of those `known` when it begins, or that come from then on.

        Raises `Cancelled`, or `TookTooLong`.
        """
        until_s = self._clock.now() + timeout_s
        forget = token.on_cancel(self._wake)
        with self._changed:  # nothing comes between what is known and what will come
            waits = deque(known())
            self._waiting.append(waits)
        try:
            while True:
                if self._next(waits, token, until_s) and fits(message := waits.popleft()):
                    return message
        finally:
            forget()
            with self._changed:
                self._waiting = [one for one in self._waiting if one is not waits]

    def _next(self, waits: "deque[Any]", token: CancelToken, until_s: float) -> bool:
        """Return whether there is a message; False for an idle wake-up.

        A flood of messages that do not fit delays neither a stop nor the timeout.
        """
        token.check()
        with self._changed:
            left_s = until_s - self._clock.now()
            if left_s <= 0:
                self._waiting = [one for one in self._waiting if one is not waits]
            if waits:
                return True
            if left_s <= 0:
                raise TookTooLong
            self._changed.wait(left_s)
            return bool(waits)

    def _wake(self) -> None:
        with self._changed:
            self._changed.notify_all()
