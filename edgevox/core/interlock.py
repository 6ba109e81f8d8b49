"""The interlock of motion: while it is engaged nothing may move the body, and it says why."""

import threading
from collections.abc import Callable

from edgevox.core.reason import NO_REASON, Reason


class Interlock:
    """Whoever would move the body asks `reason` first; whoever forbids it calls `engage`.

    To stop is never forbidden. Every method may be called from any thread.
    """

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._reason = NO_REASON
        self._listeners: tuple[Callable[[Reason], None], ...] = ()

    @property
    def reason(self) -> Reason:
        """Why the body may not be moved; none if it may."""
        return self._reason

    def engage(self, reason: Reason) -> None:
        """Forbid motion from now on, and have what moves already ended."""
        with self._lock:
            engaged, self._reason = bool(self._reason), reason
        if not engaged:
            for listener in self._listeners:
                listener(reason)

    def release(self) -> None:
        """Allow motion again; nothing moves by itself."""
        with self._lock:
            self._reason = NO_REASON

    def on_engage(self, listener: Callable[[Reason], None]) -> None:
        """Call it with the reason whenever motion was allowed and is no more."""
        with self._lock:
            self._listeners = (*self._listeners, listener)
