"""Ctrl-C once interrupts, twice leaves: the rule that every terminal here keeps."""

from edgevox.core.clock import Clock

SECOND_CTRL_C_S = 2.0
"""A second Ctrl-C within this time leaves."""


class DoubleInterrupt:
    """Tells a second press from a first one."""

    def __init__(self, clock: Clock) -> None:
        self._clock = clock
        self._pressed_s = float("-inf")

    def pressed(self) -> bool:
        """It was pressed now; whether that is the second time."""
        now_s = self._clock.now()
        if now_s - self._pressed_s < SECOND_CTRL_C_S:
            return True
        self._pressed_s = now_s
        return False
