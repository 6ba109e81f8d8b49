"""The console's HTTP answers: the page, pairing, and the sockets.

Also here: the headers that restrict the browser, and the test for requests from the console's own
page.
"""

import asyncio
import json
from collections.abc import Awaitable, Callable
from dataclasses import dataclass
from urllib.parse import quote, urlsplit

from aiohttp import web

from edgevox.console.door import Door, cut
from edgevox.console.limits import UNREADABLE, BadRequest, BadRequests, PageRateLimit
from edgevox.console.page_files import PageFiles
from edgevox.console.page_hub import PageHub
from edgevox.console.sessions import LAST_S, Pairing, Role, Session
from edgevox.console.sockets.browser_sound import MOST_BYTES as MOST_SOUND
from edgevox.console.sockets.browser_sound import SoundLine, SoundPage
from edgevox.console.sockets.control import ControlPage, SocketLimits
from edgevox.console.sockets.messages import MOST_BYTES
from edgevox.console.sockets.pictures import PictureSocket, show
from edgevox.core.clock import Clock
from edgevox.core.files.text import clean
from edgevox.core.log import get_logger

log = get_logger(__name__)


_POLICY = "; ".join(
    (
        "default-src 'none'",
        "script-src 'self'",
        "style-src 'self'",
        "img-src 'self' blob: data:",
        "connect-src 'self'",
        "media-src 'self' blob:",
        "manifest-src 'self'",
        "worker-src 'self'",
        "form-action 'self'",
        "base-uri 'none'",
        "frame-ancestors 'none'",
    )
)
HEADERS = {
    "Content-Security-Policy": _POLICY,
    "X-Content-Type-Options": "nosniff",
    "X-Frame-Options": "DENY",
    "Referrer-Policy": "no-referrer",
    "Cross-Origin-Opener-Policy": "same-origin",
    "Cross-Origin-Resource-Policy": "same-origin",
    "Permissions-Policy": "microphone=(self), camera=(), geolocation=()",
    "Server": "edgevox",
}


async def add_headers(_request: web.Request, response: web.StreamResponse) -> None:
    """Put them on an answer that is about to leave."""
    response.headers.update(HEADERS)
    response.headers.setdefault("Cache-Control", "no-cache")


def is_own_origin(request: web.BaseRequest) -> bool:
    """Return whether a page of this server asks.

    Its `Origin` exists, and equals the request's host.
    """
    try:
        origin = urlsplit(request.headers.get("Origin", ""))
    except ValueError:  # half an address
        return False
    return origin.scheme in ("http", "https") and origin.netloc.lower() == request.host.lower()


MOST_BODY = 4096
MOST_NAME = 40
"""The most characters of a browser's name."""
_SESSION = web.RequestKey("session", Session)
"""The key of a request's session, if it shows one."""
DOWNLOADS_PER_S, DOWNLOADS = 0.5, 20
PAIR_TRIES = 5
"""Pairing attempts per minute and address."""


