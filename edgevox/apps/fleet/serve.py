"""A fleet's page on this machine: the file of its robots, and the server.

The file is YAML, written by the fleet's people.
"""

import http.client
import socket
import threading
from collections.abc import Callable, Iterator, Mapping
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import dataclass, field
from importlib.resources import files
from pathlib import Path
from typing import Annotated, Literal
from urllib.parse import urlsplit

from pydantic import AfterValidator, BaseModel, ConfigDict, Field, StringConstraints

from edgevox.apps.run_program import ShutdownSignals
from edgevox.apps.streams import show
from edgevox.core.clock import Clock, SystemClock
from edgevox.core.errors import InvalidValue
from edgevox.core.files.json_reader import read_json
from edgevox.core.files.user_file import read_text
from edgevox.core.files.yaml_file import YamlFile
from edgevox.core.settings import Settings
from edgevox.ops.http_server import HttpServer, Page, json_page

MOST_ROBOTS = 200
HEALTH_EXPECTED = "http://HOST:PORT, where the robot's health is served"
CONSOLE_EXPECTED = "https://HOST:PORT, or http:, where a browser opens the robot's console"


def _health(url: str) -> str:
    if not _has_host(url, ("http",)) or urlsplit(url).path not in ("", "/"):
        raise ValueError(HEALTH_EXPECTED)
    return url.rstrip("/")


def _console(url: str) -> str:
    if not _has_host(url, ("http", "https")):
        raise ValueError(CONSOLE_EXPECTED)
    return url


def _has_host(url: str, schemes: tuple[str, ...]) -> bool:
    """Return whether it is a URL of such a scheme, without user name or password."""
    try:
        parts = urlsplit(url)
        return (
            parts.scheme in schemes
            and bool(parts.hostname)
            and "@" not in parts.netloc
            and (parts.port is None or parts.port > 0)
        )
    except ValueError:  # a port that is none, a bracket too many
        return False


class FleetRobot(BaseModel):
    """The URLs of a robot's health and console; an empty console gives no link."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    health: Annotated[str, AfterValidator(_health)]
    console: Annotated[str, AfterValidator(_console)] = ""


Name = Annotated[str, StringConstraints(min_length=1, max_length=60, strip_whitespace=True)]


class FleetFile(BaseModel):
    """A whole file."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    robots: Annotated[dict[Name, FleetRobot], Field(min_length=1, max_length=MOST_ROBOTS)]


def load_fleet(path: Path) -> Mapping[str, FleetRobot]:
    """The robots by name, in the file's order.

    Raises `InvalidValue` naming the file, the field, its value and what was expected.
    """
    file = YamlFile(read_text(path, "robots"), path.name)
    return file.read(FleetFile, file.data).robots


ASK_EVERY_S = 2.0
ANSWER_WITHIN_S = 2.0
AT_ONCE = 16
MOST_BYTES = 1 << 16

State = Literal["unknown", "ready", "unwell", "gone"]


@dataclass(frozen=True, slots=True)
class LastSeen:
    """A robot's last answer. `problems` are texts by check; `at_s` is the watch's clock."""

    state: State = "unknown"
    problems: Mapping[str, str] = field(default_factory=dict)
    at_s: float | None = None


def ask_health(robot: FleetRobot) -> tuple[State, Mapping[str, str]]:
    """Return a robot's answer at `/ready`; gone without an answer, or without a health report."""
    address = urlsplit(robot.health)
    connection = http.client.HTTPConnection(
        address.hostname or "", address.port or 80, timeout=ANSWER_WITHIN_S
    )
    try:
        connection.connect()
        with _hung_up_in_time(connection.sock):
            connection.request("GET", "/ready")
            answer = connection.getresponse()
            said = answer.read(MOST_BYTES)
        checks = read_json(said, "health")["checks"]
        problems = {str(name): str(said) for name, said in checks.items() if said != "ok"}
    except (OSError, http.client.HTTPException) as failed:
        return "gone", {"network": str(failed) or type(failed).__name__}
    except (InvalidValue, ValueError, KeyError, TypeError, AttributeError):
        return "gone", {"health": "what answers there is not a robot's health"}
    finally:
        connection.close()
    return ("ready" if answer.status == http.client.OK else "unwell"), problems


