"""The robots that `edgevox-agent` knows by name, the agents that talk for them, and their skills.

A robot's skills are those of its body, and those that packages bring to it.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from hassil.parse_expression import parse_sentence

from edgevox.agent.agents import Agent
from edgevox.agent.phrases.load import ENGLISH, phrasebook
from edgevox.agent.phrases.name_rules import check_skills
from edgevox.agent.skills import Skill, SkillSet
from edgevox.apps.folders import pictures_folder, places_folder
from edgevox.core.bus import Bus
from edgevox.core.errors import InvalidValue
from edgevox.core.log import get_logger
from edgevox.core.settings import Settings
from edgevox.robots.capabilities import Body, RemembersPlaces, TellsAbout
from edgevox.robots.node_handle import NodeHandle, OnRos2
from edgevox.robots.pictures import Album, picture_skills
from edgevox.robots.places.memory import PlaceStore
from edgevox.robots.plugin import installed_robots, robot_points
from edgevox.robots.skill_packages import (
    brought_skills,
    chosen_skills,
    fault_of,
    installed_skills,
    warn_of_namesakes,
)
from edgevox.ros2 import open_node_handle

log = get_logger(__name__)

TALK_INSTRUCTIONS = (
    "You are EdgeVox, a voice agent that runs offline and has no robot at the moment. Be friendly"
    " and brief: one or two short sentences."
)

_MB = 1_000_000

ROBOTS = installed_robots()
"""All of them, in the order in which they are listed."""


def learn_robots() -> None:
    """Add the robots of packages that were found since."""
    ROBOTS.add(robot_points())


def build_body(name: str, settings: Settings, speed: float | None = 1.0) -> Body:
    """The body of this robot, not yet started. Raises `EdgeVoxError` with the reason.

    What somebody set that does nothing for this robot is logged.
    """
    robot = ROBOTS[name]
    for setting in robot.unread(settings):
        log.warning("setting_unread", setting=setting, robot=name)
    return robot.build(settings, speed)


def open_places(body: Body, settings: Settings) -> None:
    """Have a body that can remember places recall them, and keep what it learns from now on."""
    if isinstance(body, RemembersPlaces):
        body.place_memory.open(PlaceStore(places_folder(settings)), body.name)


def build_agents(body: Body | None, skills: Sequence[Skill] | None = None) -> Sequence[Agent]:
    """Return the agents: one with the body's skills or these, or, without a body, one with none.

    Raises `InvalidValue` for a skill, or a word of one, that people need for something else.
    """
    if body is None:
        return (Agent("edgevox", TALK_INSTRUCTIONS),)
    had = body.skills if skills is None else skills
    check_skills(had)
    instructions = " ".join(filter(None, (ROBOTS[body.name].instructions, about(body))))
    return (Agent(body.name, instructions, SkillSet(had)),)


def about(body: Body) -> str:
    """Return the body's own description; empty for most bodies."""
    return body.about if isinstance(body, TellsAbout) else ""


if TYPE_CHECKING:
    from edgevox.ros2.agent_node_handle import AgentNodeHandle


@dataclass(frozen=True)
class RobotSkills:
    """The skills, and the handle that waits for the bridge's node, if a package may use it."""

    skills: tuple[Skill, ...] = ()
    handle: "AgentNodeHandle | None" = None


def gather_skills(body: Body | None, settings: Settings, bus: Bus | None = None) -> RobotSkills:
    """The skills of a body that is not started, and of the packages that `settings.skills` chooses.

    The bus hears of the pictures that it takes. Raises `InvalidValue` for a package that is not
    installed.
    """
    if body is None:
        return RobotSkills()
    own = (*body.skills, *_pictures(body, settings, bus or Bus()))
    points = chosen_skills(settings.skills, installed_skills())
    if not points:
        return RobotSkills(own)
    warn_of_namesakes(points)
    handle = None if isinstance(body, OnRos2) or not settings.ros2 else open_node_handle()
    ros: NodeHandle | None = body.ros if isinstance(body, OnRos2) else handle
    brought = brought_skills(points, body, settings, ros)
    return RobotSkills((*own, *_sound(brought, own)), handle)


def _pictures(body: Body, settings: Settings, bus: Bus) -> tuple[Skill, ...]:
    """The skill that takes pictures, unless the body has its own of that name."""
    album = Album(pictures_folder(settings), settings.pictures_mb * _MB)
    taken = {one.name for one in body.skills}
    return tuple(one for one in picture_skills(body, album, bus.publish) if one.name not in taken)


def about_packages() -> str:
    """The packages that bring skills, for people; those that are broken with the reason."""
    told = [
        f"{name} (installed, but broken: {fault})" if (fault := fault_of(point)) else name
        for name, point in installed_skills().items()
    ]
    return "Packages with skills: " + (", ".join(told) or "none") + "."


def _sound(brought: Iterator[tuple[str, Skill]], own: Sequence[Skill]) -> Iterator[Skill]:
    """Yield the skills that fit beside the others; one that does not is reported by name."""
    taken = {one.name for one in own}
    for package, one in brought:
        try:
            _check(one, taken)
        except Exception as error:  # noqa: BLE001 - of templates a library raises what it likes
            log.warning("skill_refused", skill=one.name, package=package, reason=str(error))
            continue
        taken.add(one.name)
        yield one


def _check(one: Skill, taken: set[str]) -> None:
    """Raise for a skill with a name or a sentence that cannot be."""
    if one.name in taken:
        raise InvalidValue("skill", one.name, "a name that this robot's skills do not have yet")
    check_skills([one])
    _check_templates(one, one.templates, ENGLISH)
    for language, phrases in one.phrases.items():
        _check_templates(one, phrases.templates, language)


def _check_templates(one: Skill, templates: Sequence[str], language: str) -> None:
    for template in templates:
        parse_sentence(template)
        unknown = phrasebook(language).slots(template) - one.arguments_model.model_fields.keys()
        if unknown:
            known = ", ".join(one.arguments_model.model_fields) or "none"
            raise InvalidValue(f"{one.name}.templates", min(unknown), f"an argument: {known}")
