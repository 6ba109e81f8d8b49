"""Asks the robots of a fleet how they are: their health, and their status.

The robots are those of a file in YAML, written by the fleet's people. What a robot answers is read
as a stranger's: of wrong types, too long, or never coming.
"""

import http.client
import math
import socket
import threading
from collections.abc import Callable, Iterable, Iterator, Mapping
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager, suppress
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Annotated, Any, Literal
from urllib.parse import urlsplit

from pydantic import AfterValidator, BaseModel, ConfigDict, Field, StringConstraints

from edgevox.core.clock import Clock, SystemClock
from edgevox.core.errors import InvalidValue
from edgevox.core.files.user_file import read_text
from edgevox.core.files.validation import read_json
from edgevox.core.files.yaml_file import YamlFile
from edgevox.core.status import Level

MOST_ROBOTS = 200
HEALTH_EXPECTED = "http://HOST:PORT, where the robot's health is served"
RECORDER_EXPECTED = "http://HOST:PORT, where the recorder's health is served"
CONSOLE_EXPECTED = "https://HOST:PORT, or http:, where a browser opens the robot's console"


def _health(url: str) -> str:
    return _server(url, HEALTH_EXPECTED)


def _recorder(url: str) -> str:
    return _server(url, RECORDER_EXPECTED)


def _server(url: str, expected: str) -> str:
    if not _has_host(url, ("http",)) or urlsplit(url).path not in ("", "/"):
        raise ValueError(expected)
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
    """The URLs of a robot.

    `recorder` is the health of a recorder of its own. An empty `console` gives no link.
    """

    model_config = ConfigDict(extra="forbid", frozen=True)

    health: Annotated[str, AfterValidator(_health)]
    recorder: Annotated[str, AfterValidator(_recorder)] = ""
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
MOST_TEXT = 300
"""Characters of a text that are shown."""

State = Literal["gone", "unwell", "warned", "unknown", "ready"]
_WORST_FIRST: tuple[State, ...] = ("gone", "unwell", "warned", "unknown", "ready")


@dataclass(frozen=True, slots=True)
class RobotStatus:
    """What a robot tells of itself; None where it does not say."""

    version: str | None = None
    image: str | None = None
    stopped: bool | None = None
    """Whether motion is forbidden, by a stop or otherwise."""
    battery: float | None = None
    """The charge, 0 to 1."""
    disk_free_mib: float | None = None
    """The least of its disks."""
    recording: bool | None = None


@dataclass(frozen=True, slots=True)
class LastSeen:
    """A robot's last answer. `problems` are texts by check."""

    state: State = "unknown"
    problems: Mapping[str, str] = field(default_factory=dict)
    told: RobotStatus = RobotStatus()


NO_HEALTH = "what answers there is not a robot's health"
Answer = tuple[int, Any]


def ask_robot(robot: FleetRobot) -> LastSeen:
    """A robot's answers; gone where it does not answer, or not with a health report."""
    try:
        status, health = _get(robot.health, "/ready")
        problems = {_text(name): _text(said) for name, said in health["checks"].items()}
    except (OSError, http.client.HTTPException) as failed:
        return LastSeen("gone", {"network": str(failed) or type(failed).__name__})
    except (InvalidValue, ValueError, KeyError, TypeError, AttributeError):
        return LastSeen("gone", {"health": NO_HEALTH})
    problems = {name: said for name, said in problems.items() if said != "ok"}
    well = status == http.client.OK
    warned, told = _status(robot.health)
    if robot.recorder:
        more, recorder = _status(robot.recorder)
        warned |= {name if name == "recorder" else f"recorder {name}": more[name] for name in more}
        told = _with_recorder(told, recorder)
    warned = {name: said for name, said in warned.items() if name not in problems}
    state: State = "unwell" if not well else "warned" if warned else "ready"
    return LastSeen(state, {**problems, **warned}, told)


