"""A console with a robot that notes what is asked of it, and pages of a real client."""

import json
import threading
from collections.abc import AsyncIterator, Iterator, Mapping
from contextlib import asynccontextmanager, contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import aiohttp

from edgevox.agent.skills import SkillFailed
from edgevox.agent.text.reasons import because
from edgevox.console.certificates import Tls
from edgevox.console.console_server import ConsoleServer
from edgevox.console.context import ConsoleContext
from edgevox.console.sessions import Role
from edgevox.core.bus import Bus
from edgevox.core.clock import Clock
from edgevox.core.commands import Command
from edgevox.core.controls import Controls
from edgevox.core.motion.interlock import Holder, Interlock
from edgevox.core.motion.software_stop import StopState

WAIT_S = 30.0


class NotedStop:
    """A software stop that notes who pressed it, and on which thread."""

    def __init__(self, interlock: Interlock) -> None:
        self.interlock = interlock
        self.state = StopState()
        self.pressed: list[tuple[str, str]] = []
        self.engaged = threading.Event()
        self._listeners: list[Any] = []

    def stop(self, who: str) -> None:
        self.pressed.append((who, threading.current_thread().name))
        with self.interlock.stopping(because("software_stop")):
            self.interlock.engage(Holder.SOFTWARE_STOP, because("software_stop"))
        self._change(StopState(engaged=True, by=who, since=1.0))
        self.engaged.set()

    def resume(self, who: str) -> None:
        self.interlock.release(Holder.SOFTWARE_STOP)
        self._change(StopState())

    def listen(self, listener: Any) -> Any:
        self._listeners.append(listener)
        return lambda: self._listeners.remove(listener)

    def _change(self, state: StopState) -> None:
        self.state = state
        for listener in self._listeners:
            listener(state)


class NotedRobot:
    """A body that notes how it is steered, and what of it was refused."""

    def __init__(self, interlock: Interlock) -> None:
        self.interlock = interlock
        self.refused: list[tuple[float, float]] = []
        self.steered: list[tuple[float, float] | str] = []
        self.halted = threading.Event()
        self.pictures = 0
        self.lets_go = 0

    def scene(self) -> Mapping[str, Any]:
        return {"version": 1, "bounds": [0, 0, 1, 1]}

    def live(self) -> Mapping[str, Any]:
        return {"pose": {"x": 1.0, "y": 2.0, "yaw": 0.0}}

    def picture(self) -> bytes | None:
        self.pictures += 1
        return b"\xff\xd8%d" % self.pictures

    def drive(self, linear_m_s: float, angular_rad_s: float, mark: int | None = None) -> None:
        if held := self.interlock.reason:
            self.refused.append((linear_m_s, angular_rad_s))
            raise SkillFailed(held)
        self.steered.append((linear_m_s, angular_rad_s))

    def let_go(self) -> None:
        self.lets_go += 1

    def halt(self) -> None:
        self.steered.append("halt")
        self.halted.set()


@dataclass
class Rig:
    """A running console, and what reached the robot."""

    server: ConsoleServer
    stop: NotedStop
    robot: NotedRobot
    bus: Bus
    submitted: list[Command]
    hold: threading.Event = field(default_factory=threading.Event)
    """Until it is set, what is submitted waits."""
    began: threading.Event = field(default_factory=threading.Event)
    """Something is being submitted."""

    def cookie(self, role: Role = Role.OPERATOR, name: str = "phone") -> dict[str, str]:
        _, cookie = self.server.sessions.begin(role, name, "127.0.0.1")
        return {"edgevox": cookie}

    @asynccontextmanager
    async def page(
        self,
        role: Role = Role.OPERATOR,
        *,
        cookie: dict[str, str] | None = None,
        language: str = "en",
    ) -> AsyncIterator["Page"]:
        url, asked = self.server.url, f"?language={language}"
        async with (
            aiohttp.ClientSession(cookies=cookie or self.cookie(role)) as client,
            client.ws_connect(f"{url}/ws{asked}", origin=url, max_msg_size=0) as socket,
        ):
            page = Page(socket)
            page.hello = await page.until("hello")
            yield page


class Page:
    """What a browser does."""

    def __init__(self, socket: aiohttp.ClientWebSocketResponse) -> None:
        self.socket = socket
        self.hello: dict[str, Any] = {}
        self._id = 0

    async def send(self, **message: Any) -> int:
        self._id += 1
        await self.socket.send_str(json.dumps({"id": self._id, **message}))
        return self._id

    async def ask(self, **message: Any) -> dict[str, Any]:
        """Send it, and wait for its answer."""
        asked = await self.send(**message)
        while True:
            told = await self.until("ok", "error")
            if told["reply_to"] == asked:
                return told

    async def until(self, *kinds: str) -> dict[str, Any]:
        """The next message of one of these types."""
        while True:
            told = await self.socket.receive(timeout=WAIT_S)
            assert told.type is aiohttp.WSMsgType.TEXT, told
            message: dict[str, Any] = json.loads(told.data)
            if message["type"] in kinds:
                return message

    async def closed(self) -> int | None:
        """Wait until the robot has hung up; its code."""
        while True:
            told = await self.socket.receive(timeout=WAIT_S)
            if told.type in (aiohttp.WSMsgType.CLOSE, aiohttp.WSMsgType.CLOSED):
                return self.socket.close_code
            if told.type is aiohttp.WSMsgType.ERROR:
                return None


@contextmanager
def console(
    folder: Path, tls: Tls | None = None, clock: Clock | None = None, **changes: Any
) -> Iterator[Rig]:
    """A console that serves on a port of its own."""
    bus, interlock = Bus(), Interlock()
    robot = NotedRobot(interlock)
    stop = NotedStop(interlock)
    submitted: list[Command] = []
    hold = threading.Event()
    hold.set()
    began = threading.Event()

    def submit(command: Command, mark: int | None = None) -> None:
        began.set()
        assert hold.wait(WAIT_S)
        submitted.append(command)

    given: dict[str, Any] = {
        "name": "apartment",
        "bus": bus,
        "interlock": interlock,
        "submit": submit,
        "controls": Controls(bus, language="en", voices=lambda _: ()),
        "safety": stop,
        "describe": lambda language: {"capabilities": {"drive": True}, "languages": [language]},
        "status": lambda: {"health": {"ready": True}},
        "robot": robot,
        **changes,
    }
    server = ConsoleServer(ConsoleContext(**given), folder, tls=tls, clock=clock)
    server.start()
    try:
        yield Rig(server, stop, robot, bus, submitted, hold, began)
    finally:
        hold.set()
        server.close()
