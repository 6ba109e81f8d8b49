"""A server that speaks the console's protocol and has no robot: what the page alone is tested with.

It moves only when a test says so: `Robot` holds what was received, and `tell` sends a message.
"""

import asyncio
import json
import math
import threading
from collections.abc import Callable, Iterator, Mapping
from contextlib import suppress
from typing import Any, Self

from aiohttp import WSMsgType, web

from edgevox.console.page_files import PageFiles

CODE = "424242"
CSP = (
    "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' blob: data:; "
    "connect-src 'self'; manifest-src 'self'; worker-src 'self'; base-uri 'none'; "
    "form-action 'self'; frame-ancestors 'none'"
)
Message = dict[str, Any]


def box(x: float, y: float, wide: float, high: float, name: str = "") -> Message:
    corners = [[x, y], [x + wide, y], [x + wide, y + high], [x, y + high]]
    return {"name": name, "points": corners}


SCENE: Message = {
    "version": 1,
    "bounds": [0, 0, 10, 10],
    "radius": 0.2,
    "walls": [
        box(0, 0, 10, 0.16), box(0, 9.84, 10, 0.16), box(0, 0, 0.16, 10), box(9.84, 0, 0.16, 10),
        box(0, 5.14, 2.6, 0.12), box(3.8, 5.14, 3.2, 0.12), box(8.2, 5.14, 1.8, 0.12),
        box(5.74, 0, 0.12, 2.1), box(5.74, 3.7, 0.12, 1.5), box(4.74, 5.2, 0.12, 1.3),
        box(4.74, 7.7, 0.12, 2.2),
    ],
    "furniture": [
        box(0.25, 1.5, 0.95, 2.2, "sofa"), box(1.3, 0.18, 1.8, 0.4, "tv"),
        box(6.7, 0.16, 3.14, 0.6, "counter"), {"name": "table", "circle": [7.6, 3.3, 0.5]},
        box(0.3, 7.2, 1.6, 2.0, "bed"), box(7.6, 8.9, 1.6, 0.8, "desk"),
    ],
    "rooms": [
        {**box(0, 0, 5.8, 5.2), "name": "living room", "goal": [3.4, 2.9]},
        {**box(5.8, 0, 4.2, 5.2), "name": "kitchen", "goal": [7.9, 1.9]},
        {**box(0, 5.2, 4.8, 4.8), "name": "bedroom", "goal": [3, 7.4]},
        {**box(4.8, 5.2, 5.2, 4.8), "name": "office", "goal": [7.2, 7.2]},
    ],
    "places": [{"name": "charger", "x": 9.2, "y": 5.9}],
}  # fmt: skip

for _room in SCENE["rooms"]:
    _room["outline"] = _room.pop("points")

LIVE: Message = {
    "pose": {"x": 4.6, "y": 2.4, "yaw": 0.35},
    "velocity": {"linear": 0.42, "angular": 0.1},
    "lidar": [
        round(value, 2)
        for i in range(180)
        for value in (4.6 + 1.1 * math.cos(i / 28.6), 2.4 + 2.2 * math.sin(i / 28.6))
    ],
    "path": [[4.6, 2.4], [5.4, 2.8], [6.4, 2.7], [7.4, 2.1], [7.9, 1.9]],
    "goal": {"x": 7.9, "y": 1.9, "progress": 0.4, "distance": 3.6},
    "furniture": [{"name": "chair", "points": [[8.2, 3.1], [8.6, 3.1], [8.6, 3.5], [8.2, 3.5]]}],
    "battery": {"level": 0.83},
}

SKILLS: list[Message] = [
    {
        "name": "navigate_to",
        "label": "go to a room",
        "description": "Drive to a room.",
        "schema": {
            "type": "object",
            "required": ["room"],
            "properties": {
                "room": {"type": "string", "enum": ["kitchen", "living room", "bedroom", "office"]}
            },
        },
    },
    {
        "name": "move",
        "label": "move",
        "description": "Drive straight ahead, or back.",
        "schema": {
            "type": "object",
            "required": ["distance_m"],
            "properties": {
                "distance_m": {
                    "title": "distance (m)",
                    "type": "number",
                    "minimum": -2,
                    "maximum": 2,
                },
                "slowly": {"type": "boolean", "default": False},
            },
        },
    },
    {
        "name": "forget_place",
        "label": "forget a place",
        "schema": {"type": "object", "properties": {"place": {"type": "string"}}},
        "allowed": False,
        "why": "The policy gives this to the owner only.",
    },
]

