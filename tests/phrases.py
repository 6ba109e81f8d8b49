"""What EdgeVox says, by the names that the phrasebooks have for it: a test of ours holds no words.

How the words read is in the golden files of tests/unit/golden. Languages are given as `language`.
"""

from collections.abc import Mapping
from types import MappingProxyType
from typing import Any

from edgevox.agent.phrase_file import ENGLISH, phrasebook
from edgevox.agent.reasons import because
from edgevox.agent.skills import OneOf, Skill
from edgevox.robots.navigation import navigation_skills
from edgevox.robots.panda.skills import manipulation_skills
from edgevox.robots.places.place_memory import PlaceMemory


class _Nobody:
    """Stands where a body would."""

    places = MappingProxyType({"kitchen": (0.0, 0.0)})


_MEMORY = PlaceMemory("apartment", OneOf(tuple(_Nobody.places)))
_SKILLS: Mapping[str, Skill] = {
    one.name: one
    for one in (*manipulation_skills(_Nobody()), *navigation_skills(_Nobody(), memory=_MEMORY))
}


def said(name: str, *, language: str = ENGLISH, **values: Any) -> str:
    """One of the agent's own sentences."""
    return phrasebook(language).say(name, **values)


def refused(reason: str, *, language: str = ENGLISH, **about: Any) -> str:
    """What is said when a call was not begun, for the reason of this code."""
    return phrasebook(language).refusal(because(reason, **about))


def failed(reason: str, *, language: str = ENGLISH, **about: Any) -> str:
    """What is said when a call has failed, for the reason of this code."""
    return phrasebook(language).failure(because(reason, **about))


def begins(skill: str, *, language: str = ENGLISH, **arguments: Any) -> str:
    """What is said when a skill of a bundled robot begins."""
    return phrasebook(language).acknowledge(_SKILLS[skill], arguments)


def done(skill: str, *, language: str = ENGLISH, **results: Any) -> str:
    """What is said when a skill of a bundled robot has succeeded."""
    return phrasebook(language).report(_SKILLS[skill], {}, results)


def asks(skill: str, *, language: str = ENGLISH, **arguments: Any) -> str:
    """What is asked before a skill of a bundled robot is begun."""
    return phrasebook(language).question([(_SKILLS[skill], arguments)])
