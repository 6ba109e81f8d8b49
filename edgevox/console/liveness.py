"""Whether the console still answers: its thread, its loop, and who lets connections in."""

import asyncio
from collections.abc import Callable

from edgevox.console.door import Door
from edgevox.core.clock import Clock
from edgevox.core.status import STALL_S, lives

BEAT_S = 1.0


class Liveness:
    """`why_not` may be asked from any thread, all else belongs to the loop's."""

    def __init__(self, clock: Clock, is_alive: Callable[[], bool]) -> None:
        self._clock = clock
        self._thread = lives(is_alive)
        self._door: Door | None = None
        self._letting_in: asyncio.Task[None] | None = None
        self._beat_s: float | None = None

    def watch(self, door: Door, letting_in: "asyncio.Task[None]") -> None:
        """From now on it is alive only while this task lets connections in by this door."""
        self._door, self._letting_in = door, letting_in

    async def beat(self) -> None:
        """Say that the loop goes round, until it is cancelled."""
        while True:
            self._beat_s = self._clock.now()
            await asyncio.sleep(BEAT_S)

    def why_not(self) -> str:
        """Why nobody who comes now is answered; empty if they are."""
        if ended := self._thread():
            return ended
        if self._letting_in and self._letting_in.done():
            return "nobody is let in any more"
        if self._beat_s is not None and self._clock.now() - self._beat_s > STALL_S:
            return "its loop stands still"
        shut = "" if self._door is None else self._door.shut
        return f"nobody is let in: {shut}" if shut else ""
