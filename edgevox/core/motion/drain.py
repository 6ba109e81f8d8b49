"""A drain: nothing new begins, what moves may end within a bound, and then the robot stands.

It has no way back: whoever wants the robot to work again starts the agent again.
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
"""How often it looks whether the goals are over, and whether the robot stands."""
BLIND_S = 2.0
"""A body that cannot tell for so long whether it stands is not waited for any longer."""


class Drain:
    """From `begin` on every new motion is refused with the `reason`. Any thread may call it.

    Goals have `bound_s` to end by themselves; then `halt` and the interlock end them, and `stands`
    is waited for, `stand_s` at most. Stop words work as ever: they end a goal, and so the wait.
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
        """How far it is; None before it was begun."""
        return self._status

    @property
    def limit_s(self) -> float:
        """How long it takes at most, unless something hangs."""
        return self._bound_s + self._stand_s

    def begin(self, by: str) -> None:
        """Begin, on a thread of its own, unless that was done; `by` is who asks, for people."""
        with self._lock:
            if self._status is not None:
                return
            self._status = DrainStatus.DRAINING
        # A daemon: what it waits for may hang, and must not keep the process.
        threading.Thread(target=self._run, args=(by,), name="edgevox-drain", daemon=True).start()

    def until_over(self, by: str) -> bool:
        """Begin if nobody has, and block until it is over; False if something hangs."""
        self.begin(by)
        return self._over.wait(self.limit_s + 4 * LOOK_S)

    def stand(self) -> None:
        """End what moves at once, and refuse all motion from now on."""
        try:
            self._interlock.engage(Holder.DRAIN, self._reason)
        finally:
            self.halt()  # also where a listener broke, and for whoever steers without a goal

    def halt(self) -> None:
        """Brake the body and ask nobody: for when everything else hangs."""
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
            self._bus.publish(DrainChanged(ended, by, 0.0))  # before who waits takes ROS 2 away
            self._over.set()

    def _stand_as_told(self) -> None:
        try:
            self.stand()
        except EdgeVoxError as error:  # the body says why; whether it stands is looked at anyway
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
        """Whether it is so; not while the body cannot tell, its odometry being silent for one."""
        try:
            known = so()
        except EdgeVoxError as error:
            self._unknown = str(error)
            return False
        self._unknown = ""
        return known
