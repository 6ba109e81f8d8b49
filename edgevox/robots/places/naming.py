"""What a place may be called by who talks to the robot."""

from collections.abc import Mapping

from edgevox.agent.name_rules import check_name, is_clause_word, is_sentence
from edgevox.agent.reasons import because
from edgevox.agent.same_name import name_form, names_meant, names_near
from edgevox.agent.skills import SkillFailed
from edgevox.core.errors import InvalidValue
from edgevox.robots.name_fields import LONGEST_PLACE, speakable

MOST_PLACES = 200


def check_new_name(name: str, own: Mapping[str, str]) -> None:
    """Raise `SkillFailed` with the reason why no place may ever be called so.

    `own` is what people say for the places of the map, as `name_rules.names_of` gives it.
    """
    if len(name) > LONGEST_PLACE:
        raise SkillFailed(because("place_name_long", limit=str(LONGEST_PLACE)))
    if not speakable(name) or name != " ".join(name.split()):
        raise SkillFailed(because("place_name_wrong"))
    try:
        check_name("name", name)
    except InvalidValue:
        raise SkillFailed(because("place_name_reserved", name=name)) from None
    if is_clause_word(name) or not name_form(name):
        raise SkillFailed(because("place_name_reserved", name=name))
    if rooms := names_meant(name, own) or names_near(name, own):
        raise SkillFailed(because("place_of_the_map", place=rooms[0].replace("_", " ")))
    if is_sentence(name, own):
        raise SkillFailed(because("place_name_reserved", name=name))


def is_fit(name: str, own: Mapping[str, str]) -> bool:
    """Whether a place may be called so, beside those of the map."""
    try:
        check_new_name(name, own)
    except SkillFailed:
        return False
    return True
