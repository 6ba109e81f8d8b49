"""The interlock of motion: what may move the body, and which orders a stop has made void.

The one rule for a stop: whatever was asked for before it is void, whoever asked and however far it
has come; whatever is asked for after it counts. Times cannot decide which is which: clocks differ
between hosts, and ROS 2 tells a server of an action neither when a request was sent nor when it
came. So the rule counts. Each stop is numbered, and an order carries the number that was in force
when it was received (its `mark`): a fencing token, as distributed systems call it. Whoever receives
orders for the robot reads the mark before anything else, and whoever carries them out asks
`refusal` for it in the moment in which they begin.
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
"""Tells others of what was ended. It may take long, so it comes after all that moves has ended."""


class Holder(StrEnum):
    """Who may forbid motion; each takes back only its own word."""

    PRESENCE = "presence"
    SOFTWARE_STOP = "software_stop"
    DRAIN = "drain"


class StreamStopped(EdgeVoxError):
    """A stop has ended this stream of velocities: it counts again once it has paused."""

    def __init__(self, reason: Reason) -> None:
        self.reason = reason
        super().__init__(str(reason))


class Interlock:
    """Whoever would move the body asks `reason` first; whoever forbids it calls `engage`.

    Who calls `refuse` forbids only what is new: what moves may go on to its end.
    It may have several holders, and motion is allowed again when the last has released it. To stop
    is never forbidden. Every method may be called from any thread.

    `mark` grows with each stop and with each release. An order from before the last stop is
    `outdated`; one from before a release may not move the body either, as it was asked for while
    motion was forbidden.
    """

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._mark = self._stopped = self._released = 0
        self._why_stopped = self._why_held = NO_REASON
        self._stop_listeners: tuple[Callable[[int], object], ...] = ()
        self.streams_ended = 0
        """How many streams of velocities a stop has ended while they went on."""
        self._held: Mapping[Holder, Reason] = {}
        self._refused: Mapping[Holder, Reason] = {}
        self._listeners: tuple[Callable[[Reason], Tell | None], ...] = ()

    @property
    def reason(self) -> Reason:
        """Why nothing may begin to move, by who has forbidden it longest; none if it may."""
        return next(iter(self.holders.values()), NO_REASON)

    @property
    def holders(self) -> Mapping[Holder, Reason]:
        """Who forbids motion, and why; who has done so longest comes first."""
        return {**self._held, **self._refused}

    @property
    def mark(self) -> int:
        """What an order that is received now carries."""
        return self._mark

    @property
    def stopped(self) -> int:
        """The mark that the last stop has made."""
        return self._stopped

    def outdated(self, mark: int) -> Reason:
        """Why an order with this mark is void, as a stop came after it; no reason if it is not."""
        return self._why_stopped if mark < self._stopped else NO_REASON

    def refusal(self, mark: int) -> Reason:
        """Why an order with this mark may not move the body now; no reason if it may."""
        if held := self.reason:
            return held
        return self._why_held if mark < self._released else self.outdated(mark)

    @contextmanager
    def stopping(self, reason: Reason) -> Iterator[None]:
        """Make void what was asked for until now; inside it, end what that has begun.

        The order of the two is what cannot be raced: an order that begins while this runs has
        either asked `refusal` before, and is ended inside, or asks after, and is refused.
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
        """Call it after each stop and release, when what moved was ended, on the thread that did.

        It is given the mark that this stop or release has made. It must not block or raise.
        """
        with self._lock:
            self._stop_listeners = (*self._stop_listeners, listener)

    def refuse(self, holder: Holder, reason: Reason) -> None:
        """Let nothing new begin to move until this holder releases it; what moves goes on."""
        with self._lock:
            self._refused = {**self._refused, holder: reason}

    def engage(self, holder: Holder, reason: Reason) -> bool:
        """Forbid motion until this holder releases it, and have what moves already ended.

        Whether it was allowed until now, and so the listeners were called.
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
        """Take back this holder's word; motion is allowed once nobody else forbids it.

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
        """Call it with the reason whenever motion was allowed and is no more.

        It ends what it moves, at once; what it returns is called when all listeners have.
        """
        with self._lock:
            self._listeners = (*self._listeners, listener)


def _without(holder: Holder, held: Mapping[Holder, Reason]) -> Mapping[Holder, Reason]:
    return {who: why for who, why in held.items() if who is not holder}


class InterlockComponent:
    """Whether the body may move: that somebody forbids it is worth a warning, and no fault."""

    name = ComponentName.INTERLOCK
    checks: tuple[HealthCheck, ...] = ()

    def __init__(self, interlock: Interlock, clock: Clock | None = None) -> None:
        self._interlock = interlock
        self._streams = RecentIncrease(clock)

    def status(self) -> Status:
        """Who forbids motion now, and whether a stop has just ended a stream of velocities."""
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