HELLO: Message = {
    "type": "hello",
    "protocol": 1,
    "robot": "Robbie",
    "languages": ["en", "de", "fr"],
    "controls": {
        "language": "en",
        "voice": "",
        "muted": False,
        "confirm": "unsure",
        "voices": ["en_US-lessac-medium"],
        "confirms": ["never", "unsure", "always"],
    },
    "skills": SKILLS,
    "capabilities": {
        "picture": False,
        "drive": {"linear": 0.5, "angular": 1.0},
        "sound": True,
        "map": True,
        "goto": True,
        "record": True,
    },
    "role": "operator",
    "lease": {"holder": None, "mine": False, "waiting": []},
    "stop": {"engaged": False},
}

STATUS: Message = {
    "type": "status",
    "health": {"ready": True, "live": True, "problems": []},
    "diagnostics": [
        {"name": "audio", "level": 0, "message": "works", "values": {"level": 0.02}},
        {"name": "llm", "level": 1, "message": "slow: 9 tokens/s", "values": {"tokens_s": 9}},
        {"name": "sim", "level": 0, "message": "works", "values": {"pace": 1.0}},
    ],
    "latencies": [
        {"turn": i, "stt": 0.3 + 0.1 * (i % 3), "llm": 0.6, "tts": 0.2, "ttfs": 0.9, "total": 1.5}
        for i in range(12)
    ],
    "recording": {"running": False, "files": []},
}


