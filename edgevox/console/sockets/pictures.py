"""The socket `/ws/view`: the newest picture only; the next one when the page has this one."""

import asyncio
from collections.abc import Callable

from aiohttp import WSMsgType, web

from edgevox.console.context import ConsoleRobot
from edgevox.console.outbox import SEND_S
from edgevox.console.page_hub import GONE, PageHub

PERIOD_S = 0.2
"""The shortest time between two pictures, however many pages look."""
ACK = "ack"


class PictureSocket:
    """Makes pictures for all who look; one at a time."""

    def __init__(self, hub: PageHub, robot: ConsoleRobot) -> None:
        self._hub = hub
        self._robot = robot
        self._lock = asyncio.Lock()
        self._made_s = float("-inf")
        self._number = 0
        self._picture: bytes | None = None

    async def after(self, number: int, wanted: Callable[[], bool]) -> tuple[int, bytes] | None:
        """Return a picture newer than `number`, with its own number; None once it is not wanted."""
        loop = asyncio.get_running_loop()
        while wanted():
            async with self._lock:
                if self._number <= number or self._picture is None:
                    await asyncio.sleep(self._made_s + PERIOD_S - loop.time())
                    self._made_s = loop.time()
                    self._picture = await self._hub.work(self._robot.picture)
                    self._number += 1
                if self._picture is not None and wanted():
                    return self._number, self._picture
        return None


async def show(
    pictures: PictureSocket, socket: web.WebSocketResponse, wanted: Callable[[], bool]
) -> None:
    """Send pictures to a page until it is gone, or no longer let in."""
    number = 0
    async for told in socket:
        if told.type is not WSMsgType.TEXT or told.data != ACK:
            break
        made = await pictures.after(number, wanted)
        if made is None:
            await socket.close(code=GONE)
            break
        number, picture = made
        async with asyncio.timeout(SEND_S):
            await socket.send_bytes(picture)
