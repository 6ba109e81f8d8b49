"""The robots of a fleet's page, from a YAML file that its people write.

robots:
  kitchen: {health: "http://192.168.1.20:8001", console: "https://robot1.local:8443"}
"""

from collections.abc import Mapping
from pathlib import Path
from typing import Annotated
from urllib.parse import urlsplit

from pydantic import AfterValidator, BaseModel, ConfigDict, Field, StringConstraints

from edgevox.core.files.user_file import read_text
from edgevox.core.files.yaml_file import YamlFile

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
    """Whether it is an address of such a scheme, without a user's name or a password in it."""
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
    """Where one robot's health is asked for, and where its console is; empty for no link."""

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
