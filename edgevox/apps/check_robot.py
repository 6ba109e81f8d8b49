"""`--check`: what a robot can do, as the files and settings that were given make it."""

from edgevox.agent.name_rules import check_skills
from edgevox.agent.phrase_file import ENGLISH, phrasebook
from edgevox.apps.policy_setup import build_guard, strange_names
from edgevox.apps.robots import about
from edgevox.apps.skill_setup import gather_skills
from edgevox.apps.streams import show
from edgevox.core.bus import Bus
from edgevox.core.settings import Settings
from edgevox.core.text import one_line
from edgevox.robots.capabilities import Body

SHORT = 60
"""A longer template shows nobody what to say."""


def check_robot(body: Body, settings: Settings) -> bool:
    """Print the skills of a body that is not started, each with what it can be told; True.

    Also what its policy names and it has not. Raises `InvalidValue` for a name that people need for
    something else, and for a policy that cannot be used.
    """
    guard = build_guard(settings, Bus(), body)
    check_skills(body.skills)
    skills = gather_skills(body, settings).skills
    if itself := about(body):
        show(one_line(itself))
    english = phrasebook(ENGLISH)
    show(f"{body.name} has {len(skills)} skills:")
    for one in skills:
        templates = map(english.written_out, english.templates(one))
        said = [sentence for sentence in templates if len(sentence) <= SHORT]
        show(one_line(f"  {one.name}: {one.description} {said[0] if said else ''}".rstrip()))
    for text in strange_names(guard, skills):
        show(one_line(f"the policy names what the robot has not: {text}"))
    return True
