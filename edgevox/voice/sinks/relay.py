"""Speech handed to whoever plays it elsewhere, such as a speaker node of ROS 2."""

from collections.abc import Callable

from edgevox.voice.audio import RATE_HZ, Samples

BLOCK_S = 0.04
LEAD_S = 0.06
"""So much waits in the other loudspeaker's queue, and is still heard after a stop."""


class Relay:
    """An output that sends its sound on at 16 kHz, in blocks, a little before they are due.

    Between utterances it sends nothing. What comes before `connect` is lost.
    """

    name = "audio_out"
    rate_hz = RATE_HZ
    block_s = BLOCK_S
    lead_s = LEAD_S

    def __init__(self) -> None:
        self._send: Callable[[Samples], None] | None = None

    def connect(self, send: Callable[[Samples], None]) -> None:
        """From now on, every block goes there, on the thread of whoever speaks."""
        self._send = send

    def write(self, samples: Samples, start_s: float) -> None:  # noqa: ARG002
        if self._send:
            self._send(samples)

    def close(self) -> None:
        self._send = None
