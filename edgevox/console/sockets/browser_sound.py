"""The socket `/ws/sound`: a page's microphone to the robot's ears, and the robot's speech back.

Only the operator with the lease is heard. Old sound is dropped, both ways: nothing that was said
before a gap in the connection is acted on after it. `SoundQueue` holds the speech for a page;
`Lateness` measures the delay of the page's own sound.
"""

import asyncio
import itertools
import json
import struct
from collections import deque
from collections.abc import Callable
from contextlib import suppress
from typing import Literal, Protocol

import numpy as np
from aiohttp import WSMsgType, web
from pydantic import BaseModel, ConfigDict, TypeAdapter, ValidationError

from edgevox.console.context import ConsoleSound
from edgevox.console.limits import PageRateLimit
from edgevox.console.outbox import SEND_S
from edgevox.console.page_hub import FLOOD, GONE, SLOW, PageHub
from edgevox.console.sessions import Role, Session
from edgevox.core.clock import Clock

AUDIO, FLUSH = 0, 1
SENT_HEAD = struct.Struct("<BII")
"""Kind, turn and the robot's milliseconds, which start over at 2**32, before the samples."""
PIECE_BYTES = 640
MOST_PIECES = 64
MOST_TOLD = 16
DRIFT = 2000
"""The clocks of page and robot may part by a millisecond in so many; none is worse."""
_WRAP = 1 << 32


class Lateness:
    """The delay of sound against the promptest recent sound; both clocks count milliseconds."""

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
    """Pieces of 20 ms, each sent only while it is younger than `old_s`. For the loop's thread.

    State messages go first; a flush replaces all sound before it.
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
        return SENT_HEAD.pack(kind, turn % _WRAP, round(at_s * 1000) % _WRAP)


MOST_BYTES = 1024
"""The most bytes of one message from a page."""
OLD_S = 0.2
"""Sound later than this is not taken, and not sent."""
HOLE_S = 1.0
"""Sound later than this came after a gap, which ends the connection: the unfinished utterance
does not count, and the clocks are no longer trusted."""
HEAD = struct.Struct("<II")
"""Before the samples of a page: sequence, and the page's milliseconds; both start over at 2**32."""
FRAME_BYTES = 640
"""20 ms of samples, 16 bit little-endian, 16 kHz, mono."""
PER_S, BURST = 75.0, 250
"""Messages of one page: half as many again as it sends, and what a hole in the line held back."""
LOOK_S = 0.5
"""Seconds between checks whether a page may go on."""


class Talk(BaseModel):
    """The talk button is held, or let go: speech meanwhile is for the robot."""

    model_config = ConfigDict(extra="forbid", strict=True)
    type: Literal["talk"]
    held: bool


class Open(BaseModel):
    """The microphone is open: the speaker says the wake word, if there is one."""

    model_config = ConfigDict(extra="forbid", strict=True)
    type: Literal["open"]
    on: bool


class Hear(BaseModel):
    """The page plays what the robot says."""

    model_config = ConfigDict(extra="forbid", strict=True)
    type: Literal["hear"]
    on: bool


_ASKED: TypeAdapter[Talk | Open | Hear] = TypeAdapter(Talk | Open | Hear)


class SoundLine:
    """The one microphone that pages share. Belongs to the loop's thread."""

    def __init__(self, hub: PageHub, sound: ConsoleSound, clock: Clock) -> None:
        self.hub = hub
        self.sound = sound
        self.clock = clock
        self.limit = PageRateLimit(clock, PER_S, BURST)
        self._numbers = itertools.count(1)

    def may_speak(self, session: Session) -> bool:
        """Return whether the session is an operator's that holds the lease."""
        return session.role is Role.OPERATOR and self.hub.lease.state.holder == session.id

    def client(self, session: Session) -> str:
        """A name for one more page of this session."""
        return f"{session.id}.{next(self._numbers)}"


