"""Packages that bring skills to any robot, by an entry point as robots come.

[project.entry-points."edgevox.skills"]
lift = "my_package:lift_skills"

def lift_skills(context: SkillContext) -> Iterable[Skill]:
    ...
"""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from importlib.metadata import EntryPoint, entry_points

from edgevox.agent.skills import Skill
from edgevox.core.errors import EdgeVoxError, InvalidValue
from edgevox.core.log import Logger, get_logger
from edgevox.core.settings import Settings
from edgevox.robots.capabilities import Body, HasPlaces
from edgevox.robots.node_handle import NodeHandle

SKILL_GROUP = "edgevox.skills"
"""The entry points that name a `MakeSkills` each."""
ALL, NONE = "all", "none"
_BROKEN = (Exception, SystemExit)
"""Foreign code raises anything, and may even try to end the program."""

log = get_logger(__name__)


class SkillsOff(EdgeVoxError):
    """A package's skills do not fit this robot; the message is the reason."""


@dataclass(frozen=True)
class SkillContext:
    """The agent's objects for a package's skills. The body is not started yet."""

    name: str
    """The entry point's name."""
    body: Body
    """Its capabilities are in `edgevox.robots.capabilities`: test with
    ``isinstance(context.body, HasPose)``."""
    settings: Settings
    ros: NodeHandle | None = None
    """None without ROS 2 (`robot-external`, or the setting `ros2`)."""

    @property
    def places(self) -> Mapping[str, tuple[float, float]]:
        """The places that it knows by name, as (x, y), metres, map frame."""
        return self.body.places if isinstance(self.body, HasPlaces) else {}

    @property
    def log(self) -> Logger:
        """A logger; its lines are shown as the agent's own are."""
        return get_logger(f"{SKILL_GROUP}.{self.name}")

    def require_ros(self) -> NodeHandle:
        """`ros`. Raises `SkillsOff` where there is none."""
        if self.ros is None:
            raise SkillsOff("it needs ROS 2: robot-external, or --ros2 and rclpy")
        return self.ros


MakeSkills = Callable[[SkillContext], Iterable[Skill]]
"""Makes a package's skills for one robot. Raises `SkillsOff` where it has none for it."""


def installed_skills() -> Mapping[str, EntryPoint]:
    """The packages' entry points by name; the first of a name counts."""
    found: dict[str, EntryPoint] = {}
    for point in sorted(entry_points(group=SKILL_GROUP)):
        found.setdefault(point.name, point)
    return found


def chosen_skills(chosen: str, installed: Mapping[str, EntryPoint]) -> Sequence[EntryPoint]:
    """Return the packages that the setting `skills` names.

    Raises `InvalidValue` for a missing one.
    """
    if chosen in {ALL, NONE}:
        return tuple(installed.values()) if chosen == ALL else ()
    names = [name.strip() for name in chosen.split(",")]
    for name in names:
        if name not in installed:
            raise InvalidValue("skills", name, "one of " + ", ".join([*installed, ALL, NONE]))
    return [installed[name] for name in dict.fromkeys(names)]


def left_out(used: Iterable[EntryPoint]) -> Iterator[tuple[str, str, str]]:
    """The entry points' names that one package more has than the one that is used, with both."""
    taken = {point.name: _package(point) for point in used}
    for point in entry_points(group=SKILL_GROUP):
        used_one, other = taken.get(point.name), _package(point)
        if used_one is not None and used_one != other:
            yield point.name, used_one, other


def warn_of_namesakes(used: Iterable[EntryPoint]) -> None:
    """Say which packages are left out because one that is used has their entry point's name."""
    for name, used_one, other in left_out(used):
        log.warning("skill_package_twice", package=name, used=used_one, left_out=other)


def fault_of(point: EntryPoint) -> str:
    """Return the reason why a package cannot even be loaded; empty if it can."""
    try:
        _load_factory(point)
    except _BROKEN as error:
        return f"{type(error).__name__}: {error}"
    return ""


def brought_skills(
    points: Iterable[EntryPoint], body: Body, settings: Settings, ros: NodeHandle | None
) -> Iterator[tuple[str, Skill]]:
    """The skills that these bring to a body, each with its package's name.

    A package that breaks, or has none for this robot, is told by name, and no other is touched.
    """
    for point in points:
        try:
            made = _made(point, SkillContext(point.name, body, settings, ros))
        except SkillsOff as error:
            log.warning("skill_package_off", package=point.name, reason=str(error))
        except _BROKEN:
            log.exception("skill_package_broken", package=point.name)
        else:
            yield from ((point.name, one) for one in made)


def _package(point: EntryPoint) -> str:
    return point.dist.name if point.dist else point.value


def _made(point: EntryPoint, context: SkillContext) -> Sequence[Skill]:
    made = tuple(_load_factory(point)(context))
    for one in made:
        if not isinstance(one, Skill):
            raise TypeError(f"{point.value} brings {one!r}, which is no Skill")
    return made


def _load_factory(point: EntryPoint) -> MakeSkills:
    factory: MakeSkills = point.load()
    if not callable(factory):
        raise TypeError(f"{point.value} is no function")
    return factory
