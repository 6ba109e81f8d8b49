"""The file that names the robots of a fleet, in YAML, written by the fleet's people."""

from collections.abc import Mapping
from pathlib import Path
from typing import Annotated
from urllib.parse import urlsplit

from pydantic import AfterValidator, BaseModel, ConfigDict, Field, StringConstraints

from edgevox.core.files.user_file import read_text
from edgevox.core.files.yaml_file import YamlFile

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
