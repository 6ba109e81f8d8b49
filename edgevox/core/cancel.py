"""Cancellation, which reaches everything that works for one turn or one goal."""

import threading
from collections.abc import Callable

from edgevox.core.log import get_logger
from edgevox.core.reason import NO_REASON, Reason

log = get_logger(__name__)


class Cancelled(Exception):
    """Raised by work that stopped because its token was cancelled or its motion ended.

    It is no error. `why` is the reason, with its code if it has one.
    """

    def __init__(self, why: Reason | str = NO_REASON) -> None:
        super().__init__(str(why))
        self.why = why if isinstance(why, Reason) else Reason(why)


class CancelToken:
    """A one-way switch that many threads may look at and one of them may turn.

    Work that can be stopped polls `cancelled`, sleeps with `wait`, or registers a callback.
    A child is cancelled with its parent, never the other way round.
    """

    def __init__(self) -> None:
        self._event = threading.Event()
        self._lock = threading.Lock()
        self._callbacks: dict[int, Callable[[], object]] = {}
        self._next_key = 0
        self._why = NO_REASON
        self._detach: Callable[[], None] = lambda: None

    @property
    def cancelled(self) -> bool:
        return self._event.is_set()

    @property
    def reason(self) -> str:
        """The reason in English; empty while it is not cancelled."""
        return str(self._why)

    @property
    def why(self) -> Reason:
        """The reason with its code, if it has one."""
        return self._why

    def cancel(self, reason: Reason | str = "cancelled") -> bool:
        """Turn the switch. True for the call that turned it, False for every later one.

        Callbacks run once, on the calling thread. A callback's exception is logged and reaches
        neither the other callbacks nor the caller, which may be stopping a robot.
        """
        with self._lock:
            if self._event.is_set():
                return False
            self._why = reason if isinstance(reason, Reason) else Reason(reason)
            self._event.set()
            callbacks = list(self._callbacks.values())
            self._callbacks.clear()
        for callback in callbacks:
            try:
                callback()
            except Exception:
                log.exception("cancel_callback_failed")
        return True

    def wait(self, timeout_s: float | None = None) -> bool:
        """Sleep until cancelled or until the timeout; True if cancelled."""
        return self._event.wait(timeout_s)

    def check(self) -> None:
        """Raise `Cancelled` if the switch is turned."""
        if self._event.is_set():
            raise Cancelled(self._why)

    def on_cancel(self, callback: Callable[[], object]) -> Callable[[], None]:
        """Run `callback` on cancellation, now if cancelled. Returns a function that forgets it."""
        with self._lock:
            if not self._event.is_set():
                key = self._next_key
                self._next_key += 1
                self._callbacks[key] = callback
                return lambda: self._forget(key)
        callback()
        return lambda: None

    def child(self) -> "CancelToken":
        """A token that is cancelled with this one. Call `detach` on it when its work is done."""
        token = CancelToken()
        token._detach = self.on_cancel(lambda: token._follow(self))
        return token

    def detach(self) -> None:
        """Stop listening to the parent; a token without one has nothing to do."""
        self._detach()

    def _follow(self, parent: "CancelToken") -> None:
        self.cancel(parent.why)

    def _forget(self, key: int) -> None:
        with self._lock:
            self._callbacks.pop(key, None)
