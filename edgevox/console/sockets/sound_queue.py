"""What of the robot's speech is still to be sent to a page, and how late a page's own sound is."""

import asyncio
import struct
from collections import deque
from typing import Protocol

from edgevox.console.outbox import SEND_S
from edgevox.core.clock import Clock

AUDIO, FLUSH = 0, 1
HEAD = struct.Struct("<BII")
"""Kind, turn and the robot's milliseconds, which start over at 2**32, before the samples."""
PIECE_BYTES = 640
MOST_PIECES = 64
MOST_TOLD = 16
DRIFT = 2000
"""The clocks of page and robot may part by a millisecond in so many; none is worse."""
_WRAP = 1 << 32


class Lateness:
    """How much later sound comes than the most prompt of late; both clocks count milliseconds."""

    def __init__(self) -> None:
        self._least = 0.0
        self._at_ms: int | None = None

    def of(self, now_ms: int, sent_ms: int) -> float:
        """Milliseconds, not below 0. `sent_ms` starts over at 2**32."""
        if self._at_ms is None:
            self._least = float(now_ms - sent_ms)
        else:
            self._least += (now_ms - self._at_ms) / DRIFT
        self._at_ms = now_ms
        late = (now_ms - sent_ms - self._least + _WRAP / 2) % _WRAP - _WRAP / 2
        if late < 0:
            self._least += late
        return max(0.0, late)


class SendsSound(Protocol):
    """A WebSocket, as much of it as sends."""

    async def send_bytes(self, data: bytes) -> None: ...

    async def send_str(self, data: str) -> None: ...


class SoundQueue:
    """Pieces of 20 ms, each only while it is younger than `old_s`. Belongs to the loop's thread.

    Words about the state go first; a flush takes the place of all sound before it.
    """

    def __init__(self, clock: Clock, old_s: float) -> None:
        self._clock = clock
        self._old_s = old_s
        self._sound: deque[tuple[float, int, bytes]] = deque(maxlen=MOST_PIECES)
        self._told: deque[str] = deque(maxlen=MOST_TOLD)
        self._flush = False
        self._turn = 0
        self._ready = asyncio.Event()

    def put(self, turn: int, pcm: bytes) -> None:
        """Send these samples, from now on."""
        self._turn, now_s = turn, self._clock.now()
        for at in range(0, len(pcm), PIECE_BYTES):
            self._sound.append((now_s, turn, pcm[at : at + PIECE_BYTES]))
        self._ready.set()

    def flush(self) -> None:
        """Send nothing of what waits, and have the page play nothing of what it has."""
        self._sound.clear()
        self._flush = True
        self._ready.set()

    def tell(self, text: str) -> None:
        """Send this before any sound."""
        self._told.append(text)
        self._ready.set()

    async def send_all(self, socket: SendsSound) -> None:
        """Send until it cannot. Raises what the socket raises, and `TimeoutError`."""
        while True:
            await self._ready.wait()
            async with asyncio.timeout(SEND_S):
                if self._told:
                    await socket.send_str(self._told.popleft())
                elif self._flush:
                    self._flush = False
                    await socket.send_bytes(self._head(FLUSH, self._turn, self._clock.now()))
                elif self._sound:
                    at_s, turn, pcm = self._sound.popleft()
                    if self._clock.now() - at_s <= self._old_s:
                        await socket.send_bytes(self._head(AUDIO, turn, at_s) + pcm)
                else:
                    self._ready.clear()

    def _head(self, kind: int, turn: int, at_s: float) -> bytes:
        return HEAD.pack(kind, turn % _WRAP, round(at_s * 1000) % _WRAP)
