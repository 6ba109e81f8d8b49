"""The abilities of a robot in words, from its skills and without a model."""

from collections.abc import Sequence

from edgevox.agent.nlu.hearing.wordings import wordings
from edgevox.agent.phrases.phrasebook import MOST_SPOKEN, Phrasebook
from edgevox.agent.skills import STOP, Skill
from edgevox.agent.text.words import as_part


def abilities(book: Phrasebook, skills: Sequence[Skill]) -> tuple[str, str]:
    """A sentence with a few abilities, and one with all if there are more.

    Abilities of this robot alone come first, and how to stop it comes last.
    """
    actions = [_can(book, one) for one in _telling(book, skills)]
    if not actions:
        return "", ""
    everything = book.say("abilities", actions="; ".join(actions))
    if len(actions) <= MOST_SPOKEN:
        return everything, ""
    few = "; ".join(actions[: MOST_SPOKEN - 1])
    more = len(actions) - MOST_SPOKEN + 1
    return book.say("abilities_more", actions=few, count=more), everything


def not_understood(book: Phrasebook, skills: Sequence[Skill]) -> tuple[str, str]:
    """The sentence "not understood" with an example, and a detail to write.

    The detail has a few more examples and tells how to ask for all.
    """
    if not skills:
        return book.say("not_understood"), ""
    few, everything = abilities(book, skills)
    if everything:
        question = book.say("abilities_question")
        few = f"{few} {book.say('abilities_all', question=question)}"
    return book.say("not_understood_but", action=_can(book, _telling(book, skills)[0])), few


def _telling(book: Phrasebook, skills: Sequence[Skill]) -> Sequence[Skill]:
    return sorted(skills, key=lambda one: (book.knows(one), one.name == STOP))


def _can(book: Phrasebook, one: Skill) -> str:
    """The skill's ability in this language, or a sentence that asks for the skill.

    A skill without words in this language has only its description.
    """
    said = book.can(one)
    foreign = book.fallback is not None and said == as_part(one.description)
    return (foreign and _asked_for(book, one)) or said


def _asked_for(book: Phrasebook, one: Skill) -> str:
    sentence = next((each.sentence for each in wordings(one, book) if not each.alone), "")
    return book.say("quoted", words=sentence) if sentence else ""