@contextmanager
def _hung_up_in_time(sock: socket.socket) -> Iterator[None]:
    """Limit the whole answer's time.

    The socket's timeout is for each byte, and a dripping robot would hold up the page.
    """

    def hang_up() -> None:
        with suppress(OSError):
            sock.shutdown(socket.SHUT_RDWR)

    timer = threading.Timer(ANSWER_WITHIN_S, hang_up)
    timer.start()
    try:
        yield
    finally:
        timer.cancel()
        timer.join()


class FleetWatch:
    """Asks all robots every `ASK_EVERY_S` on threads of its own, from `start` to `close`."""

    def __init__(
        self,
        robots: Mapping[str, FleetRobot],
        ask: Callable[[FleetRobot], tuple[State, Mapping[str, str]]] = ask_health,
        clock: Clock | None = None,
    ) -> None:
        self._robots, self._ask = dict(robots), ask
        self._clock = clock or SystemClock()
        self._seen = dict.fromkeys(robots, LastSeen())
        self._closing = threading.Event()
        self._thread = threading.Thread(target=self._run, name="edgevox-fleet")

    def start(self) -> None:
        self._thread.start()

    def close(self) -> None:
        """Ask no more."""
        self._closing.set()
        if self._thread.is_alive():
            self._thread.join()

    def as_json(self) -> list[dict[str, object]]:
        """JSON-ready, in the file's order; `age_s` is how long ago it was asked."""
        now_s = self._clock.now()
        return [
            {
                "name": name,
                "console": self._robots[name].console,
                "state": seen.state,
                "problems": dict(seen.problems),
                "age_s": None if seen.at_s is None else round(now_s - seen.at_s, 1),
            }
            for name, seen in self._seen.items()
        ]

    def look(self) -> None:
        """Ask every robot once."""
        with ThreadPoolExecutor(min(AT_ONCE, len(self._robots)), "edgevox-fleet-ask") as pool:
            list(pool.map(self._look_at, self._robots))

    def _run(self) -> None:
        while not self._closing.is_set():
            self.look()
            self._closing.wait(ASK_EVERY_S)

    def _look_at(self, name: str) -> None:
        if not self._closing.is_set():
            state, problems = self._ask(self._robots[name])
            self._seen[name] = LastSeen(state, problems, self._clock.now())


LOOPBACK = "127.0.0.1"
FLEET_PORT = 8440
_STATIC = {
    "/": ("index.html", "text/html; charset=utf-8"),
    "/fleet.js": ("fleet.js", "text/javascript; charset=utf-8"),
    "/fleet.css": ("fleet.css", "text/css; charset=utf-8"),
}


def serve_fleet(robots: Path, port: int, settings: Settings) -> bool:
    """Serve the page of the robots that a file names, until somebody leaves.

    Raises `InvalidValue` for a file that is wrong and for a port that is taken.
    """
    watch = FleetWatch(load_fleet(robots))
    with ExitStack() as stack, ShutdownSignals(settings.leave_s):
        server = fleet_server(watch, port)
        for part in (watch, server):
            stack.callback(part.close)
            part.start()
        show(f"{len(watch.as_json())} robots on http://localhost:{server.port}")
        threading.Event().wait()
    return True


def fleet_server(watch: FleetWatch, port: int) -> HttpServer:
    """The page and what it asks for. Raises `InvalidValue` where it cannot listen."""
    pages = {path: _page(*static) for path, static in _STATIC.items()}
    pages["/robots"] = lambda: json_page({"robots": watch.as_json()})
    return HttpServer(pages, LOOPBACK, port, setting="fleet_port", name="edgevox-fleet-page")


def _page(name: str, content_type: str) -> Callable[[], Page]:
    body = files("edgevox.apps.fleet").joinpath("page", name).read_bytes()
    page = Page(body, content_type)
    return lambda: page
