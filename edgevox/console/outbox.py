"""The outbox of a page: messages to send, replaced by newer ones where only the newest counts.

A slow page gets fewer states, never late ones, and never delays another page. A page that does not
even take the messages that must not be left out is disconnected.
"""

import asyncio
from collections import deque
from collections.abc import Callable
from typing import Protocol

MOST_WAITING = 256
"""The most messages that must not be left out."""
SEND_S = 10.0
"""Longest that one message may take to leave."""


class Sends(Protocol):
    """A WebSocket, as much of it as sends."""

    async def send_str(self, data: str) -> None: ...


class Outbox:
    """Belongs to the loop's thread. `overflow` is called once, when the page is too slow."""

    def __init__(self, overflow: Callable[[], None]) -> None:
        self._all: deque[str] = deque()
        self._newest: dict[str, str] = {}
        self._first = ""
        self._ready = asyncio.Event()
        self._overflow = overflow
        self._full = False

    def put(self, text: str) -> None:
        """Send this after all before it."""
        if self._full:
            return
        if len(self._all) >= MOST_WAITING:
            self._full = True
            self._overflow()
            return
        self._all.append(text)
        self._ready.set()

    def put_if_room(self, text: str) -> None:
        """Send this after all before it, or not at all where much waits."""
        if len(self._all) < MOST_WAITING // 2:
            self.put(text)

    def put_first(self, text: str) -> None:
        """Send this before all that waits."""
        self._first = text
        self._ready.set()

    def put_newest(self, kind: str, text: str) -> None:
        """Send this in place of one of its kind that has not left yet."""
        self._newest.pop(kind, None)
        self._newest[kind] = text
        self._ready.set()

    def put_unless_newer(self, kind: str, text: str) -> None:
        """Send this where nothing of its kind waits: what took long to make may be old by now."""
        if kind not in self._newest:
            self.put_newest(kind, text)

    async def send_all(self, socket: Sends) -> None:
        """Send until it cannot. Raises what the socket raises, and `TimeoutError`."""
        while True:
            await self._ready.wait()
            text = self._next()
            if text is None:
                self._ready.clear()
                continue
            async with asyncio.timeout(SEND_S):
                await socket.send_str(text)

    def _next(self) -> str | None:
        if self._first:
            first, self._first = self._first, ""
            return first
        if "stop" in self._newest:
            return self._newest.pop("stop")
        if self._all:
            return self._all.popleft()
        for kind in self._newest:
            return self._newest.pop(kind)
        return None
