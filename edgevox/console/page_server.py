"""The server of a page: a thread with its own loop, from `start` to `close`, behind the door.

It listens with encryption, renews the certificate, and serves the application that it is given.
`Liveness` tells whether the server still answers: its thread, its loop, and the task that lets
connections in.
"""

import asyncio
import socket
import threading
from collections.abc import Callable, Coroutine, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from pathlib import Path
from typing import Any

from aiohttp import web

from edgevox.console.access import Access
from edgevox.console.certificates import CurrentTls, Tls, console_url
from edgevox.console.door import Door
from edgevox.console.limits import BadRequests, ServerLog
from edgevox.console.page_files import PageFiles
from edgevox.console.sessions import Code, Pairing, Role, Sessions
from edgevox.core.clock import Clock, SystemClock
from edgevox.core.errors import InvalidValue
from edgevox.core.files.state_files import StateFiles
from edgevox.core.log import get_logger, worth_a_line
from edgevox.core.status import STALL_S, lives

log = get_logger(__name__)

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
        """Watch this task from now on, which lets connections in by this door."""
        self._door, self._letting_in = door, letting_in

    async def beat(self) -> None:
        """Say that the loop goes round, until it is cancelled."""
        while True:
            self._beat_s = self._clock.now()
            await asyncio.sleep(BEAT_S)

    def why_not(self) -> str:
        """Return the reason why new connections are not answered; empty if they are."""
        if ended := self._thread():
            return ended
        if self._letting_in and self._letting_in.done():
            return "nobody is let in any more"
        if self._beat_s is not None and self._clock.now() - self._beat_s > STALL_S:
            return "its loop stands still"
        shut = "" if self._door is None else self._door.shut
        return f"nobody is let in: {shut}" if shut else ""


MOST_KNOCKING = 128
RENEW_LOOK_S = 60.0
"""Seconds between checks whether its certificate ends soon, or was replaced. The clock of a robot
without a battery may wake up in another year."""
Job = Coroutine[Any, Any, None]


