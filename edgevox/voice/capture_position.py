"""Where in time a microphone's frames were captured, though each arrives late by another while."""

from collections import deque

from edgevox.voice.audio import FRAME_S, FRAME_SAMPLES, RATE_HZ

WINDOW_FRAMES = 64
"""2 s: the frame of these that came least late tells the time of all."""
LOST_S = 0.25
"""A frame that comes so much later than due does not follow on the one before."""
SLIP_SAMPLES = 16
"""1 ms: so far apart, the positions are set right while nothing is played."""
JUMP_SAMPLES = 320
"""20 ms: so far apart, they are set right at once, because sound was lost."""


class CapturePosition:
    """Gives each frame the position of its first sample in the clock's time, in samples.

    One frame follows on the other without a gap, since a canceller would have to learn anew after
    each; where the clocks drift apart or sound is lost, the position jumps, best in silence.
    """

    def __init__(self) -> None:
        self._late: deque[float] = deque(maxlen=WINDOW_FRAMES)
        self._count = 0
        self._next = 0

    def take(self, end_s: float, *, quiet: bool) -> int:
        """The position of the frame whose last sample arrived at `end_s`."""
        self._count += 1
        late_s = end_s - self._count * FRAME_S
        if self._late and late_s - min(self._late) > LOST_S:
            self._late.clear()
        begins = not self._late
        self._late.append(late_s)
        wanted = round((min(self._late) + (self._count - 1) * FRAME_S) * RATE_HZ)
        apart = abs(wanted - self._next)
        if begins or apart > JUMP_SAMPLES or (quiet and apart > SLIP_SAMPLES):
            self._next = wanted
        position, self._next = self._next, self._next + FRAME_SAMPLES
        return position
