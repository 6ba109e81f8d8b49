"""Waits of a skill for something that happens on the node's thread."""

import threading
from collections.abc import Callable
from typing import Any

from rclpy.task import Future

from edgevox.core.cancel import CancelToken
from edgevox.core.clock import Clock

LOOK_AGAIN_S = 0.05


class TookTooLong(Exception):
    """It did not come within its time."""


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
    """The newest message of a topic, taken on the node's thread and waited for on others."""

    def __init__(self, clock: Clock) -> None:
        self._clock = clock
        self._changed = threading.Condition()
        self._message: Any = None
        self._at_s = 0.0
        self._count = 0

    def take(self, message: Any) -> None:
        """A message has come."""
        with self._changed:
            self._message, self._at_s = message, self._clock.now()
            self._count += 1
            self._changed.notify_all()

    def young(self, oldest_s: float) -> Any:
        """The newest message, unless it is older; None if there is none."""
        with self._changed:
            fits = self._message is not None and self._clock.now() - self._at_s <= oldest_s
            return self._message if fits else None

    def wait(
        self,
        fits: Callable[[Any], bool],
        token: CancelToken,
        timeout_s: float,
        *,
        kept: bool,
    ) -> Any:
        """The first message that fits: of those that come from now on, or the one that is `kept`.

        Raises `Cancelled`, or `TookTooLong`.
        """
        until_s = self._clock.now() + timeout_s
        forget = token.on_cancel(self._wake)
        try:
            with self._changed:
                seen = self._count - (1 if kept and self._count else 0)
                while True:
                    if self._count > seen:
                        seen, message = self._count, self._message
                        if fits(message):
                            return message
                        continue
                    token.check()
                    left_s = until_s - self._clock.now()
                    if left_s <= 0:
                        raise TookTooLong
                    self._changed.wait(left_s)
        finally:
            forget()

    def _wake(self) -> None:
        with self._changed:
            self._changed.notify_all()
