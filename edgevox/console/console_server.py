"""The console's server: a page server with a robot behind it.

`open_console` makes the one that the settings want, with its address and its encryption. `sample`
takes the robot's state as often as pages want it, and never while no page looks.
"""

import asyncio
import socket
from collections.abc import Awaitable, Callable, Sequence
from ipaddress import ip_address
from pathlib import Path

from edgevox.console.certificates import Tls, local_names, own_tls
from edgevox.console.context import ConsoleContext, ConsoleRobot
from edgevox.console.door import Door
from edgevox.console.page_files import PageFiles
from edgevox.console.page_hub import PageHub
from edgevox.console.page_server import Job, PageServer, listen
from edgevox.console.sessions import Code, Opened, Role
from edgevox.console.site import Site
from edgevox.core.clock import Clock, SystemClock
from edgevox.core.errors import InvalidValue
from edgevox.core.files.state_files import StateFiles
from edgevox.core.log import get_logger, worth_a_line
from edgevox.core.settings import Settings
from edgevox.core.status import Finding, HealthCheck, Level, Status

log = get_logger(__name__)

NAME = "console"


class ConsoleServer:
    """Listens from its construction on. Raises `InvalidValue` if it cannot.

    Args:
        context: The robot as the console may use it.
        folder: Holds the sessions.
        host: The address to listen on.
        port: 0 lets the machine choose.
        tls: None speaks plain HTTP; the caller has decided that this is acceptable.
        names: Names of the host, with commas; the first one is in the URL if it listens everywhere.
        opened: The further address on which a person may have it listen, meanwhile too.
        clock: The time; the system's by default.
        state: Knows which of its files were damaged.
    """

    def __init__(
        self,
        context: ConsoleContext,
        folder: Path,
        host: str = "127.0.0.1",
        port: int = 0,
        *,
        tls: Tls | None = None,
        names: str = "",
        opened: Opened | None = None,
        clock: Clock | None = None,
        state: StateFiles | None = None,
    ) -> None:
        clock = clock or SystemClock()
        self._opened = opened
        self._server = PageServer(
            folder,
            host,
            port,
            name=NAME,
            setting="console_port",
            files=PageFiles(),
            tls=tls,
            names=names,
            clock=clock,
            state=state,
        )
        access = self._server.access
        self.sessions, self.pairing, self.bad = access.sessions, access.pairing, access.bad
        self._hub = PageHub(context, self.sessions, clock, self._server.workers)
        access.revoked = self._hub.tick
        self._server.serve(Site(self._hub, access).application, self._open, self._hub.close)

    @property
    def port(self) -> int:
        """The port that it listens on: the machine's choice if it was made with 0."""
        return self._server.port

    @property
    def url(self) -> str:
        """The page's URL, for a browser on this machine or one that knows the host by name."""
        return self._server.url

    def offer_code(self, role: Role = Role.OPERATOR) -> tuple[Code, str]:
        """A new pairing code, and the address that pairs with it. Raises `OSError`."""
        return self._server.offer_code(role)

    def start(self) -> None:
        """Answer, from when this returns."""
        self._server.start()

    def close(self) -> None:
        """Answer no more; what is driven from a page is halted."""
        self._server.close()

    def _open(self, loop: asyncio.AbstractEventLoop) -> Sequence[Job]:
        self._hub.open(loop)
        jobs, door = [sample(self._hub)], self._server.access.door
        if self._opened and door is not None:
            jobs.append(_follow(self._hub, door, self._opened, self.port))
        return jobs

    # As a component

    @property
    def name(self) -> str:
        """The name of the component."""
        return NAME

    @property
    def checks(self) -> tuple[HealthCheck, ...]:
        """Its health check. A console that answers no longer is no reason to restart the robot."""
        return (HealthCheck(NAME, lambda: self._server.why_not, vital=False),)

    def status(self) -> Status:
        """Return the numbers of pages and connections, and the address."""
        dead, worse = self._server.why_not, self._server.faults
        return Status.judged(
            NAME,
            [
                *([Finding(Level.ERROR, dead)] if dead else ()),
                *(Finding(Level.WARN, one) for one in worse),
            ],
            url=self.url,
            pages=len(self._hub.pages),
            connections=len(self._server.access.door or ()),
            commander=self._hub.commander,
            bad_requests=self.bad.total,
        )


OPENED_LOOK_S = 0.5
"""Seconds between looks at the address on which it is opened."""


async def _follow(hub: PageHub, door: Door, opened: Opened, port: int) -> None:
    """Listen on the address on which a person opens it, until it is cancelled."""
    known, letting_in, failed = "", None, 0
    try:
        while True:
            try:
                address = await hub.work(opened.address)
            except OSError:
                address = known
            if address != known or (letting_in and letting_in.done()):
                await _end(letting_in)
                known, letting_in = "", None
                try:
                    if address:
                        listening = await hub.work(listen, address, port, "console_port")
                        letting_in = asyncio.create_task(_let_in(door, listening))
                    known, failed = address, 0
                    log.info("console_opened", address=address, open=bool(address))
                except InvalidValue as error:
                    failed += 1
                    if worth_a_line(failed):
                        log.warning("console_not_opened", reason=str(error), count=failed)
            await asyncio.sleep(OPENED_LOOK_S)
    finally:
        await _end(letting_in)


