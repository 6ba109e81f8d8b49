"""The robots that `edgevox-agent` knows by name, and the agents that talk for them."""

from collections.abc import Sequence

from edgevox.agent.agents import Agent
from edgevox.agent.phrases.name_rules import check_skills
from edgevox.agent.skills import Skill, SkillSet
from edgevox.apps.folders import places_folder
from edgevox.core.log import get_logger
from edgevox.core.settings import Settings
from edgevox.robots.capabilities import Body, RemembersPlaces, TellsAbout
from edgevox.robots.places.store import PlaceStore
from edgevox.robots.plugin import installed_robots, robot_points

log = get_logger(__name__)

TALK_INSTRUCTIONS = (
    "You are EdgeVox, a voice agent that runs offline and has no robot at the moment. Be friendly"
    " and brief: one or two short sentences."
)

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