@dataclass
class Site:
    """The routes, and what they need. `door` is set as soon as there is one."""

    hub: PageHub
    pairing: Pairing
    clock: Clock
    secure: bool
    bad: BadRequests
    authority: bytes | None = None
    door: Door | None = None

    def __post_init__(self) -> None:
        self._tries = PageRateLimit(self.clock, PAIR_TRIES / 60, PAIR_TRIES)
        self._downloads = PageRateLimit(self.clock, DOWNLOADS_PER_S, DOWNLOADS)
        self._limits = SocketLimits.usual(self.clock, self.bad)
        self._pairs = asyncio.Lock()
        self._files = PageFiles()
        self.cookie = "__Host-edgevox" if self.secure else "edgevox"
        robot = self.hub.context.robot
        self._pictures = PictureSocket(self.hub, robot) if robot else None
        sound = self.hub.context.sound
        self._sounds = SoundLine(self.hub, sound, self.clock) if sound else None

    def application(self) -> web.Application:
        """All of it."""
        app = web.Application(client_max_size=MOST_BODY, middlewares=[self._recognise])
        app.on_response_prepare.append(add_headers)
        app.router.add_get("/", self._index)
        app.router.add_get("/ca.crt", self._certificate)
        app.router.add_get("/ca", self._instructions)
        app.router.add_post("/api/pair", self._pair)
        app.router.add_get("/api/me", self._me)
        app.router.add_post("/api/logout", self._logout)
        app.router.add_get("/api/recording/{name}", self._recording)
        app.router.add_get("/ws", self._control)
        app.router.add_get("/ws/view", self._view)
        app.router.add_get("/ws/sound", self._sound)
        self._files.add_to(app.router)
        return app

    def session(self, request: web.Request) -> Session:
        """Return the request's session. Raises 401 if there is none."""
        if _SESSION not in request:
            raise web.HTTPUnauthorized(text="pair first")
        return request[_SESSION]

    def own_session(self, request: web.Request) -> Session:
        """The same, of a request that this server's own page makes. Raises 403 for another's."""
        if not is_own_origin(request):
            self.bad.count(BadRequest.ORIGIN)
            raise web.HTTPForbidden(text="another page asks")
        return self.session(request)

    @web.middleware
    async def _recognise(
        self, request: web.Request, handler: Callable[[web.Request], Awaitable[web.StreamResponse]]
    ) -> web.StreamResponse:
        """Identify the session, and tell the door, even for requests of parts of the page."""
        shown = _cookie(request, self.cookie)
        session = self.hub.sessions.of_cookie(shown)
        if session:
            request[_SESSION] = session
            if self.door:
                self.door.knows(request.protocol, session.id)
        elif shown:
            self.bad.count(BadRequest.COOKIE)
        try:
            return await handler(request)
        except web.HTTPException:
            raise
        except UNREADABLE:
            self.bad.count(BadRequest.HTTP)
            raise web.HTTPBadRequest(text="expected another request") from None

    # The page

    async def _index(self, request: web.Request) -> web.StreamResponse:
        return self._files.document(request, "index.html", paired=_SESSION in request)

    async def _certificate(self, _request: web.Request) -> web.Response:
        if self.authority is None:
            raise web.HTTPNotFound
        return web.Response(body=self.authority, content_type="application/x-x509-ca-cert")

    async def _instructions(self, request: web.Request) -> web.StreamResponse:
        if self.authority is None:
            raise web.HTTPNotFound(text="this robot has no certificate of its own making")
        return self._files.document(request, "ca.html")

    # Letting in

    async def _pair(self, request: web.Request) -> web.Response:
        if not is_own_origin(request):
            self.bad.count(BadRequest.ORIGIN)
            raise web.HTTPForbidden(text="another page asks")
        address = request.remote or ""
        if not self._tries.allows(address):
            raise web.HTTPTooManyRequests(text="wait a minute")
        told, named = await _pairing_request(request)
        work = self.hub.work  # disks are slow: a stop must not wait
        async with self._pairs:  # of two at once with the same code one is let in
            try:
                role = await work(self.pairing.redeem, told)
                if role is None:
                    self.bad.count(BadRequest.CODE)
                    log.warning("console_pairing_refused", address=address)
                    raise web.HTTPForbidden(text="not the code")
                name = await work(self.hub.sessions.free_name, named or _browser(request))
                begun = await work(self.hub.sessions.begin, role, name, address)
            except OSError as error:
                log.error("console_unsaved", error=error.strerror or str(error))  # noqa: TRY400
                raise web.HTTPServiceUnavailable(text="the robot cannot write that down") from None
        session, cookie = begun
        log.info("console_paired", session=session.id, role=str(role), address=address)
        answer = web.json_response(_me(session))
        answer.set_cookie(
            self.cookie,
            cookie,
            max_age=round(LAST_S),
            path="/",
            secure=self.secure,
            httponly=True,
            samesite="Strict",
        )
        return answer

    async def _me(self, request: web.Request) -> web.Response:
        return web.json_response(_me(self.session(request)), headers={"Cache-Control": "no-store"})

    async def _logout(self, request: web.Request) -> web.Response:
        session = self.own_session(request)
        self.hub.sessions.revoke(session.id)
        self.hub.tick()
        answer = web.json_response({})
        answer.del_cookie(
            self.cookie, path="/", secure=self.secure, httponly=True, samesite="Strict"
        )
        return answer

    async def _recording(self, request: web.Request) -> web.StreamResponse:
        session = self.session(request)
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
        session = self.own_session(request)
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
        session = self.own_session(request)
        if self._pictures is None:
            raise web.HTTPNotFound
        socket = await _socket(request, 64)

        def wanted() -> bool:
            return request.transport is not None and self.hub.sessions.is_there(session)

        await show(self._pictures, socket, wanted)
        return socket

    async def _sound(self, request: web.Request) -> web.StreamResponse:
        session = self.own_session(request)
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


def _cookie(request: web.Request, name: str) -> str:
    """Return this cookie's value.

    Aiohttp would log the names of other cookies that it cannot read.
    """
    for header in request.headers.getall("Cookie", ()):
        for part in header.split(";"):
            called, _, value = part.strip().partition("=")
            if called == name:
                return value
    return ""


def _attachment(name: str) -> dict[str, str]:
    return {
        "Content-Disposition": f"attachment; filename*=UTF-8''{quote(name, safe='')}",
        "Cache-Control": "no-store",
    }


async def _pairing_request(request: web.Request) -> tuple[str, str]:
    """Return the pairing code, and the name that the person gives the browser; empty for none."""
    try:
        told = json.loads(await request.read())
        return str(told["code"])[:64], clean(str(told.get("name", "")))[:MOST_NAME].strip()
    except (ValueError, TypeError, LookupError, RecursionError, AttributeError):
        raise web.HTTPBadRequest(text="expected a code") from None


def _browser(request: web.Request) -> str:
    """Return the browser's system and name, as a person knows them."""
    agent = request.headers.get("User-Agent", "")
    systems = ("Android", "iPhone", "iPad", "Windows", "Mac", "Linux")
    names = ("Edg", "OPR", "Firefox", "Chrome", "Safari")
    system = next((one for one in systems if one in agent), "")
    name = next((one for one in names if one in agent), "")
    return f"{name} {system}".strip() or "browser"


def _me(session: Session) -> dict[str, str]:
    return {"role": str(session.role), "name": session.name, "client": session.id}
