"""The software stop: one press keeps the robot standing until a person resumes it.

The software stop asks the body to halt, as every halt does. An emergency stop is different: it cuts
the power of the drives, whatever a computer does.
"""

import threading
import time
from collections.abc import Callable
from dataclasses import dataclass

from edgevox.core.agent_events import SoftwareStopChanged
from edgevox.core.bus import Bus
from edgevox.core.motion.interlock import Holder, Interlock
from edgevox.core.reason import Reason


@dataclass(frozen=True, slots=True)
class StopState:
    """State of the software stop."""

    engaged: bool = False
    """True while the software stop forbids motion."""
    by: str = ""
    """The person or program that changed the state last, for people to read."""
    since: float | None = None
    """Unix time in seconds when it was engaged; None while it is not."""


class SoftwareStop:
    """Forbids all motion from `stop` to `resume`. Any thread may call both; neither can fail.

    Each press also stops like a stop word, even while the software stop is engaged: `end_all` ends
    motion, speech and waiting requests. Every change is published as `SoftwareStopChanged` before
    the call returns. A request to move gets `reason` as its refusal meanwhile.
    """

    def __init__(
        self,
        interlock: Interlock,
        bus: Bus,
        end_all: Callable[[Reason], object],
        reason: Reason,
        now: Callable[[], float] = time.time,
    ) -> None:
        self._interlock = interlock
        self._bus = bus
        self._end_all = end_all
        self._reason = reason
        self._now = now
        self._lock = threading.RLock()
        self._state = StopState()
        interlock.on_engage(self._engaged)

    @property
    def state(self) -> StopState:
        """The state now."""
        return self._state

    def stop(self, by: str) -> None:
        """Stand still from now on. `by` names the person or program that asks, for people."""
        ended = False
        try:
            ended = self._interlock.engage(Holder.SOFTWARE_STOP, self._reason)
        finally:
            if not ended:  # motion was forbidden already, or a listener raised
                self._end_all(self._reason)
        with self._lock:
            self._interlock.engage(Holder.SOFTWARE_STOP, self._reason)  # not resumed in between
            if not self._state.engaged:
                self._change(StopState(engaged=True, by=by, since=self._now()))

    def resume(self, by: str) -> None:
        """Allow motion again; nothing moves by itself."""
        with self._lock:
            self._interlock.release(Holder.SOFTWARE_STOP)
            if self._state.engaged:
                self._change(StopState(engaged=False, by=by))

    def listen(self, listener: Callable[[StopState], None]) -> Callable[[], None]:
        """Call `listener` with every new state, on any thread; returns a function to undo that."""
        return self._bus.subscribe(SoftwareStopChanged, lambda _: listener(self._state))

    def _engaged(self, reason: Reason) -> None:
        """End everything before the listeners report, so that their reports are still said."""
        if reason is self._reason:
            self._end_all(reason)

    def _change(self, state: StopState) -> None:
        self._state = state
        self._bus.publish(SoftwareStopChanged(state.engaged, state.by))
