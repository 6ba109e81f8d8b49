"""A source of sound that is in memory already, for tests and benchmarks."""

from edgevox.core.clock import Clock, SystemClock
from edgevox.voice.audio import FRAME_S, FRAME_SAMPLES, EndOfSound, Frame, Samples


class InMemory:
    """Plays samples at 16 kHz as fast as they are read, `times` over, then raises `EndOfSound`.

    A frame's time is that of its samples, counted from `start`. An incomplete frame at the end is
    left out.
    """

    name = "memory"

    def __init__(self, samples: Samples, *, times: int = 1, clock: Clock | None = None) -> None:
        count = samples.size // FRAME_SAMPLES
        self._frames = samples[: count * FRAME_SAMPLES].reshape(count, FRAME_SAMPLES)
        self._total = count * times
        self._clock = clock or SystemClock()
        self._started_s = 0.0
        self._read = 0

    @property
    def heard_s(self) -> float:
        """Seconds of sound that were read so far."""
        return self._read * FRAME_S

    def start(self) -> None:
        self._started_s = self._clock.now()

    def read(self, timeout_s: float) -> Frame | None:  # noqa: ARG002 - it never waits
        if self._read >= self._total:
            raise EndOfSound(f"{self.name}: all of it was heard")
        samples = self._frames[self._read % len(self._frames)]
        self._read += 1
        return Frame(samples, self._started_s + self.heard_s)

    def close(self) -> None:
        self._total = self._read