class SoundPage:
    """A page on `/ws/sound`, from `run` until it is gone."""

    def __init__(self, line: SoundLine, session: Session, socket: web.WebSocketResponse) -> None:
        self._line = line
        self._session = session
        self._socket = socket
        self._client = line.client(session)
        self._held = self._on = self._speaks = self._hole = False
        self._lateness = Lateness()
        self._queue = SoundQueue(line.clock, OLD_S)
        self._forget: Callable[[], None] | None = None

    async def run(self) -> None:
        """Hear it, and let it hear, until it is gone."""
        tasks = [
            asyncio.create_task(self._send()),
            asyncio.create_task(self._watch()),
        ]
        try:
            async for told in self._socket:
                if not self._line.limit.allows(self._client):
                    await self._socket.close(code=FLOOD)
                elif told.type is WSMsgType.BINARY:
                    self._take(told.data)
                    if self._hole:
                        await self._socket.close(code=SLOW)
                elif told.type is WSMsgType.TEXT:
                    self._heed(told.data)
                else:
                    break
        finally:
            self._fall_silent()
            self._hear(on=False)
            for task in tasks:
                task.cancel()
            await asyncio.gather(*tasks, return_exceptions=True)

    async def _send(self) -> None:
        try:
            await self._queue.send_all(self._socket)
        except (OSError, RuntimeError, TimeoutError):
            self._fall_silent()
            self._hear(on=False)
            await self._socket.close(code=SLOW)

    async def _watch(self) -> None:
        """Mute a page that may no longer speak, and disconnect one whose session has ended."""
        while self._line.hub.sessions.is_there(self._session):
            self._may_go_on()
            await asyncio.sleep(LOOK_S)
        self._fall_silent()
        self._hear(on=False)
        await self._socket.close(code=GONE)

    def _heed(self, text: str) -> None:
        try:
            asked = _ASKED.validate_json(text)
        except ValidationError:
            self._tell("failed")
            return
        match asked:
            case Hear(on=on):
                self._hear(on=on)
            case Talk(held=held):
                self._held = held
                self._speak(ended=not held)
            case Open(on=on):
                self._on = on
                self._speak(ended=False)

    def _speak(self, *, ended: bool) -> None:
        """Begin, go on otherwise, or cease; what was being said counts if it was `ended`."""
        sound = self._line.sound
        if not (self._held or self._on):
            if self._speaks:
                (sound.close if ended else sound.abandon)(self._client)
            self._speaks = False
            self._tell("closed")
            return
        if not self._line.may_speak(self._session) or not sound.open(self._client, held=self._held):
            self._fall_silent()
            self._tell("busy")
            return
        self._speaks = True
        self._tell("held" if self._held else "open")

    def _take(self, data: bytes) -> None:
        if len(data) != HEAD.size + FRAME_BYTES or not self._speaks or not self._may_go_on():
            return
        _, sent_ms = HEAD.unpack_from(data)
        now_ms = round(self._line.clock.now() * 1000)
        late_s = self._lateness.of(now_ms, sent_ms) / 1000
        if late_s > HOLE_S:
            self._hole = True
            self._fall_silent()
        if late_s > OLD_S:
            return
        if self._held:
            self._line.hub.lease.used(self._session.id)
        samples = np.frombuffer(data, "<i2", offset=HEAD.size).astype(np.int16)
        self._line.sound.push(self._client, samples)

    def _may_go_on(self) -> bool:
        if self._speaks and not self._line.may_speak(self._session):
            self._fall_silent()
            self._tell("busy")
        return self._speaks

    def _fall_silent(self) -> None:
        """Abandon the utterance: it does not count."""
        self._held = self._on = False
        if self._speaks:
            self._speaks = False
            self._line.sound.abandon(self._client)

    def _hear(self, *, on: bool) -> None:
        if on and self._forget is None:
            loop = asyncio.get_running_loop()
            self._forget = self._line.sound.listen(
                lambda turn, pcm: _soon(loop, lambda: self._queue.put(turn, pcm)),
                lambda: _soon(loop, self._queue.flush),
            )
        elif not on and self._forget:
            self._forget()
            self._forget = None
            self._queue.flush()

    def _tell(self, state: str) -> None:
        self._queue.tell(json.dumps({"type": "state", "state": state}))


def _soon(loop: asyncio.AbstractEventLoop, act: Callable[[], object]) -> None:
    """Call `act` on the loop's thread, from any other; do nothing if the loop was just closed."""
    with suppress(RuntimeError):
        loop.call_soon_threadsafe(act)
