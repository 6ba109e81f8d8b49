"""Search by sound for a misheard command or stop word.

`NearCommands` finds "kitchen, please" in "kitchen plate"; the robot always asks before it acts on
that. `NearStop` finds "freeze" in "Free is a"; one halt too many is better than one too few.
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
"""Share of the sounds that may differ from a stop word: it accepts "free is a" for "freeze" but not
"shop" for "stop"."""
_MOST_WORDS = 3
_USUAL = 3
"""Number of single words from a language's table; later ones are rare, or misspelt."""
_FEWEST_SOUNDS = 3
"""Least number of sounds: a shorter stop word is near to too many words."""


class NearStop:
    """Finds stop words of one language and of English by their sounds."""

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
        """The stop word that the whole of a short utterance sounds like, or None."""
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
"""Share of the sounds that may differ from a command. Measured: misheard commands in noise lie
below, sentences to other people above."""
_MARGIN = 0.05
"""Least distance by which any other command must be farther; otherwise none is found."""
_MOST_CHARACTERS = 60
"""Number of characters from which on a sentence is no plain command."""


@dataclass(frozen=True, slots=True)
class NearCommand:
    """A command that sounds like the heard words."""

    call: Call
    """The call."""
    distance: float
    """Share of the sounds that differ; 0 for the same sounds."""


class NearCommands:
    """Finds plain commands of a set of skills in one language by their sounds.

    Finds nothing in languages without spaces, which espeak-ng cannot read, and nothing in words
    with a number, since these commands have none.
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
        """The one command that the text sounds like, or None."""
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
        """Build the table of sounds now, so that the first misheard sentence need not wait."""
        self._learn()

    def _learn(self) -> None:
        """Rebuild the table if the words of arguments have changed: places are learned."""
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
        """The sounds of a text without articles, which are hardly spoken."""
        words = [word for word in key(text).split() if word not in self._articles]
        return sounds_of(self._phonemes(" ".join(words), self._book.code))
