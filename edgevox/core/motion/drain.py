"""The drain: no new motion begins, running motion may end within a bound, then the robot stands.

A drain cannot be undone: restart the agent to make the robot work again.
"""

import threading
import time
from collections.abc import Callable

from edgevox.core.agent_events import DrainChanged, DrainStatus
from edgevox.core.bus import Bus
from edgevox.core.clock import Clock, SystemClock
from edgevox.core.errors import EdgeVoxError
from edgevox.core.log import get_logger
from edgevox.core.motion.interlock import Holder, Interlock
from edgevox.core.reason import Reason

log = get_logger(__name__)

LOOK_S = 0.05
"""Seconds between two looks at whether the goals are over and whether the robot stands."""
BLIND_S = 2.0
"""Seconds to wait for a body that cannot tell whether it stands."""


class Drain:
    """Refuses every new motion from `begin` on. Any thread may call the methods.

    Running goals have a bounded time to end by themselves. Then `halt` and the interlock end them,
    and the drain waits until the robot stands. Stop words work as ever: they end a goal, and so the
    wait.
    """

    def __init__(
        self,
        interlock: Interlock,
        bus: Bus,
        *,
        halt: Callable[[str], object],
        busy: Callable[[], bool],
        stands: Callable[[], bool],
        reason: Reason,
        bound_s: float,
        stand_s: float,
        clock: Clock | None = None,
        pause: Callable[[float], object] = time.sleep,
    ) -> None:
        """Store the settings; `begin` begins the drain.

        Args:
            interlock: Refuses new motion.
            bus: Carries `DrainChanged`.
            halt: Brakes the body and tells it why.
            busy: Returns whether a goal runs or waits.
            stands: Returns whether the body stands; raises `EdgeVoxError` if it cannot tell.
            reason: The reason that every refused motion gets.
            bound_s: Seconds that running goals have to end by themselves.
            stand_s: Seconds to wait until the body stands.
            clock: Measures these times; the system's by default.
            pause: Sleeps for a number of seconds between two looks.
        """
        self._interlock = interlock
        self._bus = bus
        self._halt = halt
        self._busy = busy
        self._stands = stands
        self._reason = reason
        self._bound_s = bound_s
        self._stand_s = stand_s
        self._clock = clock or SystemClock()
        self._pause = pause
        self._unknown = ""
        self._lock = threading.Lock()
        self._status: DrainStatus | None = None
        self._over = threading.Event()

    @property
    def status(self) -> DrainStatus | None:
        """The stage of the drain; None before `begin`."""
        return self._status

    @property
    def limit_s(self) -> float:
        """Seconds that the drain takes at most, unless something hangs."""
        return self._bound_s + self._stand_s

    def begin(self, by: str) -> None:
        """Begin on a new thread; do nothing if it has begun. `by` names who asks, for people."""
        with self._lock:
            if self._status is not None:
                return
            self._status = DrainStatus.DRAINING
        # A daemon: a goal or a body that hangs must not keep the process alive.
        threading.Thread(target=self._run, args=(by,), name="edgevox-drain", daemon=True).start()

    def until_over(self, by: str) -> bool:
        """Begin if it has not begun, and block until it is over; False if something hangs."""
        self.begin(by)
        return self._over.wait(self.limit_s + 4 * LOOK_S)

    def stand(self) -> None:
        """End all motion at once, and refuse motion from now on."""
        try:
            self._interlock.engage(Holder.DRAIN, self._reason)
        finally:
            self.halt()  # also if a listener raised, and for motion that no goal steers

    def halt(self) -> None:
        """Brake the body directly, for the case that everything else hangs."""
        self._halt(str(self._reason))

    def _run(self, by: str) -> None:
        try:
            self._interlock.refuse(Holder.DRAIN, self._reason)
            self._bus.publish(DrainChanged(DrainStatus.DRAINING, by, self._bound_s))
            self._wait_until(lambda: not self._busy(), self._bound_s)
        except Exception:
            log.exception("drain_failed")
        finally:
            self._finish(by)

    def _finish(self, by: str) -> None:
        ended = DrainStatus.NOT_STANDING
        try:
            self._stand_as_told()
            if self._wait_until(self._stands, self._stand_s):
                ended = DrainStatus.DRAINED
            elif self._unknown:
                log.warning("drain_unsure", reason=self._unknown)
        except Exception:
            log.exception("drain_failed")
        finally:
            self._status = ended
            self._bus.publish(DrainChanged(ended, by, 0.0))  # before `until_over` lets ROS 2 close
            self._over.set()

    def _stand_as_told(self) -> None:
        try:
            self.stand()
        except EdgeVoxError as error:  # go on: the wait below still looks whether the body stands
            self._unknown = str(error)

    def _wait_until(self, so: Callable[[], bool], within_s: float) -> bool:
        now_s = self._clock.now()
        until_s, blind_until_s = now_s + within_s, now_s + BLIND_S
        while not self._is_known(so):
            now_s = self._clock.now()
            if not self._unknown:
                blind_until_s = now_s + BLIND_S
            if now_s >= min(until_s, blind_until_s):
                return False
            self._pause(LOOK_S)
        return True

    def _is_known(self, so: Callable[[], bool]) -> bool:
        """The result of `so`; False while the body cannot tell, for example without odometry."""
        try:
            known = so()
        except EdgeVoxError as error:
            self._unknown = str(error)
            return False
        self._unknown = ""
        return known
