"""Speech handed to another player, such as a speaker node of ROS 2."""

from collections.abc import Callable

from edgevox.voice.audio import RATE_HZ, Samples

BLOCK_S = 0.04
LEAD_S = 0.06
"""Seconds of sound that wait in the other player's queue, and are still heard after a stop."""


class Relay:
    """An output that sends its sound on at 16 kHz, in blocks, a little before they are due.

    Between utterances it sends nothing. Sound before `connect` is lost.
    """

    name = "audio_out"
    rate_hz = RATE_HZ
    block_s = BLOCK_S
    lead_s = LEAD_S

    def __init__(self) -> None:
        self._send: Callable[[Samples], None] | None = None

    def connect(self, send: Callable[[Samples], None]) -> None:
        """Send every block to `send` from now on, on the thread that speaks."""
        self._send = send

    def write(self, samples: Samples, start_s: float) -> None:  # noqa: ARG002
        if self._send:
            self._send(samples)

    def close(self) -> None:
        self._send = None
