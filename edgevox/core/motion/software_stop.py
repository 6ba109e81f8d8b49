"""The software stop: one press stands the robot still until somebody resumes.

It is software: it asks the body to halt as every halt does. It is no emergency stop, which cuts the
power of the drives whatever a computer does.
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
    """Whether the robot is stopped, by whom, and since when, in Unix seconds."""

    engaged: bool = False
    by: str = ""
    since: float | None = None


class SoftwareStop:
    """Forbids all motion from `stop` to `resume`. Any thread may call both; neither can fail.

    Each press is a stop like any other first, also while it is engaged: `end_all` ends what moves,
    what is said and what waits. Every change is published as `SoftwareStopChanged`, before the call
    returns. `reason` is what whoever asks for motion is told meanwhile.
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
        """Whether the robot is stopped now."""
        return self._state

    def stop(self, by: str) -> None:
        """Stand still from now on. `by` is who asks, for people."""
        ended = False
        try:
            ended = self._interlock.engage(Holder.SOFTWARE_STOP, self._reason)
        finally:
            if not ended:  # somebody else forbade motion already, or it broke
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
        """Call it with every new state, on any thread; returns a way to forget it."""
        return self._bus.subscribe(SoftwareStopChanged, lambda _: listener(self._state))

    def _engaged(self, reason: Reason) -> None:
        """Before anybody is told of what was ended: what is told after it waits to be said."""
        if reason is self._reason:
            self._end_all(reason)

    def _change(self, state: StopState) -> None:
        self._state = state
        self._bus.publish(SoftwareStopChanged(state.engaged, state.by))
