"""What EdgeVox says, by the names that the phrasebooks have for it: a test of ours holds no words.

How the words read is in the golden files of tests/unit/golden. Languages are given as `language`.
"""

from collections.abc import Callable, Mapping
from typing import Any

from support.bodies import BODIES

from edgevox.agent.phrases.load import ENGLISH, phrasebook
from edgevox.agent.skills import Skill, SkillFailed
from edgevox.agent.text import reasons
from edgevox.agent.text.words import bare, fields
from edgevox.ros2.clients import interface_reason

_SKILLS: Mapping[str, Skill] = {
    one.name: one for body in ("humanoid", "panda", "apartment") for one in BODIES[body].values()
}


def said(name: str, *, language: str = ENGLISH, **values: Any) -> str:
    """One of the agent's own sentences."""
    return phrasebook(language).say(name, **values)


def opening(name: str, **values: Any) -> str:
    """How one of the agent's own sentences begins, up to the first value that is not given."""
    names = fields(phrasebook(ENGLISH).sentences[name])
    return said(name, **dict.fromkeys(names, "\0") | values).partition("\0")[0]


def refused(reason: str, *, language: str = ENGLISH, **about: Any) -> str:
    """What is said when a call was not begun, for the reason of this code."""
    return phrasebook(language).refusal(reasons.because(reason, **about))


def failed(reason: str, *, language: str = ENGLISH, **about: Any) -> str:
    """What is said when a call has failed, for the reason of this code."""
    return phrasebook(language).failure(reasons.because(reason, **about))


def why(reason: str, *, language: str = ENGLISH, **about: Any) -> str:
    """The reason of this code, as it stands in what is said."""
    return bare(phrasebook(language).reason(reasons.because(reason, **about)))


def interface(reason: str, what: str) -> str:
    """What is said of an interface of the robot that did not do what was asked."""
    return interface_reason(reason, what=what).text


def stands(**where: Any) -> str:
    """How the answer begins to where a bundled robot is, up to the first number."""
    told = phrasebook(ENGLISH).report(_SKILLS["get_pose"], {}, {"x": 7.0, "y": 7.0} | where)
    return told.partition("7")[0]


def begins(skill: str, *, language: str = ENGLISH, **arguments: Any) -> str:
    """What is said when a skill of a bundled robot begins."""
    return phrasebook(language).acknowledge(_SKILLS[skill], arguments)


def done(skill: str, *, language: str = ENGLISH, **results: Any) -> str:
    """What is said when a skill of a bundled robot has succeeded."""
    return phrasebook(language).report(_SKILLS[skill], {}, results)


def asks(skill: str, *, language: str = ENGLISH, **arguments: Any) -> str:
    """What is asked before a skill of a bundled robot is begun."""
    return phrasebook(language).question([(_SKILLS[skill], arguments)])


def because(code: str, **about: str) -> Callable[[SkillFailed], bool]:
    """Whether a skill failed for the reason of this code, with these of its values.

    For `pytest.raises(SkillFailed, check=phrases.because("held_already", thing="red cube"))`.
    """

    def fits(error: SkillFailed) -> bool:
        values = {name: str(value) for name, value in error.reason.values.items()}
        return error.reason.code == code and about.items() <= values.items()

    return fits
