"""The interface of a robot to `edgevox-agent`: a package brings one by an entry point.

EdgeVox's own robots come the same way. A package needs this module, the protocols of
`capabilities`, and `EdgeVoxError` of core.
"""

import tomllib
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from importlib.metadata import EntryPoint, PackageNotFoundError, distribution, entry_points
from pathlib import Path

from edgevox.core.errors import EdgeVoxError
from edgevox.core.settings import Settings
from edgevox.robots.capabilities import Body

GROUP = "edgevox.robots"
"""The entry points that name a `Robot` each: `robot-shuttle = "my_package:SHUTTLE"`."""

INSTRUCTIONS = (
    "You are EdgeVox, the voice of a small robot in a home. Be friendly and brief: one or two short"
    " sentences. Only promise what your skills can do."
)

FOR_BODIES = frozenset(
    {
        "robot_namespace",
        "locations",
        "max_angular",
        "max_linear",
        "mjcf",
        "model_source",
        "robot_file",
        "seed",
        "world",
    }
)
"""The settings that only a robot's `build` reads, each by some robots and not by others."""

Build = Callable[[Settings, float | None], Body]
"""Makes a body that is not yet started, in a world that runs at that multiple of real time; with
None as fast as it can, with 0 only as far as `advance` asks. Raises `EdgeVoxError` with the reason
where it cannot."""

_OURS = "edgevox-robot"
_BROKEN = (Exception, SystemExit)
"""Foreign code raises anything, and may even try to end the program."""
_PROJECT = Path(__file__).parents[2] / "pyproject.toml"


@dataclass(frozen=True)
class Robot:
    """A robot: its description, its constructor, and the language model's instructions.

    The body that `build` makes has the robot's name.
    """

    about: str
    build: Build
    instructions: str = INSTRUCTIONS
    models: tuple[str, ...] = ()
    """Ids of the edgevox-models that it needs by default; `build` locates them."""
    reads: frozenset[str] | None = None
    """The settings of `FOR_BODIES` that `build` reads; a user who sets another one is told that
    it does nothing. None: unknown."""

    def unread(self, settings: Settings) -> list[str]:
        """Return the changed settings that do nothing for this robot."""
        names = FOR_BODIES - (FOR_BODIES if self.reads is None else self.reads)
        fields = Settings.model_fields
        return sorted(one for one in names if getattr(settings, one) != fields[one].default)


class Robots(Mapping[str, Robot]):
    """Robots by name, each loaded at its first use.

    A robot that cannot be loaded is listed, and fails when its body is built.
    """

    def __init__(self, points: Iterable[EntryPoint]) -> None:
        self._points = {point.name: point for point in points}
        self._loaded: dict[str, Robot] = {}

    def add(self, points: Iterable[EntryPoint]) -> None:
        """Know those, too, whose names are not taken."""
        for point in points:
            self._points.setdefault(point.name, point)

    def __getitem__(self, name: str) -> Robot:
        if name not in self._loaded:
            self._loaded[name] = _load(self._points[name])
        return self._loaded[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._points)

    def __len__(self) -> int:
        return len(self._points)


def installed_robots(project: Path = _PROJECT) -> Robots:
    """All robots that there are: ours first, then those of other packages, which replace none.

    Ours are those that were installed; in a checkout that was not, or before it had any, those that
    `project`, its pyproject.toml, declares.
    """
    ours = sorted(_installed() or _declared(project))
    names = {point.name for point in ours}
    return Robots([*ours, *(one for one in robot_points() if one.name not in names)])


def robot_points() -> tuple[EntryPoint, ...]:
    """Return the robots' entry points of all installed packages."""
    return tuple(entry_points(group=GROUP))


def foreign_robot_points() -> tuple[EntryPoint, ...]:
    """Return the robots' entry points of other packages."""
    return tuple(one for one in robot_points() if one.dist is None or one.dist.name != _OURS)


def fault_of_robot(point: EntryPoint) -> str:
    """Return the reason why a robot cannot even be loaded; empty if it can."""
    try:
        robot = point.load()
    except _BROKEN as error:
        return f"{type(error).__name__}: {error}"
    return "" if isinstance(robot, Robot) else f"{point.value} is no Robot"


def _installed() -> tuple[EntryPoint, ...]:
    try:
        return tuple(distribution(_OURS).entry_points.select(group=GROUP))
    except PackageNotFoundError:
        return ()


def _declared(project: Path) -> Iterator[EntryPoint]:
    if project.is_file():
        about = tomllib.loads(project.read_text("utf-8")).get("project", {})
        points = about.get("entry-points", {}).get(GROUP, {})
        yield from (EntryPoint(name, value, GROUP) for name, value in points.items())


def _load(point: EntryPoint) -> Robot:
    if fault := fault_of_robot(point):
        return _broken(fault)
    robot: Robot = point.load()
    return robot


def _broken(reason: str) -> Robot:
    def refuse(_settings: Settings, _speed: float | None) -> Body:
        raise EdgeVoxError(f"the package that brings this robot is broken: {reason}")

    return Robot("installed, but broken", refuse)