class PageServer:
    """Listens from its construction on. Raises `InvalidValue` if it cannot.

    Args:
        folder: Holds the sessions.
        host: The address to listen on.
        port: 0 lets the machine choose.
        name: The name of its threads.
        setting: The setting that gave the port, for errors.
        files: The page.
        tls: None speaks plain HTTP; the caller has decided that this is acceptable.
        names: Names of the host, with commas; the first one is in the URL if it listens everywhere.
        clock: The time; the system's by default.
        state: Knows which of its files were damaged.
        cookie: The cookie's name. Browsers do not tell ports of a host apart.
        hosts: The names under which it may be asked for; None for any.
    """

    def __init__(
        self,
        folder: Path,
        host: str,
        port: int,
        *,
        name: str,
        setting: str,
        files: PageFiles,
        tls: Tls | None = None,
        names: str = "",
        clock: Clock | None = None,
        state: StateFiles | None = None,
        cookie: str = "edgevox",
        hosts: frozenset[str] | None = None,
    ) -> None:
        self._tls, self._host, self._names = tls, host, names
        self._current_tls = CurrentTls(tls) if tls else None
        self._socket = listen(host, port, setting)
        self._state = state or StateFiles()
        self._codeless = ""
        self.workers = ThreadPoolExecutor(6, thread_name_prefix=f"{name}-worker")
        self.bad = BadRequests()
        self.access = Access(
            Sessions(folder, state=self._state),
            Pairing(folder, state=self._state),
            clock or SystemClock(),
            tls is not None,
            self.bad,
            self.work,
            files,
            tls.authority.read_bytes() if tls and tls.authority else None,
            hosts,
            cookie,
        )
        self._loop = asyncio.new_event_loop()
        self._closed = asyncio.Event()
        self._started = threading.Event()
        self._thread = threading.Thread(target=self._serve, name=name)
        self._liveness = Liveness(self.access.clock, self._thread.is_alive)
        self._application = self.access.application
        self._open: Callable[[asyncio.AbstractEventLoop], Sequence[Job]] = lambda _loop: ()
        self._leave: Callable[[], None] = lambda: None

    def serve(
        self,
        application: Callable[[], web.Application],
        open_on: Callable[[asyncio.AbstractEventLoop], Sequence[Job]] = lambda _loop: (),
        leave: Callable[[], None] = lambda: None,
    ) -> None:
        """Serve this application, beside jobs on its loop; `leave` is called before it ends."""
        self._application, self._open, self._leave = application, open_on, leave

    @property
    def port(self) -> int:
        """The port that it listens on: the machine's choice if it was made with 0."""
        return int(self._socket.getsockname()[1])

    @property
    def url(self) -> str:
        """The page's URL, for a browser on this machine or one that knows the host by name."""
        return console_url(self._host, self.port, self._tls is not None, self._names)

    @property
    def why_not(self) -> str:
        """The reason why new connections are not answered; empty if they are."""
        return self._liveness.why_not()

    @property
    def faults(self) -> Sequence[str]:
        """What could not be written."""
        return [one for one in (self._codeless, self._state.fault) if one]

    async def work(self, function: Callable[..., Any], *arguments: Any) -> Any:
        """Call what may take long, on a thread of its own."""
        return await asyncio.get_running_loop().run_in_executor(self.workers, function, *arguments)

    def offer_code(self, role: Role = Role.OPERATOR) -> tuple[Code, str]:
        """A new pairing code, and the address that pairs with it. Raises `OSError`."""
        try:
            code = self.access.pairing.offer(role)
        except OSError as error:
            self._codeless = f"no pairing code could be written ({error.strerror or error})"
            raise
        self._codeless = ""
        return code, f"{self.url}/#pair={code.code}"

    def start(self) -> None:
        """Answer, from when this returns."""
        self._thread.start()
        self._started.wait()

    def close(self) -> None:
        """Answer no more."""
        if self._thread.is_alive():
            self._loop.call_soon_threadsafe(self._closed.set)
            self._thread.join()
        self.workers.shutdown(cancel_futures=True)
        self._loop.close()
        self._socket.close()

    def _serve(self) -> None:
        asyncio.set_event_loop(self._loop)
        self._loop.set_exception_handler(self.bad.loop_failed)
        try:
            self._loop.run_until_complete(self._answer_until_closed())
        finally:
            self._started.set()

    async def _answer_until_closed(self) -> None:
        runner = web.AppRunner(
            self._application(),
            handle_signals=False,
            access_log=None,
            logger=ServerLog(self.bad),
            keepalive_timeout=15.0,
            shutdown_timeout=1.0,
            max_line_size=4096,
            max_field_size=8192,
        )
        await runner.setup()
        assert runner.server is not None  # noqa: S101 - setup has made it
        door = self.access.door = Door(
            self._socket, runner.server, tls=self._current_tls, bad=self.bad
        )
        jobs = [door.serve(), *self._open(self._loop), self._liveness.beat()]
        if self._current_tls:
            jobs.append(self._renew(self._current_tls))
        tasks = [asyncio.create_task(one) for one in jobs]
        self._liveness.watch(door, tasks[0])
        self._started.set()
        try:
            await self._closed.wait()
        finally:
            self._leave()
            door.close()
            for task in tasks:
                task.cancel()
            await asyncio.gather(*tasks, return_exceptions=True)
            with suppress(TimeoutError):
                await asyncio.wait_for(runner.cleanup(), 3.0)

    async def _renew(self, tls: CurrentTls) -> None:
        """Have the certificate be one that is good, until it is cancelled."""
        failed = 0
        while True:
            await asyncio.sleep(RENEW_LOOK_S)
            try:
                if await self.work(tls.look):
                    log.info("console_certificate_taken")
                failed = 0
            except (InvalidValue, OSError) as error:
                failed += 1
                if worth_a_line(failed):
                    log.warning("console_certificate_kept", reason=str(error), count=failed)


def listen(host: str, port: int, setting: str) -> socket.socket:
    """A socket that listens. Raises `InvalidValue` for the setting that gave the port."""
    try:
        family = socket.getaddrinfo(host, port, type=socket.SOCK_STREAM)[0][0]
        listening = socket.create_server((host, port), family=family, backlog=MOST_KNOCKING)
    except OSError as error:
        reason = error.strerror or str(error)
        raise InvalidValue(
            setting,
            f"{host}:{port}",
            f"an address and a free port of this machine ({reason})",
        ) from None
    listening.setblocking(False)
    return listening
