"""A small multilingual network that reads a sentence, in numpy: what it holds of it as numbers.

It is multilingual-e5-small, a BERT, whose weights `packed_file` reads. Its last layers are made for
what a text is about; how it is meant (asked, told, wished, denied) is clearest some layers before,
so the last ones are left out. A sentence takes some ten milliseconds on one core.

Our own arithmetic, since no runtime for such networks reads the packed file that the weights are
in, of which only what a sentence needs is ever in memory.
"""

from dataclasses import dataclass
from pathlib import Path
from typing import Protocol

import numpy as np

from edgevox.agent.nlu.encoder.packed_file import Floats, Packed
from edgevox.agent.nlu.encoder.pieces import Pieces

ENCODER = "multilingual-e5-small"
"""The model's name in the manifest."""

LAYERS = 9
"""Of twelve. On the tuning half of the corpus commands are told from the rest with an area under
the curve of 0.94 by the 8th and 9th, of 0.91 by the 12th."""
_PREFIX = "query: "
"""What the network was trained to see before a sentence."""
_ERF = (0.254829592, -0.284496736, 1.421413741, -1.453152027, 1.061405429)
_ERF_P = 0.3275911
_WORK_AT_ONCE = 12288
"""Weights that are multiplied at once: so few that the linear algebra library stays on one thread.
On two threads a sentence takes up to 0.6 s while something else keeps one core busy."""


class SentenceReader(Protocol):
    """Makes numbers of a sentence."""

    def features(self, text: str) -> Floats:
        """Its features, shape (size,)."""


@dataclass(frozen=True, slots=True)
class _Affine:
    weights: Floats
    bias: Floats

    @classmethod
    def of(cls, rows: Floats, bias: Floats) -> "_Affine":
        """Of weights in rows, one a value that comes out: in blocks of some rows, transposed."""
        count, size = rows.shape
        blocks = count // max(1, min(count, _WORK_AT_ONCE // size))
        return cls(np.ascontiguousarray(rows.reshape(blocks, -1, size).transpose(0, 2, 1)), bias)

    def __call__(self, values: Floats) -> Floats:
        parts = values[None] @ self.weights
        joined = parts.transpose(1, 0, 2).reshape(len(values), -1) + self.bias
        return np.asarray(joined, np.float32)


@dataclass(frozen=True, slots=True)
class _Norm:
    weights: Floats
    bias: Floats
    epsilon: float

    def __call__(self, values: Floats) -> Floats:
        centred = values - values.mean(-1, keepdims=True)
        spread = np.sqrt((centred**2).mean(-1, keepdims=True) + self.epsilon)
        return np.asarray(centred / spread * self.weights + self.bias, np.float32)


@dataclass(frozen=True, slots=True)
class _Layer:
    query_key_value: _Affine
    out: _Affine
    attended: _Norm
    widen: _Affine
    narrow: _Affine
    thought: _Norm

    def __call__(self, values: Floats, heads: int) -> Floats:
        values = self.attended(values + self.out(_wake_gate(self.query_key_value(values), heads)))
        return self.thought(values + self.narrow(_gelu(self.widen(values))))


class Encoder:
    """The network with the weights of one file. Used from one thread."""

    def __init__(self, path: Path) -> None:
        self._packed = Packed(path)
        self._pieces = Pieces(self._packed.vocabulary)
        self._positions = self._packed.floats("emb.pos").reshape(-1, self._packed.sizes.hidden)
        self._type = self._packed.floats("emb.type")[: self._packed.sizes.hidden]
        self._opened = self._norm("emb.ln")
        self._layers = [self._layer(number) for number in range(LAYERS)]

    def features(self, text: str) -> Floats:
        """The largest values of the layer before the last, and the means of the last."""
        numbers = self._pieces.ids(_PREFIX + text)[: self._packed.sizes.tokens]
        words = self._packed.rows(np.array(numbers))
        values = self._opened(words + self._positions[: len(numbers)] + self._type)
        for layer in self._layers[:-1]:
            values = layer(values, self._packed.sizes.heads)
        means = self._layers[-1](values, self._packed.sizes.heads).mean(0)
        return np.concatenate([means, values.max(0)])

    def _layer(self, number: int) -> _Layer:
        hidden, inner = self._packed.sizes.hidden, self._packed.sizes.inner
        three = [self._rows(f"l{number}.{name}", hidden) for name in "qkv"]
        return _Layer(
            _Affine.of(
                np.concatenate([rows for rows, _ in three]),
                np.concatenate([bias for _, bias in three]),
            ),
            self._affine(f"l{number}.ao", hidden),
            self._norm(f"l{number}.aln"),
            self._affine(f"l{number}.fi", hidden),
            self._affine(f"l{number}.fo", inner),
            self._norm(f"l{number}.oln"),
        )

    def _affine(self, name: str, columns: int) -> _Affine:
        return _Affine.of(*self._rows(name, columns))

    def _rows(self, name: str, columns: int) -> tuple[Floats, Floats]:
        return self._packed.matrix(f"{name}.w", columns), self._packed.floats(f"{name}.b")

    def _norm(self, name: str) -> _Norm:
        weights, bias = self._packed.floats(f"{name}.w"), self._packed.floats(f"{name}.b")
        return _Norm(weights, bias, self._packed.epsilon)


def _wake_gate(query_key_value: Floats, heads: int) -> Floats:
    """What each token takes from the others, shape (tokens, values)."""
    tokens, three = query_key_value.shape
    parted = query_key_value.reshape(tokens, 3, heads, three // 3 // heads)
    query, key, value = parted.transpose(1, 2, 0, 3)
    scores = query @ key.transpose(0, 2, 1) / np.sqrt(np.float32(query.shape[-1]))
    scores = np.exp(scores - scores.max(-1, keepdims=True))
    taken = scores / scores.sum(-1, keepdims=True) @ value
    return np.asarray(taken.transpose(1, 0, 2).reshape(tokens, -1), np.float32)


def _gelu(values: Floats) -> Floats:
    """Each x times the likelihood that a normal value is below x; numpy has no error function."""
    scaled = np.abs(values) * np.float32(0.7071067811865476)
    t = 1 / (1 + np.float32(_ERF_P) * scaled)
    series = np.zeros_like(t)
    for factor in reversed(_ERF):
        series = t * (np.float32(factor) + series)
    error = np.copysign(1 - series * np.exp(-scaled * scaled), values)
    return np.asarray(values * np.float32(0.5) * (1 + error), np.float32)