class Robot:
    """Serves the page on a free port of loopback, on a thread of its own."""

    def __init__(self) -> None:
        self.received: list[Message] = []
        self.hello: Message = json.loads(json.dumps(HELLO))
        self.live: Message | None = LIVE
        self.answers: dict[str, Message] = {}
        """By type of command: the error that answers it instead of `ok`."""
        self.scene: Message = SCENE
        self.silent = False
        self._files = PageFiles()
        self.breaks: list[str] = []
        """What of the page does not come while it is loaded for the first time."""
        self.loads = 0
        self.pictures: Iterator[bytes] = iter(())
        """What each asking for a picture is answered with, as long as there are any."""
        self.asked_pictures = 0
        self._clients: dict[str, web.WebSocketResponse] = {}
        self._loop = asyncio.new_event_loop()
        self._thread = threading.Thread(target=self._loop.run_forever, name="stand-in")
        self._lease: str | None = None
        self._asking: list[str] = []
        self._count = 0
        self.url = ""

    def __enter__(self) -> Self:
        self._thread.start()
        self.url = self._do(self._start())
        return self

    def __exit__(self, *_: object) -> None:
        self._do(self._end())
        self._loop.call_soon_threadsafe(self._loop.stop)
        self._thread.join()
        self._loop.close()

    def commands(self, kind: str) -> list[Message]:
        """What of a type the page has sent so far."""
        return [one for one in tuple(self.received) if one["type"] == kind]

    def tell(self, **message: Any) -> None:
        """Send a message to every page."""
        self._do(self._broadcast(message))

    def drop(self, code: int = 1011) -> None:
        """Close every page's socket."""
        self._do(self._drop(code))

    def _do(self, what: Any) -> Any:
        return asyncio.run_coroutine_threadsafe(what, self._loop).result(20)

    async def _start(self) -> str:
        app = web.Application(middlewares=[self._break_off])
        app.add_routes(
            [
                web.get("/", self._page),
                web.get("/api/me", self._me),
                web.post("/api/pair", self._pair),
                web.get("/ws", self._socket),
                web.get("/ws/view", self._view),
            ]
        )
        self._files.add_to(app.router)
        app.on_response_prepare.append(_secure)
        self._runner = web.AppRunner(app, shutdown_timeout=0.2)
        await self._runner.setup()
        site = web.TCPSite(self._runner, "127.0.0.1", 0)
        await site.start()
        self._beat = asyncio.create_task(self._live())
        return f"http://127.0.0.1:{self._runner.addresses[0][1]}"

    async def _end(self) -> None:
        self._beat.cancel()
        await self._runner.cleanup()

    @web.middleware
    async def _break_off(self, request: web.Request, handler: Any) -> web.StreamResponse:
        self.loads += request.path == "/"
        if self.loads == 1 and request.path.endswith(tuple(self.breaks)):
            raise web.HTTPServiceUnavailable
        return await handler(request)

    async def _page(self, request: web.Request) -> web.Response:
        return self._files.document(request, "index.html", paired=_is_paired(request))

    async def _me(self, request: web.Request) -> web.Response:
        if not _is_paired(request):
            return web.Response(status=401)
        return web.json_response({"role": self.hello["role"], "name": "test", "client": "?"})

    async def _pair(self, request: web.Request) -> web.Response:
        if (await request.json())["code"] != CODE:
            return web.Response(status=403)
        answer = web.json_response({"role": "operator"})
        answer.set_cookie("edgevox", CODE, httponly=True, samesite="Strict")
        return answer

    async def _socket(self, request: web.Request) -> web.WebSocketResponse:
        socket = web.WebSocketResponse()
        await socket.prepare(request)
        self._count += 1
        client = f"client-{self._count}"
        self._clients[client] = socket
        hello = {**self.hello, "client": client, "lease": self._leased(client)}
        for first in (hello, {"type": "scene", **self.scene}, STATUS):
            await _send(socket, first)
        async for message in socket:
            if message.type is WSMsgType.TEXT:
                await self._take(client, socket, json.loads(message.data))
        self._clients.pop(client, None)
        if self._lease == client:
            await self._give(None)
        return socket

    async def _view(self, request: web.Request) -> web.WebSocketResponse:
        socket = web.WebSocketResponse()
        await socket.prepare(request)
        async for _ in socket:
            self.asked_pictures += 1
            if picture := next(self.pictures, None):
                await socket.send_bytes(picture)
        return socket

    async def _take(self, client: str, socket: web.WebSocketResponse, message: Message) -> None:
        self.received.append({**message, "client": client})
        if self.silent:
            return
        act: Mapping[str, Callable[[], Any]] = {
            "lease": lambda: self._change_lease(client, message["action"], message.get("to")),
            "stop": lambda: self._broadcast({"type": "stop", "engaged": True, "by": client}),
            "resume": lambda: self._broadcast({"type": "stop", "engaged": False}),
        }
        if message["type"] == "ping":
            await _send(socket, {"type": "pong", "t": message["t"]})
        elif error := self.answers.get(message["type"]):
            await _send(socket, {"type": "error", "reply_to": message["id"], **error})
        else:
            if message["type"] in act:
                await act[message["type"]]()
            await _send(socket, {"type": "ok", "reply_to": message["id"]})

    def _leased(self, client: str) -> Message:
        return {
            "holder": self._lease,
            "name": self._lease,
            "mine": self._lease == client,
            "waiting": [{"client": one, "name": one} for one in self._asking],
        }

    async def _change_lease(self, client: str, action: str, to: str | None) -> None:
        self._asking = [one for one in self._asking if one not in (client, to)]
        if action == "request" and self._lease:
            self._asking.append(client)
        free = self._lease in (None, client)
        await self._give(to if action == "give" else client if free else self._lease)

    async def _give(self, client: str | None) -> None:
        self._lease = client
        for one, socket in tuple(self._clients.items()):
            await _send(socket, {"type": "lease", **self._leased(one)})

    async def _broadcast(self, message: Message) -> None:
        for socket in tuple(self._clients.values()):
            await _send(socket, message)

    async def _drop(self, code: int) -> None:
        for socket in tuple(self._clients.values()):
            await socket.close(code=code)

    async def _live(self) -> None:
        while True:
            await asyncio.sleep(0.1)
            if self.live is not None and not self.silent:
                await self._broadcast({"type": "live", **self.live})


def _is_paired(request: web.Request) -> bool:
    return request.cookies.get("edgevox") == CODE


async def _send(socket: web.WebSocketResponse, message: Message) -> None:
    with suppress(ConnectionError):  # a page that has just gone
        await socket.send_json(message)


async def _secure(_: web.Request, response: web.StreamResponse) -> None:
    response.headers["Content-Security-Policy"] = CSP
