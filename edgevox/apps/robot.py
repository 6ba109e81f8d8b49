"""What a robot is to `edgevox-agent`, and how an installed package brings robots of its own."""

from collections.abc import Callable, Container, Mapping
from dataclasses import dataclass
from importlib.metadata import EntryPoint, entry_points

from edgevox.core.errors import EdgeVoxError
from edgevox.core.settings import Settings
from edgevox.robots.capabilities import Body

GROUP = "edgevox.robots"
"""The entry points that name a `Robot` each: `robot-shuttle = "my_package:SHUTTLE"`."""

INSTRUCTIONS = (
    "You are EdgeVox, the voice of a small robot in a home. Be friendly and brief: one or two short"
    " sentences. Only promise what your skills can do."
)

Build = Callable[[Settings, float | None], Body]
"""Makes a body that is not yet started, in a world that runs at that multiple of real time; with
None as fast as it can, with 0 only as far as `advance` asks."""


@dataclass(frozen=True)
class Robot:
    """One robot: what it is, how to build it, what the language model is told of itself.

    The body that `build` makes has the robot's name. `models` are the ids of edgevox-models that it
    needs as it comes; `build` locates them.
    """

    about: str
    build: Build
    instructions: str = INSTRUCTIONS
    models: tuple[str, ...] = ()


def installed_robots(besides: Container[str] = ()) -> Mapping[str, Robot]:
    """The robots that other packages bring, by name; those that are known already stay as they are.

    One that cannot be loaded is there, and says so when it is asked for.
    """
    points = entry_points(group=GROUP)
    return {point.name: _loaded(point) for point in points if point.name not in besides}


def _loaded(point: EntryPoint) -> Robot:
    try:
        robot = point.load()
    except Exception as error:  # noqa: BLE001 - a package of somebody else raises what it likes
        return _broken(f"{type(error).__name__}: {error}")
    return robot if isinstance(robot, Robot) else _broken(f"{point.value} is no Robot")


def _broken(reason: str) -> Robot:
    def refuse(_settings: Settings, _speed: float | None) -> Body:
        raise EdgeVoxError(f"the package that brings this robot is broken: {reason}")

    return Robot("installed, but broken", refuse)
