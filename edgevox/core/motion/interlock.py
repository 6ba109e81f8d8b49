"""The interlock of motion: permission to move the body, and the orders that a stop made void.

A stop has one rule: every order from before the stop is void, wherever it came from and however far
it has come; every order from after the stop counts. Times cannot tell the two apart: clocks differ
between hosts, and ROS 2 tells an action server neither when a request was sent nor when it arrived.
So the interlock counts. It numbers each stop, and an order carries the number in force when it was
received, its `mark`; distributed systems call this a fencing token. Code that receives an order
reads the mark before anything else. Code that carries out an order asks `refusal` with that mark at
the moment when it begins.
"""

import threading
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from enum import StrEnum

from edgevox.core.clock import Clock
from edgevox.core.errors import EdgeVoxError
from edgevox.core.reason import NO_REASON, Reason
from edgevox.core.status import ComponentName, Finding, HealthCheck, Level, RecentIncrease, Status

STREAM_ENDED = "a stop has ended a stream of velocities: it counts again once it has paused"

Tell = Callable[[], object]
"""Reports what was ended. A report may take long, so it runs after all motion has ended."""


class Holder(StrEnum):
    """Parts that may forbid motion; each releases only its own ban."""

    PRESENCE = "presence"
    SOFTWARE_STOP = "software_stop"
    DRAIN = "drain"


class StreamStopped(EdgeVoxError):
    """A stop has ended this stream of velocities: it counts again once it has paused."""

    def __init__(self, reason: Reason) -> None:
        self.reason = reason
        super().__init__(str(reason))


class Interlock:
    """Decides whether the body may move: ask `refusal` or `reason` before a motion.

    `engage` forbids motion and ends the running one; `refuse` forbids only new motion. Several
    holders may do so at once, and motion is allowed again when the last one releases it. Stopping
    is never forbidden. Every method may be called from any thread.

    `mark` grows with each stop and each release. An order from before the last stop is `outdated`.
    An order from before a release may not move the body either: it was given while motion was
    forbidden.
    """

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._mark = self._stopped = self._released = 0
        self._why_stopped = self._why_held = NO_REASON
        self._stop_listeners: tuple[Callable[[int], object], ...] = ()
        self.streams_ended = 0
        """Number of running streams of velocities that a stop has ended."""
        self._held: Mapping[Holder, Reason] = {}
        self._refused: Mapping[Holder, Reason] = {}
        self._listeners: tuple[Callable[[Reason], Tell | None], ...] = ()

    @property
    def reason(self) -> Reason:
        """The reason of the holder with the longest ban on motion; empty if motion is allowed."""
        return next(iter(self.holders.values()), NO_REASON)

    @property
    def holders(self) -> Mapping[Holder, Reason]:
        """The holders that forbid motion, each with its reason, the longest ban first."""
        return {**self._held, **self._refused}

    @property
    def mark(self) -> int:
        """The mark of an order that is received now."""
        return self._mark

    @property
    def stopped(self) -> int:
        """The mark that the last stop made."""
        return self._stopped

    def outdated(self, mark: int) -> Reason:
        """The reason of the stop that made an order with this mark void; empty if none did."""
        return self._why_stopped if mark < self._stopped else NO_REASON

    def refusal(self, mark: int) -> Reason:
        """The reason why an order with this mark may not move the body now; empty if it may."""
        if held := self.reason:
            return held
        return self._why_held if mark < self._released else self.outdated(mark)

    @contextmanager
    def stopping(self, reason: Reason) -> Iterator[None]:
        """Make every order so far void; end the running ones inside the `with` block.

        This sequence leaves no race: an order that begins meanwhile either asked `refusal` before,
        and is ended inside the block, or asks afterwards, and is refused.
        """
        with self._lock:
            mark = self._mark = self._mark + 1
            self._stopped, self._why_stopped = mark, reason
            listeners = self._stop_listeners
        try:
            yield
        finally:
            for listener in listeners:
                listener(mark)

    def on_stop(self, listener: Callable[[int], object]) -> None:
        """Call `listener` with the new mark after each stop and release, on the same thread.

        After a stop, all motion has ended by then. The listener must not block or raise.
        """
        with self._lock:
            self._stop_listeners = (*self._stop_listeners, listener)

    def refuse(self, holder: Holder, reason: Reason) -> None:
        """Forbid new motion until this holder releases it; running motion goes on."""
        with self._lock:
            self._refused = {**self._refused, holder: reason}

    def engage(self, holder: Holder, reason: Reason) -> bool:
        """Forbid motion until this holder releases it, and end the running motion.

        Returns True if no holder had engaged it before, so that the listeners were called.
        """
        with self._lock:
            engaged, self._held = bool(self._held), {**self._held, holder: reason}
            listeners = self._listeners
        if not engaged:
            for tell in [listener(reason) for listener in listeners]:
                if tell:
                    tell()
        return not engaged

    def release(self, holder: Holder) -> None:
        """Release this holder's ban; motion is allowed once no other holder forbids it.

        Nothing moves by itself then.
        """
        with self._lock:
            why = self.holders.get(holder)
            if why is None:
                return
            mark = self._mark = self._mark + 1
            self._released, self._why_held = mark, why
            self._held = _without(holder, self._held)
            self._refused = _without(holder, self._refused)
            listeners = self._stop_listeners
        for listener in listeners:
            listener(mark)

    def on_engage(self, listener: Callable[[Reason], Tell | None]) -> None:
        """Call `listener` with the reason whenever `engage` ends an allowed motion.

        The listener must end its motion at once. It may return a function, which is called after
        all listeners have ended theirs.
        """
        with self._lock:
            self._listeners = (*self._listeners, listener)


def _without(holder: Holder, held: Mapping[Holder, Reason]) -> Mapping[Holder, Reason]:
    return {who: why for who, why in held.items() if who is not holder}


class InterlockComponent:
    """The interlock in the status: a ban on motion is a warning, not a fault."""

    name = ComponentName.INTERLOCK
    checks: tuple[HealthCheck, ...] = ()

    def __init__(self, interlock: Interlock, clock: Clock | None = None) -> None:
        self._interlock = interlock
        self._streams = RecentIncrease(clock)

    def status(self) -> Status:
        """The holders that forbid motion, and whether a stop just ended a velocity stream."""
        held = self._interlock.holders
        found = [Finding(Level.WARN, str(reason)) for reason in held.values()]
        ended = self._interlock.streams_ended
        if self._streams.grew(ended):
            found.append(Finding(Level.WARN, STREAM_ENDED))
        holders = ", ".join(held) or None
        return Status.judged(
            self.name,
            found,
            well="motion is allowed",
            engaged=bool(held),
            holders=holders,
            streams_ended=ended,
        )
