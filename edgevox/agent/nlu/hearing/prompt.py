"""What a robot is likely to be told, as a text that whoever writes down speech is shown first.

In noise speech to text hears what it expects. Shown the robot's own commands and names it takes
"Lock forward" and "Get your own place" for what they were.
"""

import itertools
from collections.abc import Iterable, Iterator

from edgevox.agent.nlu.hearing.wordings import wordings
from edgevox.agent.phrases.load import ENGLISH, phrasebook
from edgevox.agent.phrases.own_names import phrasebook_of
from edgevox.agent.phrases.phrasebook import Phrasebook
from edgevox.agent.skills import Skill, SkillSet

MOST_CHARACTERS = 600
"""Whisper reads at most 223 tokens before it listens, and the last ones of a longer text."""
_MOST_OF_PAIRS = 4
"""Sentences of a skill that takes two names; each with each would be too many."""


class HearingPrompts:
    """Gives the prompt of each language, made anew where words were learned meanwhile.

    Only English gets the robot's own commands: names are English in every language, and shown
    sentences that mix two, Portuguese "Pare!" was heard as "París!".
    """

    def __init__(self, skills: SkillSet) -> None:
        self._skills = skills
        self._words: object = None
        self._prompt = ""

    def __call__(self, code: str) -> str:
        if code != ENGLISH:
            return phrasebook(code).hearing.written
        words = self._skills.words()
        if words != self._words:
            skills = self._skills.values()
            self._prompt = hearing_prompt(skills, phrasebook_of(code, skills))
            self._words = words
        return self._prompt


def hearing_prompt(skills: Iterable[Skill], book: Phrasebook) -> str:
    """How commands are written in this language, and then the robot's own: for each skill a plain
    way to ask for it, with each name that it knows while there is room.
    """
    room = MOST_CHARACTERS - len(book.hearing.written)
    kept: list[str] = []
    for sentence in dict.fromkeys(_in_turns([_usual(one, book) for one in skills])):
        room -= len(sentence) + 1
        if room < 0:
            break
        kept.append(sentence)
    # What stands last is expected most: how things are written stays there.
    return " ".join([*kept, book.hearing.written])


def _usual(one: Skill, book: Phrasebook) -> list[str]:
    """Its most usual wording with each of its names, and what is said of those alone."""
    if one.lasting:  # to forget a place must never be what was expected
        return []
    found: dict[tuple[int, tuple[str, ...]], str] = {}
    for wording in wordings(one, book):
        values = tuple(map(str, wording.call.arguments.values()))
        found.setdefault((wording.alone, values), _sentence(wording.sentence))
    most = None if len(one.choices) < 2 else _MOST_OF_PAIRS
    return list(found.values())[:most]


def _sentence(words: str) -> str:
    return f"{words[:1].upper()}{words[1:]}."


def _in_turns(several: Iterable[list[str]]) -> Iterator[str]:
    for row in itertools.zip_longest(*several):
        yield from (one for one in row if one)
