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


class SoundTable:
    """A table of phrases by their sounds, to compare with heard words."""

    def __init__(self, phrases: Sequence[tuple[int, ...]]) -> None:
        longest = max(map(len, phrases), default=0)
        self._sounds = np.full((len(phrases), longest), _NO_SOUND, np.intp)
        for row, phrase in enumerate(phrases):
            self._sounds[row, : len(phrase)] = phrase
        self._ends = np.array([len(phrase) for phrase in phrases], np.intp)
        self._sums = np.zeros((len(phrases), longest + 1), np.float32)
        np.cumsum(_WEIGHTS[self._sounds], axis=1, out=self._sums[:, 1:])

    def distances(self, heard: tuple[int, ...], most: float) -> Costs:
        """Distance of each phrase: the share of its sounds that differ, 0 for the same sounds.

        A phrase that is farther than `most` by its length alone is infinitely far.
        """
        whole = self._sums[:, -1] if self._sums.shape[1] else np.zeros(0, np.float32)
        total = float(_WEIGHTS[list(heard)].sum())
        size = np.maximum(np.maximum(whole, total), 1e-6)
        found = np.full(len(self._ends), np.inf, np.float32)
        near = np.flatnonzero(np.abs(whole - total) / size <= most)
        if near.size and heard:
            width = int(self._ends[near].max())
            costs = self._edits(heard, self._sounds[near, :width], self._sums[near, : width + 1])
            found[near] = costs[np.arange(near.size), self._ends[near]] / size[near]
        return found

    @staticmethod
    def _edits(heard: tuple[int, ...], sounds: NDArray[np.intp], sums: Costs) -> Costs:
        """Costs of the cheapest edits from the heard sounds to the beginnings of each phrase.

        Works row by row through the usual table; insertions are a running minimum over a row.
        """
        row = sums.copy()
        for one in heard:
            changed = row[:, :-1] + _SUBSTITUTIONS[one][sounds]
            row += _WEIGHTS[one]
            np.minimum(row[:, 1:], changed, out=row[:, 1:])
            row -= sums
            np.minimum.accumulate(row, axis=1, out=row)
            row += sums
        return row
