"""Who may use a page: pairing, sessions, and the headers that restrict a browser.

`Access` lets browsers in to any page that EdgeVox serves: a robot's console, and the page of a
fleet. It answers with the page's document, the authority's certificate, and the pairing; all else
are routes of the page, which ask it for the request's session.
"""

import asyncio
import json
from collections.abc import Awaitable, Callable
from dataclasses import dataclass
from typing import Any, Protocol
from urllib.parse import urlsplit

from aiohttp import web

from edgevox.console.door import Door
from edgevox.console.limits import UNREADABLE, BadRequest, BadRequests, PageRateLimit
from edgevox.console.page_files import PageFiles
from edgevox.console.sessions import LAST_S, Pairing, Session, Sessions
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
PAIR_TRIES = 5
"""Pairing attempts per minute and address."""


class Work(Protocol):
    """Runs what may take long on a thread of its own."""

    async def __call__(self, function: Callable[..., Any], *arguments: Any) -> Any: ...


@dataclass
class Access:
    """The sessions of a page. `door` is set as soon as there is one.

    hosts: The names under which the page may be asked for; None for any. A site that makes a
        browser believe that its own name is this machine's is then not answered.
    revoked: Called when a session was ended.
    """

    sessions: Sessions
    pairing: Pairing
    clock: Clock
    secure: bool
    bad: BadRequests
    work: Work
    files: PageFiles
    authority: bytes | None = None
    hosts: frozenset[str] | None = None
    cookie: str = "edgevox"
    revoked: Callable[[], None] = lambda: None
    door: Door | None = None

    def __post_init__(self) -> None:
        self._tries = PageRateLimit(self.clock, PAIR_TRIES / 60, PAIR_TRIES)
        self._pairs = asyncio.Lock()
        self.cookie = f"__Host-{self.cookie}" if self.secure else self.cookie

    def application(self) -> web.Application:
        """An application that lets browsers in, without what they are let in to."""
        app = web.Application(client_max_size=MOST_BODY, middlewares=[self._recognise])
        app.on_response_prepare.append(add_headers)
        app.router.add_get("/", self._index)
        app.router.add_get("/ca.crt", self._certificate)
        app.router.add_get("/ca", self._instructions)
        app.router.add_post("/api/pair", self._pair)
        app.router.add_get("/api/me", self._me)
        app.router.add_post("/api/logout", self._logout)
        self.files.add_to(app.router)
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
        if self.hosts is not None and _host_of(request) not in self.hosts:
            self.bad.count(BadRequest.HOST)
            raise web.HTTPMisdirectedRequest(text="this page has another name")
        shown = _cookie(request, self.cookie)
        session = self.sessions.of_cookie(shown)
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
        return self.files.document(request, "index.html", paired=_SESSION in request)

    async def _certificate(self, _request: web.Request) -> web.Response:
        if self.authority is None:
            raise web.HTTPNotFound
        return web.Response(body=self.authority, content_type="application/x-x509-ca-cert")

    async def _instructions(self, request: web.Request) -> web.StreamResponse:
        if self.authority is None:
            raise web.HTTPNotFound(text="this robot has no certificate of its own making")
        return self.files.document(request, "ca.html")

    # Letting in

    async def _pair(self, request: web.Request) -> web.Response:
        if not is_own_origin(request):
            self.bad.count(BadRequest.ORIGIN)
            raise web.HTTPForbidden(text="another page asks")
        address = request.remote or ""
        if not self._tries.allows(address):
            raise web.HTTPTooManyRequests(text="wait a minute")
        told, named = await _pairing_request(request)
        work = self.work  # disks are slow: a stop must not wait
        async with self._pairs:  # of two at once with the same code one is let in
            try:
                role = await work(self.pairing.redeem, told)
                if role is None:
                    self.bad.count(BadRequest.CODE)
                    log.warning("console_pairing_refused", address=address)
                    raise web.HTTPForbidden(text="not the code")
                name = await work(self.sessions.free_name, named or _browser(request))
                begun = await work(self.sessions.begin, role, name, address)
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
        self.sessions.revoke(session.id)
        self.revoked()
        answer = web.json_response({})
        answer.del_cookie(
            self.cookie, path="/", secure=self.secure, httponly=True, samesite="Strict"
        )
        return answer


def _host_of(request: web.Request) -> str:
    """Return the name that the request was made to, without its port."""
    try:
        return (urlsplit(f"//{request.host}").hostname or "").lower()
    except ValueError:
        return ""


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