def _status(url: str) -> tuple[dict[str, str], RobotStatus]:
    """The components with a warning or an error, and what is told of the robot."""
    try:
        code, said = _get(url, "/status")
        if code == http.client.NOT_FOUND:  # an older version
            return {}, RobotStatus()
        parts = {_text(one["name"]): one for one in said["components"]}
        warned = {
            name: _text(one["message"])
            for name, one in parts.items()
            if one["level"] in (Level.WARN, Level.ERROR) and name != "process"  # as /ready says
        }
        return warned, RobotStatus(
            version=_word(said.get("version")),
            image=_word(said.get("image")),
            stopped=_flag(_value(parts, "interlock", "engaged")),
            battery=_number(_value(parts, "sim", "battery")),
            disk_free_mib=_least(parts),
            recording=_recording(parts),
        )
    except (OSError, http.client.HTTPException) as failed:
        return {"status": str(failed) or type(failed).__name__}, RobotStatus()
    except (InvalidValue, ValueError, KeyError, TypeError, AttributeError):
        return {"status": "what answers there is not a robot's status"}, RobotStatus()


def _with_recorder(robot: RobotStatus, recorder: RobotStatus) -> RobotStatus:
    """A robot whose recorder is a program of its own: it records for as long as it answers."""
    records = bool(robot.recording) or recorder.version is not None
    return RobotStatus(**{**asdict(robot), "recording": records})


def _recording(parts: Mapping[str, Any]) -> bool | None:
    """Whether a person's recording runs, or a recorder of its own that the robot hears."""
    told = [_flag(_value(parts, name, "recording")) for name in ("recordings", "recorder")]
    known = [one for one in told if one is not None]
    return any(known) if known else None


def _value(parts: Mapping[str, Any], component: str, name: str) -> object:
    return parts[component]["values"].get(name) if component in parts else None


def _least(parts: Mapping[str, Any]) -> float | None:
    free = parts["disk"]["values"].items() if "disk" in parts else ()
    numbers = [_number(value) for name, value in free if str(name).endswith("free_mib")]
    return min((one for one in numbers if one is not None), default=None)


def _number(value: object) -> float | None:
    known = isinstance(value, int | float) and not isinstance(value, bool)
    return float(value) if known and math.isfinite(value) else None  # type: ignore[arg-type]


def _flag(value: object) -> bool | None:
    return value if isinstance(value, bool) else None


def _word(value: object) -> str | None:
    return _text(value) if isinstance(value, str) and value else None


def _text(value: object) -> str:
    return str(value)[:MOST_TEXT]


def _get(url: str, path: str) -> Answer:
    address = urlsplit(url)
    connection = http.client.HTTPConnection(
        address.hostname or "", address.port or 80, timeout=ANSWER_WITHIN_S
    )
    try:
        connection.connect()
        with _hung_up_in_time(connection.sock):
            connection.request("GET", path)
            answer = connection.getresponse()
            said = answer.read(MOST_BYTES)
        return answer.status, read_json(said, "health")
    finally:
        connection.close()


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
        ask: Callable[[FleetRobot], LastSeen] = ask_robot,
        clock: Clock | None = None,
    ) -> None:
        self._robots, self._ask = dict(robots), ask
        self._clock = clock or SystemClock()
        self._seen: dict[str, tuple[LastSeen, float | None]] = {
            name: (LastSeen(), None) for name in robots
        }
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
        """JSON-ready, the ill ones first; `age_s` is how long ago it was asked."""
        now_s = self._clock.now()
        return [
            {
                "name": name,
                "console": self._robots[name].console,
                "state": seen.state,
                "problems": dict(seen.problems),
                "age_s": None if at_s is None else round(now_s - at_s, 1),
                **asdict(seen.told),
            }
            for name, (seen, at_s) in _ill_first(self._seen.items())
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
            self._seen[name] = (self._ask(self._robots[name]), self._clock.now())


Seen = tuple[str, tuple[LastSeen, float | None]]


def _ill_first(seen: Iterable[Seen]) -> list[Seen]:
    return sorted(seen, key=lambda one: _WORST_FIRST.index(one[1][0].state))
