"""The socket `/ws/view`: pictures, the newest only, the next one after the page has this one."""

import asyncio

from aiohttp import WSMsgType, web

from edgevox.console.context import ConsoleRobot
from edgevox.console.hub import Hub

PERIOD_S = 0.2
"""A picture is made at most so often, however many look."""
ACK = "ack"


class Pictures:
    """Makes pictures for all who look; one at a time."""

    def __init__(self, hub: Hub, robot: ConsoleRobot) -> None:
        self._hub = hub
        self._robot = robot
        self._lock = asyncio.Lock()
        self._made_s = float("-inf")
        self._number = 0
        self._picture: bytes | None = None

    async def after(self, number: int) -> tuple[int, bytes]:
        """One newer than that of this number, as soon as there is one; with its own number."""
        loop = asyncio.get_running_loop()
        while True:
            async with self._lock:
                if self._number <= number or self._picture is None:
                    await asyncio.sleep(self._made_s + PERIOD_S - loop.time())
                    self._made_s = loop.time()
                    self._picture = await self._hub.work(self._robot.picture)
                    self._number += 1
                if self._picture is not None:
                    return self._number, self._picture


async def show(pictures: Pictures, socket: web.WebSocketResponse) -> None:
    """Send pictures to a page until it is gone."""
    number = 0
    async for told in socket:
        if told.type is not WSMsgType.TEXT or told.data != ACK:
            break
        number, picture = await pictures.after(number)
        async with asyncio.timeout(10):
            await socket.send_bytes(picture)
