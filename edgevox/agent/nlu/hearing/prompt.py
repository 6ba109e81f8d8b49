"""Hearing prompts: likely commands, shown to speech recognition before it listens.

In noise, speech recognition hears what it expects. With the robot's own commands and names in the
prompt, it recognises sentences that it otherwise writes as "Lock forward" or "Get your own place".
"""

import itertools
from collections.abc import Iterable, Iterator

from edgevox.agent.nlu.hearing.wordings import wordings
from edgevox.agent.phrases.load import ENGLISH, phrasebook
from edgevox.agent.phrases.own_names import phrasebook_of
from edgevox.agent.phrases.phrasebook import Phrasebook
from edgevox.agent.skills import Skill, SkillSet

MOST_CHARACTERS = 600
"""Length of a prompt: Whisper reads at most 223 tokens, the last ones of a longer text."""
_MOST_OF_PAIRS = 4
"""Number of sentences of a skill with two names; all combinations would be too many."""


class HearingPrompts:
    """Gives the prompt of each language, rebuilt after the robot has learned words.

    Only English gets the robot's own commands. Names are English in every language, and a prompt
    that mixed two languages made Whisper hear the Portuguese "Pare!" as "París!".
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
    """The prompt of one language: the robot's commands while there is room, then sample commands.

    Each skill gives plain sentences that ask for it, with each name that it knows.
    """
    room = MOST_CHARACTERS - len(book.hearing.written)
    kept: list[str] = []
    for sentence in dict.fromkeys(_in_turns([_usual(one, book) for one in skills])):
        room -= len(sentence) + 1
        if room < 0:
            break
        kept.append(sentence)
    # Whisper expects the last words most, so the sample spelling stands last.
    return " ".join([*kept, book.hearing.written])


def _usual(one: Skill, book: Phrasebook) -> list[str]:
    """The skill's most usual wording with each of its names, and the bare names."""
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
