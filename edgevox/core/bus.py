"""The bus: one place that publishes events, to which any number of faces listen."""

import threading
from collections.abc import Callable, Iterable
from types import UnionType
from typing import Any, TypeVar, get_args, overload

from edgevox.core.events import Event
from edgevox.core.log import get_logger

log = get_logger(__name__)

E = TypeVar("E")
Handler = Callable[[Any], None]


class Bus:
    """Delivers each event to its type's subscribers, in order, on the publisher's thread.

    Handlers must be quick and must not publish in answer while holding a lock of their own. A
    handler's exception is logged, and the other handlers still get the event: a broken face must
    not silence the robot.
    """

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._handlers: dict[type, tuple[Handler, ...]] = {}

    @overload
    def subscribe(self, kind: type[E], handler: Callable[[E], None]) -> Callable[[], None]: ...

    @overload
    def subscribe(self, kind: UnionType, handler: Handler) -> Callable[[], None]: ...

    def subscribe(self, kind: type | UnionType, handler: Handler) -> Callable[[], None]:
        """Call `handler` for every event of exactly this type, or of each of a union of types.

        Returns a function that unsubscribes.
        """
        kinds = get_args(kind) or (kind,)
        with self._lock:
            for one in kinds:
                self._handlers[one] = (*self._handlers.get(one, ()), handler)
        return lambda: self._unsubscribe(kinds, handler)

    def publish(self, event: Event) -> None:
        """Call every handler that subscribed to this event's type."""
        for handler in self._handlers.get(type(event), ()):
            try:
                handler(event)
            except Exception:
                log.exception("subscriber_failed", on=type(event).__name__)

    def _unsubscribe(self, kinds: Iterable[type], handler: Handler) -> None:
        with self._lock:
            for one in kinds:
                left = tuple(h for h in self._handlers.get(one, ()) if h is not handler)
                self._handlers[one] = left
