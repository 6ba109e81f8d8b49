"""Finds the command that a misheard sentence sounds like: "kitchen plate" for "kitchen, please".

A robot asks about what it finds here; it never simply moves by it.

A stop word that was nearly heard: "Free is a" for "freeze". Rather a halt too many.
"""

from dataclasses import dataclass

import numpy as np

from edgevox.agent.nlu.hearing.sounds import Phonemes, SoundTable, sounds_of
from edgevox.agent.nlu.hearing.wordings import Wording, wordings
from edgevox.agent.phrases.numbers import digits
from edgevox.agent.phrases.phrasebook import Phrasebook
from edgevox.agent.skills import STOP, Call, SkillSet
from edgevox.agent.text.spelling import key
from edgevox.core.stop_words import STOP_WORDS

_NEAR = 0.35
"""So great a share of the sounds may differ: "free is a" is as near to "freeze", "shop" is not to
"stop"."""
_MOST_WORDS = 3
_USUAL = 3
"""The first single words of a language's table; later ones are rare, or misspelt."""
_FEWEST_SOUNDS = 3
"""What is shorter is near to too much."""


class NearStop:
    """The stop words of one language, and of English, by their sounds."""

    def __init__(self, code: str, phonemes: Phonemes) -> None:
        self._code = code
        self._phonemes = phonemes
        said = [
            (word, self._sounds(word))
            for one in dict.fromkeys((code, "en"))
            for word in _usual(one)
        ]
        known = [(word, sounds) for word, sounds in said if len(sounds) >= _FEWEST_SOUNDS]
        self._words = [word for word, _ in known]
        self._table = SoundTable([sounds for _, sounds in known])

    def find(self, text: str) -> str | None:
        """The stop word that a whole short utterance sounds like, or None."""
        if not self._words or not 0 < len(text.split()) <= _MOST_WORDS:
            return None
        distances = self._table.distances(self._sounds(text), _NEAR)
        best = int(distances.argmin())
        return self._words[best] if distances[best] <= _NEAR else None

    def _sounds(self, text: str) -> tuple[int, ...]:
        return sounds_of(self._phonemes(text, self._code))


def _usual(code: str) -> list[str]:
    return [word for word in STOP_WORDS[code].anywhere if " " not in word][:_USUAL]


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
