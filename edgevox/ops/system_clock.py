"""The machine's clock: whether it was set, and whether the kernel knows it to be synchronised.

Other machines compare a robot's stamps with their own clocks, and a recording is found by its time.
"""

import ctypes
import time
from collections.abc import Callable

from edgevox.core.status import ComponentName, Finding, HealthCheck, Level, Status

_UNSYNCHRONISED = 0x40  # STA_UNSYNC of adjtimex(2)
_STATUS = 10  # after modes (with padding), offset, freq, maxerror and esterror
NEVER_SET_BEFORE_S = 1_704_067_200.0
"""2024: a clock before that was never set."""
NEVER_SET, NOT_SYNCHRONISED = "the clock was never set", "the clock is not synchronised"


def synchronised() -> bool | None:
    """Whether the kernel's clock is synchronised; None where that may not be asked.

    The kernel is told by whoever sets the clock: systemd-timesyncd, ntpd, chrony with ``rtcsync``.
    """
    asked = (ctypes.c_int * 64)()  # struct timex: `modes` first, of zero, so that nothing is set
    try:
        if ctypes.CDLL(None, use_errno=True).adjtimex(asked) < 0:
            return None
    except (OSError, AttributeError):  # not Linux
        return None
    return not asked[_STATUS] & _UNSYNCHRONISED


class ClockComponent:
    """A clock that is not synchronised is a warning, one that was never set an error."""

    name = ComponentName.CLOCK
    checks: tuple[HealthCheck, ...] = ()

    def __init__(
        self,
        is_synchronised: Callable[[], bool | None] = synchronised,
        now_s: Callable[[], float] = time.time,
    ) -> None:
        self._synchronised, self._now_s = is_synchronised, now_s

    def status(self) -> Status:
        """How it is now."""
        known = self._synchronised()
        found = []
        if self._now_s() < NEVER_SET_BEFORE_S:
            found.append(Finding(Level.ERROR, NEVER_SET))
        if known is False:
            found.append(Finding(Level.WARN, NOT_SYNCHRONISED))
        well = "synchronised" if known else "whether it is synchronised cannot be seen here"
        return Status.judged(self.name, found, well=well, synchronised=known)
