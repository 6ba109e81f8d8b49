"""The tokenizer of the encoder: it finds the likeliest pieces of a sentence by a unigram model.

It is our own, because the vocabulary is inside the packed file of the weights, and the libraries
for such vocabularies read only files of their own formats.
"""

import math

from edgevox.agent.nlu.encoder.packed_file import Vocabulary

_SPACE = "\N{LOWER ONE EIGHTH BLOCK}"
"""Stands for a space in the pieces."""
_UNKNOWN_COSTS = 10.0
"""An unknown character is this much less likely than the least likely piece."""


class Pieces:
    """A tokenizer with a vocabulary."""

    def __init__(self, vocabulary: Vocabulary) -> None:
        self._vocabulary = vocabulary
        self._unknown_score = float(vocabulary.scores.min()) - _UNKNOWN_COSTS

    def ids(self, text: str) -> list[int]:
        """The ids of the pieces, between those of the beginning and the end."""
        known = self._vocabulary
        written = "".join(known.written.get(ord(character), character) for character in text)
        spaced = _SPACE + _SPACE.join(written.split(" ")) if written else _SPACE
        while 2 * _SPACE in spaced:
            spaced = spaced.replace(2 * _SPACE, _SPACE)
        return [known.begin, *self._likeliest(spaced), known.end]

    def _likeliest(self, text: str) -> list[int]:
        """The ids of the split whose pieces are likeliest together."""
        known = self._vocabulary
        encoded = [character.encode() for character in text]
        best = [0.0] + [-math.inf] * len(text)
        came_from = [(0, known.unknown)] * (len(text) + 1)
        for start in range(len(text)):
            unknown = best[start] + self._unknown_score
            if unknown > best[start + 1]:
                best[start + 1], came_from[start + 1] = unknown, (start, known.unknown)
            piece = b""
            for end in range(start, len(text)):
                piece += encoded[end]
                if len(piece) > known.longest:
                    break
                number = known.ids.get(piece)
                if number is None or number == known.unknown:
                    continue
                score = best[start] + float(known.scores[number])
                if score > best[end + 1]:
                    best[end + 1], came_from[end + 1] = score, (start, number)
        numbers, at = [], len(text)
        while at:
            at, number = came_from[at]
            numbers.append(number)
        return numbers[::-1]
