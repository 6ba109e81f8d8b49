"""A sign of life: whoever does the work beats, whoever watches asks how long ago that was."""

from edgevox.core.clock import Clock, SystemClock


class Heartbeat:
    """Counts from its making on. `beat` may be called from any thread."""

    def __init__(self, clock: Clock | None = None) -> None:
        self._clock = clock or SystemClock()
        self._beat_s = self._clock.now()

    def beat(self) -> None:
        """Here I am."""
        self._beat_s = self._clock.now()

    @property
    def silent_s(self) -> float:
        """Seconds since the last beat."""
        return max(0.0, self._clock.now() - self._beat_s)
