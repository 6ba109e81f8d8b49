"""Where a paced sink puts its sound, and the output that keeps nothing."""

from typing import Protocol

from edgevox.voice.audio import Samples


class PacedOutput(Protocol):
    """Takes sound when it is due. Used under the sink's lock."""

    name: str
    rate_hz: int
    block_s: float
    """How much sound it is given at once."""
    lead_s: float
    """How early it is given its sound."""

    def write(self, samples: Samples, start_s: float) -> None:
        """Sound at `rate_hz` that is heard from the clock's time `start_s` on."""

    def close(self) -> None: ...


class Silence:
    """Nowhere: speech takes its time, and nothing is heard."""

    name = "none"
    rate_hz = 16_000
    block_s = 0.1
    lead_s = 0.0

    def write(self, samples: Samples, start_s: float) -> None: ...

    def close(self) -> None: ...