async def _let_in(door: Door, listening: socket.socket) -> None:
    with listening:
        await door.serve(listening)


async def _end(letting_in: "asyncio.Task[None] | None") -> None:
    if letting_in:
        letting_in.cancel()
        await asyncio.gather(letting_in, return_exceptions=True)


LIVE_S = 1 / 15
"""Seconds between samples: a sample is this old, and some 20 ms more, just before the next one
comes."""
STATUS_S = 1.0
TICK_S = 1.0


async def sample(hub: PageHub) -> None:
    """Tell pages how the robot is, until it is cancelled."""
    loops = [_again(TICK_S, lambda: _tick(hub)), _again(STATUS_S, lambda: _status(hub))]
    if hub.context.robot:
        robot, scene = hub.context.robot, Scene(hub, hub.context.robot)
        loops += [_again(LIVE_S, lambda: _live(hub, robot)), _again(STATUS_S, scene.look)]
    await asyncio.gather(*loops)


class Scene:
    """Tells what does not move once it is another."""

    def __init__(self, hub: PageHub, robot: ConsoleRobot) -> None:
        self._hub = hub
        self._robot = robot
        self._told: object = None

    async def look(self) -> None:
        """Tell it where its version is another."""
        if not self._hub.pages:
            return
        scene = await self._hub.work(self._robot.scene)
        told, self._told = self._told, scene.get("version")
        if self._told != told:
            self._hub.tell({**scene, "type": "scene"}, "scene")


async def _tick(hub: PageHub) -> None:
    hub.tick()


async def _live(hub: PageHub, robot: ConsoleRobot) -> None:
    if any("live" in page.looks for page in hub.pages):
        hub.tell({**await hub.work(robot.live), "type": "live"}, "live", "live")


async def _status(hub: PageHub) -> None:
    if any("status" in page.looks for page in hub.pages):
        hub.tell({**await hub.work(hub.context.status), "type": "status"}, "status", "status")


async def _again(period_s: float, look: Callable[[], Awaitable[None]]) -> None:
    """Look so often; what is late is left out, and what breaks is looked at again."""
    loop, broke = asyncio.get_running_loop(), 0
    due = loop.time()
    while True:
        try:
            await look()
        except Exception as error:
            broke += 1
            if worth_a_line(broke):
                log.exception("console_look_failed", error=repr(error), count=broke)
        due = max(due + period_s, loop.time())
        await asyncio.sleep(due - loop.time())


def open_console(context: ConsoleContext, settings: Settings, folder: Path) -> ConsoleServer:
    """A console that listens; who made it starts and closes it. Raises `InvalidValue`, `OSError`.

    `folder` is the robot's own: who was let in, and its keys.
    """
    state = StateFiles()
    tls = tls_of(settings, folder, state)
    host, port, names = settings.console_host, settings.console_port, settings.console_names
    return ConsoleServer(
        context,
        folder,
        host,
        port,
        tls=tls,
        names=names,
        opened=Opened(folder, state) if may_be_opened(settings) else None,
        state=state,
    )


def may_be_opened(settings: Settings) -> bool:
    """Whether a person may open the console to the network while it runs.

    That needs encryption, and settings that leave the address to be chosen.
    """
    return settings.console_tls != "off" and "console_host" not in settings.model_fields_set


def tls_of(settings: Settings, folder: Path, state: StateFiles | None = None) -> Tls | None:
    """Return the encryption; None for plain HTTP. Raises `InvalidValue`, and `OSError`."""
    if settings.console_tls == "own":
        return own_tls(folder, names_of(settings), state=state, spare=found_names(settings))
    if settings.console_tls == "files":
        if not settings.console_certificate or not settings.console_key:
            raise InvalidValue(
                "console_tls", "files", "console_certificate and console_key beside it"
            )
        return Tls(settings.console_certificate.expanduser(), settings.console_key.expanduser())
    if not settings.console_plain and not is_loopback(settings.console_host):
        raise InvalidValue(
            "console_tls",
            "off",
            "own or files where other machines can reach it, or console_plain where something "
            "else encrypts",
        )
    return None


def names_of(settings: Settings) -> tuple[str, ...]:
    """Return the console's names for its own certificate."""
    return local_names(_asked(settings))


def found_names(settings: Settings) -> frozenset[str]:
    """Return the names that this machine has by itself now, without the wanted ones."""
    return frozenset(local_names()) - set(_asked(settings))


def _asked(settings: Settings) -> list[str]:
    more = [one.strip().lower() for one in settings.console_names.split(",")]
    return [one for one in more if one]


def is_loopback(host: str) -> bool:
    """Return whether only this machine reaches this host."""
    try:
        return ip_address(host).is_loopback
    except ValueError:
        return host == "localhost"
