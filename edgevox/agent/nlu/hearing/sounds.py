"""Similarity of sounds: an edit distance over phonemes, for many phrases at once.

Speech recognition in noise writes other words that sound alike: "kitchen plate" for "kitchen,
please". The phonemes come from a program that reads a language aloud.
"""

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

Phonemes = Callable[[str, str], str]
"""Returns the phonemes of a text in a language, in letters of the IPA."""
Costs = NDArray[np.float32]
Sounds = tuple[int, ...]

# ruff: noqa: RUF001 - letters of the IPA
_KINDS = (
    "p b", "t d ɾ ʈ ɖ", "k ɡ g q", "f v", "θ ð", "s z", "ʃ ʒ ɕ ʑ", "h x ħ ɦ ç χ", "m", "n ɲ ŋ ɳ",
    "l ɭ ʎ ɫ", "ɹ r ʁ ɻ ɽ", "w ʋ ɥ", "j ʝ",
)  # fmt: skip
"""Kinds of consonants; those of one kind differ in little but the voice."""
_FAMILIES = ((0, 1, 2), (3, 4, 5, 6, 7), (8, 9), (10, 11, 12, 13))
"""Kinds that noise makes alike: stops, hisses, nasals, glides."""
_SAME_KIND, _SAME_FAMILY, _OTHER = 0.3, 0.6, 1.0
_VOWEL_FOR_VOWEL, _VOWEL = 0.4, 0.5
_CONSONANT, _BREATH = 0.8, 0.4
_FULL_VOWELS = "aeiouyæɐɑɒɔəɚɛɜɝɨɪɵøœʉʊʌɯɤɘɞɶ"
_NO_SOUND = 0

_CONSONANTS = {letter: kind for kind, row in enumerate(_KINDS) for letter in row.split()}
_IDS = {letter: at for at, letter in enumerate((*_CONSONANTS, *_FULL_VOWELS), 1)}


def _substitution(one: str, other: str) -> float:
    if one == other:
        return 0.0
    kinds = _CONSONANTS.get(one), _CONSONANTS.get(other)
    if kinds == (None, None):
        return _VOWEL_FOR_VOWEL
    if None in kinds:
        return _OTHER
    if kinds[0] == kinds[1]:
        return _SAME_KIND
    alike = any(kinds[0] in family and kinds[1] in family for family in _FAMILIES)
    return _SAME_FAMILY if alike else _OTHER


def _weight(letter: str) -> float:
    """Cost of a sound that is missing or added."""
    if letter not in _CONSONANTS:
        return _VOWEL
    return _BREATH if _KINDS[_CONSONANTS[letter]].startswith("h") else _CONSONANT


_SUBSTITUTIONS: Costs = np.zeros((len(_IDS) + 1, len(_IDS) + 1), np.float32)
_WEIGHTS: Costs = np.zeros(len(_IDS) + 1, np.float32)
for _one, _at in _IDS.items():
    _WEIGHTS[_at] = _weight(_one)
    for _other, _column in _IDS.items():
        _SUBSTITUTIONS[_at, _column] = _substitution(_one, _other)


def sounds_of(phonemes: str) -> tuple[int, ...]:
    """The sounds as numbers, without stress, length, tones and gaps between words."""
    return tuple(_IDS[letter] for letter in phonemes if letter in _IDS)


_BUCKETS = (4, 8, 16)
"""Lengths up to which phrases are compared together: each then takes the time of the longest."""


class SpanTable:
    """A table of phrases by their sounds, to compare with each piece of what was heard."""

    def __init__(self, phrases: Sequence[Sounds]) -> None:
        self._number = len(phrases)
        self._weights = np.array([self.weight(one) for one in phrases], np.float32)
        lengths = np.array([len(one) for one in phrases], np.intp)
        bucket = np.digitize(lengths, _BUCKETS, right=True)
        self._buckets = [
            (rows, [phrases[row] for row in rows.tolist()])
            for number in range(len(_BUCKETS) + 1)
            if (rows := np.flatnonzero(bucket == number)).size
        ]

    @staticmethod
    def weight(sounds: Sounds) -> float:
        """The cost of leaving all these sounds out."""
        return float(_WEIGHTS[list(sounds)].sum())

    def distances(self, heard: Sounds) -> Costs:
        """Distance of each phrase from all that was heard: the share of the sounds that differ.

        0 for the same sounds; infinite if one is much longer than the other.
        """
        weights = np.maximum(self._weights, max(self.weight(heard), 1e-6))
        return np.asarray(self.spans(heard)[:, 0, -1] / weights)

    def spans(self, heard: Sounds) -> Costs:
        """Cost of each phrase for the sounds from one position to another: (phrases, n+1, n+1).

        Infinite for pieces that are much longer than the phrase, and that end before they begin.
        """
        size = len(heard)
        found = np.full((self._number, size + 1, size + 1), np.inf, np.float32)
        changes = _SUBSTITUTIONS[list(heard)]
        lost = _WEIGHTS[list(heard)]
        for rows, phrases in self._buckets:
            self._fill(found, rows, phrases, changes, lost)
        return found

    @staticmethod
    def _fill(
        found: Costs, rows: NDArray[np.intp], phrases: Sequence[Sounds], changes: Costs, lost: Costs
    ) -> None:
        size, longest = len(lost), max(map(len, phrases))
        sounds = np.full((len(phrases), longest), _NO_SOUND, np.intp)
        for row, phrase in enumerate(phrases):
            sounds[row, : len(phrase)] = phrase
        ends = np.array([len(phrase) for phrase in phrases], np.intp)
        sums = np.zeros((len(phrases), longest + 1), np.float32)
        np.cumsum(_WEIGHTS[sounds], axis=1, out=sums[:, 1:])
        every = np.arange(len(phrases))
        costs = np.repeat(sums[None], size + 1, axis=0)  # (starts, phrases, sounds)
        substitutions = changes[:, sounds]
        for taken in range(min(size, longest + longest // 2 + 2) + 1):
            starts = np.arange(size + 1 - taken)
            if taken:
                costs = costs[: starts.size]
                at = starts + taken - 1
                changed = costs[:, :, :-1] + substitutions[at]
                costs = costs + lost[at][:, None, None]
                np.minimum(costs[:, :, 1:], changed, out=costs[:, :, 1:])
                costs -= sums
                np.minimum.accumulate(costs, axis=2, out=costs)
                costs += sums
            found[rows[:, None], starts[None], starts[None] + taken] = costs[:, every, ends].T
