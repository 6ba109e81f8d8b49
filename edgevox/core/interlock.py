"""The interlock of motion: while anybody holds it nothing may move the body, and it says why."""

import threading
from collections.abc import Callable, Mapping
from enum import StrEnum

from edgevox.core.reason import NO_REASON, Reason
from edgevox.core.status import ComponentName, Finding, HealthCheck, Level, Status

Tell = Callable[[], object]
"""Tells others of what was ended. It may take long, so it comes after all that moves has ended."""


class Holder(StrEnum):
    """Who may forbid motion; each takes back only its own word."""

    PRESENCE = "presence"
    SOFTWARE_STOP = "software_stop"


class Interlock:
    """Whoever would move the body asks `reason` first; whoever forbids it calls `engage`.

    It may have several holders, and motion is allowed again when the last has released it. To stop
    is never forbidden. Every method may be called from any thread.
    """

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._held: Mapping[Holder, Reason] = {}
        self._listeners: tuple[Callable[[Reason], Tell | None], ...] = ()

    @property
    def reason(self) -> Reason:
        """Why the body may not be moved, by who has forbidden it longest; none if it may."""
        return next(iter(self._held.values()), NO_REASON)

    @property
    def holders(self) -> Mapping[Holder, Reason]:
        """Who forbids motion, and why; who has done so longest comes first."""
        return self._held

    def engage(self, holder: Holder, reason: Reason) -> None:
        """Forbid motion until this holder releases it, and have what moves already ended."""
        with self._lock:
            engaged, self._held = bool(self._held), {**self._held, holder: reason}
            listeners = self._listeners
        if not engaged:
            for tell in [listener(reason) for listener in listeners]:
                if tell:
                    tell()

    def release(self, holder: Holder) -> None:
        """Take back this holder's word; motion is allowed once nobody else forbids it.

        Nothing moves by itself then.
        """
        with self._lock:
            self._held = {who: why for who, why in self._held.items() if who is not holder}

    def on_engage(self, listener: Callable[[Reason], Tell | None]) -> None:
        """Call it with the reason whenever motion was allowed and is no more.

        It ends what it moves, at once; what it returns is called when all listeners have.
        """
        with self._lock:
            self._listeners = (*self._listeners, listener)


class InterlockComponent:
    """Whether the body may move: that somebody forbids it is worth a warning, and no fault."""

    name = ComponentName.INTERLOCK
    checks: tuple[HealthCheck, ...] = ()

    def __init__(self, interlock: Interlock) -> None:
        self._interlock = interlock

    def status(self) -> Status:
        """Who forbids motion now."""
        held = self._interlock.holders
        found = [Finding(Level.WARN, str(reason)) for reason in held.values()]
        holders = ", ".join(held) or None
        return Status.judged(
            self.name, found, well="motion is allowed", engaged=bool(held), holders=holders
        )
