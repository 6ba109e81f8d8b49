"""The console's HTTP answers beside `Access`: downloads, the sockets, and pictures on `/ws/view`.

A page gets the newest picture only, and the next one when it has that one.
"""

import asyncio
from collections.abc import Callable
from dataclasses import dataclass
from urllib.parse import quote

from aiohttp import WSMsgType, web

from edgevox.console.access import Access
from edgevox.console.context import ConsoleRobot
from edgevox.console.door import cut
from edgevox.console.limits import PageRateLimit
from edgevox.console.outbox import SEND_S
from edgevox.console.page_hub import GONE, PageHub
from edgevox.console.sessions import Role
from edgevox.console.sockets.browser_sound import MOST_BYTES as MOST_SOUND
from edgevox.console.sockets.browser_sound import SoundLine, SoundPage
from edgevox.console.sockets.control import ControlPage, SocketLimits
from edgevox.console.sockets.messages import MOST_BYTES
from edgevox.core.log import get_logger

log = get_logger(__name__)

DOWNLOADS_PER_S, DOWNLOADS = 0.5, 20


@dataclass
class Site:
    """The routes of a robot, and what they need."""

    hub: PageHub
    access: Access

    def __post_init__(self) -> None:
        clock = self.access.clock
        self._downloads = PageRateLimit(clock, DOWNLOADS_PER_S, DOWNLOADS)
        self._limits = SocketLimits.usual(clock, self.access.bad)
        robot = self.hub.context.robot
        self._pictures = PictureSocket(self.hub, robot) if robot else None
        sound = self.hub.context.sound
        self._sounds = SoundLine(self.hub, sound, clock) if sound else None

    def application(self) -> web.Application:
        """All of it."""
        app = self.access.application()
        app.router.add_get("/api/recording/{name}", self._recording)
        app.router.add_get("/ws", self._control)
        app.router.add_get("/ws/view", self._view)
        app.router.add_get("/ws/sound", self._sound)
        return app

    # Downloads

    async def _recording(self, request: web.Request) -> web.StreamResponse:
        session = self.access.session(request)
        if session.role is not Role.OPERATOR:  # it has what people said
            raise web.HTTPForbidden(text="operators only")
        if not self._downloads.allows(session.id):
            raise web.HTTPTooManyRequests(text="wait a moment")
        recorder, name = self.hub.context.recorder, request.match_info["name"]
        for file in await self.hub.work(recorder.files) if recorder else ():
            if file.name == name:
                log.info("console_recording_asked", session=session.id, action="take", name=name)
                return web.FileResponse(file, headers=_attachment(name))
        raise web.HTTPNotFound

    # The sockets

    async def _control(self, request: web.Request) -> web.StreamResponse:
        session = self.access.own_session(request)
        mark = self.hub.context.interlock.mark  # of what it may say as soon as it is let in
        socket = await _socket(request, MOST_BYTES, autoping=False)
        transport = request.transport
        page = ControlPage(
            self.hub,
            session,
            socket,
            self._limits,
            lambda: cut(transport),
            mark=mark,
        )
        await page.run(request.query.get("language", self.hub.context.controls.language))
        return socket

    async def _view(self, request: web.Request) -> web.StreamResponse:
        session = self.access.own_session(request)
        if self._pictures is None:
            raise web.HTTPNotFound
        socket = await _socket(request, 64)

        def wanted() -> bool:
            return request.transport is not None and self.hub.sessions.is_there(session)

        await show(self._pictures, socket, wanted)
        return socket

    async def _sound(self, request: web.Request) -> web.StreamResponse:
        session = self.access.own_session(request)
        if self._sounds is None:
            raise web.HTTPNotFound
        socket = await _socket(request, MOST_SOUND)
        await SoundPage(self._sounds, session, socket).run()
        return socket


async def _socket(
    request: web.Request, most_bytes: int, *, autoping: bool = True
) -> web.WebSocketResponse:
    if "Sec-WebSocket-Protocol" in request.headers:  # aiohttp would log what it asks for
        raise web.HTTPBadRequest(text="expected no protocol")
    socket = web.WebSocketResponse(
        max_msg_size=most_bytes,
        compress=False,
        heartbeat=20.0,
        autoping=autoping,
        writer_limit=MOST_BYTES,
    )
    await socket.prepare(request)
    return socket


def _attachment(name: str) -> dict[str, str]:
    return {
        "Content-Disposition": f"attachment; filename*=UTF-8''{quote(name, safe='')}",
        "Cache-Control": "no-store",
    }


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
