"""Finds the command that a misheard sentence sounds like: "kitchen plate" for "kitchen, please".

A robot asks about what it finds here; it never simply moves by it.
"""

from dataclasses import dataclass

import numpy as np

from edgevox.agent.nlu.sounds import Phonemes, SoundTable, sounds_of
from edgevox.agent.nlu.wordings import Wording, wordings
from edgevox.agent.numbers import digits
from edgevox.agent.phrasebook import Phrasebook
from edgevox.agent.skills import STOP, Call, SkillSet
from edgevox.agent.spelling import key

NEAR = 0.3
"""So great a share of the sounds may differ. Measured: what was said in noise and written down
otherwise lies below, what was said to somebody else above."""
_MARGIN = 0.05
"""By so much any other command must be farther: of two that are as near none is meant."""
_MOST_CHARACTERS = 60
"""Longer sentences are no plain commands."""


@dataclass(frozen=True, slots=True)
class NearCommand:
    """A command that sounds like what was heard; at a distance of 0 it sounds the same."""

    call: Call
    distance: float


class NearCommands:
    """The plain commands of a set of skills in one language, by their sounds.

    Where words have no spaces between them nothing is found: there espeak-ng cannot read them. Nor
    is it where a number was heard, since the commands here have none.
    """

    def __init__(self, skills: SkillSet, book: Phrasebook, phonemes: Phonemes) -> None:
        self._skills = skills
        self._book = book
        self._phonemes = phonemes
        self._articles = frozenset(book.hearing.articles)
        self._words: object = None
        self._wordings: list[Wording] = []
        self._table = SoundTable(())

    def nearest(self, text: str) -> NearCommand | None:
        """The one command that this sounds like, if there is one."""
        spaced = self._book.hearing.spaced
        if len(text) > _MOST_CHARACTERS or not spaced or self._has_number(text):
            return None
        self._learn()
        distances = self._table.distances(self._sounds(text), NEAR + _MARGIN)
        if not distances.size:
            return None
        best = int(np.argmin(distances))
        call, distance = self._wordings[best].call, float(distances[best])
        if distance > NEAR:
            return None
        rivals = np.flatnonzero(distances < distance + _MARGIN)
        if any(self._wordings[at].call != call for at in rivals):
            return None
        return NearCommand(call, distance)

    def _has_number(self, text: str) -> bool:
        return any(one.isdigit() for one in digits(text, self._book.code))

    def prepare(self) -> None:
        """Make ready now what the first misheard sentence would have to wait for."""
        self._learn()

    def _learn(self) -> None:
        """The words of arguments may change while the robot runs: places are remembered."""
        words = self._skills.words()
        if words == self._words:
            return
        self._words = words
        self._wordings = [
            wording
            for one in self._skills.values()
            if not one.lasting and one.name != STOP
            for wording in wordings(one, self._book)
        ]
        self._table = SoundTable([self._sounds(one.sentence) for one in self._wordings])

    def _sounds(self, text: str) -> tuple[int, ...]:
        """Without articles, which are hardly spoken."""
        words = [word for word in key(text).split() if word not in self._articles]
        return sounds_of(self._phonemes(" ".join(words), self._book.code))
