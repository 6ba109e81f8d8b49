"""What a place may be called by who talks to the robot."""

from functools import lru_cache

from edgevox.agent.name_rules import check_name, is_clause_word
from edgevox.agent.reasons import because
from edgevox.agent.skills import SkillFailed
from edgevox.core.errors import InvalidValue
from edgevox.robots.name_fields import LONGEST_PLACE, speakable

MOST_PLACES = 200


def check_new_name(name: str) -> None:
    """Raise `SkillFailed` with the reason why no place may ever be called so."""
    if len(name) > LONGEST_PLACE:
        raise SkillFailed(because("place_name_long", limit=str(LONGEST_PLACE)))
    if not speakable(name) or name != " ".join(name.split()):
        raise SkillFailed(because("place_name_wrong"))
    try:
        check_name("name", name)
    except InvalidValue:
        raise SkillFailed(because("place_name_reserved", name=name)) from None
    if is_clause_word(name):
        raise SkillFailed(because("place_name_reserved", name=name))


@lru_cache(maxsize=1024)
def is_fit(name: str) -> bool:
    """Whether a place may be called so."""
    try:
        check_new_name(name)
    except SkillFailed:
        return False
    return True
