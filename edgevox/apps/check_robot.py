"""`--check`: what a robot can do, as the files and settings that were given make it."""

from edgevox.agent.name_rules import check_skills
from edgevox.apps.robots import about
from edgevox.robots.capabilities import Body

SHORT = 60
"""A longer template shows nobody what to say."""


def check_robot(body: Body) -> bool:
    """Print the skills of a body that is not started, each with what it can be told; True.

    Raises `InvalidValue` for a name that people need for something else.
    """
    check_skills(body.skills)
    if itself := about(body):
        print(itself)
    print(f"{body.name} has {len(body.skills)} skills:")
    for one in body.skills:
        said = [sentence for sentence in one.templates if len(sentence) <= SHORT]
        print(f"  {one.name}: {one.description} {said[0] if said else ''}".rstrip())
    return True
