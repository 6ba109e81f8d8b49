"""A small multilingual sentence encoder, in numpy: sentences of one meaning get near vectors.

The network is multilingual-e5-small, a BERT with mean pooling, whose weights `packed_file` reads.
A sentence takes some ten milliseconds on one core; nothing but numpy is needed for it.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Protocol

import numpy as np

from edgevox.agent.nlu.packed_file import Floats, Packed
from edgevox.agent.nlu.pieces import Pieces

ENCODER = "multilingual-e5-small"
"""The model's name in the manifest."""

_PREFIX = "query: "
"""What the network was trained to see before a sentence that is compared with others."""
_ERF = (0.254829592, -0.284496736, 1.421413741, -1.453152027, 1.061405429)
_ERF_P = 0.3275911


class SentenceEncoder(Protocol):
    """Makes vectors of sentences."""

    def encode(self, sentences: Sequence[str]) -> Floats:
        """Vectors of length 1, shape (sentences, size)."""


@dataclass(frozen=True, slots=True)
class _Affine:
    weights: Floats
    bias: Floats

    def __call__(self, values: Floats) -> Floats:
        return values @ self.weights + self.bias


@dataclass(frozen=True, slots=True)
class _Norm:
    weights: Floats
    bias: Floats
    epsilon: float

    def __call__(self, values: Floats) -> Floats:
        centred = values - values.mean(-1, keepdims=True)
        spread = np.sqrt((centred**2).mean(-1, keepdims=True) + self.epsilon)
        return centred / spread * self.weights + self.bias


@dataclass(frozen=True, slots=True)
class _Layer:
    query_key_value: _Affine
    out: _Affine
    attended: _Norm
    widen: _Affine
    narrow: _Affine
    thought: _Norm

    def __call__(self, values: Floats, heads: int) -> Floats:
        values = self.attended(values + self.out(_attention(self.query_key_value(values), heads)))
        return self.thought(values + self.narrow(_gelu(self.widen(values))))


class Encoder:
    """The network with the weights of one file. Used from one thread."""

    def __init__(self, path: Path) -> None:
        self._packed = Packed(path)
        self._pieces = Pieces(self._packed.vocabulary)
        self._positions = self._packed.floats("emb.pos").reshape(-1, self._packed.sizes.hidden)
        self._type = self._packed.floats("emb.type")[: self._packed.sizes.hidden]
        self._opened = self._norm("emb.ln")
        self._layers = [self._layer(number) for number in range(self._packed.sizes.layers)]

    def encode(self, sentences: Sequence[str]) -> Floats:
        """See `SentenceEncoder`; sentences of one length are computed together."""
        numbers = [self._pieces.ids(_PREFIX + sentence) for sentence in sentences]
        longest = self._packed.sizes.tokens
        vectors = np.zeros((len(sentences), self._packed.sizes.hidden), np.float32)
        for length in {len(one) for one in numbers}:
            chosen = [index for index, one in enumerate(numbers) if len(one) == length]
            vectors[chosen] = self._forward(np.array([numbers[i][:longest] for i in chosen]))
        return vectors

    def _forward(self, numbers: np.ndarray[tuple[int, int], np.dtype[np.int64]]) -> Floats:
        sentences, tokens = numbers.shape
        words = self._packed.rows(numbers.reshape(-1)).reshape(sentences, tokens, -1)
        values = self._opened(words + self._positions[:tokens] + self._type)
        for layer in self._layers:
            values = layer(values, self._packed.sizes.heads)
        pooled = values.mean(1)
        return np.asarray(pooled / np.linalg.norm(pooled, axis=1, keepdims=True), np.float32)

    def _layer(self, number: int) -> _Layer:
        hidden, inner = self._packed.sizes.hidden, self._packed.sizes.inner
        three = [self._affine(f"l{number}.{name}", hidden) for name in "qkv"]
        return _Layer(
            _Affine(
                np.concatenate([one.weights for one in three], axis=1),
                np.concatenate([one.bias for one in three]),
            ),
            self._affine(f"l{number}.ao", hidden),
            self._norm(f"l{number}.aln"),
            self._affine(f"l{number}.fi", hidden),
            self._affine(f"l{number}.fo", inner),
            self._norm(f"l{number}.oln"),
        )

    def _affine(self, name: str, columns: int) -> _Affine:
        weights = np.ascontiguousarray(self._packed.matrix(f"{name}.w", columns).T)
        return _Affine(weights, self._packed.floats(f"{name}.b"))

    def _norm(self, name: str) -> _Norm:
        weights, bias = self._packed.floats(f"{name}.w"), self._packed.floats(f"{name}.b")
        return _Norm(weights, bias, self._packed.epsilon)


def _attention(query_key_value: Floats, heads: int) -> Floats:
    """What each token takes from the others, shape (sentences, tokens, values)."""
    sentences, tokens, three = query_key_value.shape
    parted = query_key_value.reshape(sentences, tokens, 3, heads, three // 3 // heads)
    query, key, value = parted.transpose(2, 0, 3, 1, 4)
    scores = query @ key.transpose(0, 1, 3, 2) / np.sqrt(np.float32(query.shape[-1]))
    scores = np.exp(scores - scores.max(-1, keepdims=True))
    taken = scores / scores.sum(-1, keepdims=True) @ value
    return np.asarray(taken.transpose(0, 2, 1, 3).reshape(sentences, tokens, -1), np.float32)


def _gelu(values: Floats) -> Floats:
    """x times the likelihood that a normal value is below x; numpy has no error function."""
    scaled = np.abs(values) * np.float32(0.7071067811865476)
    t = 1 / (1 + np.float32(_ERF_P) * scaled)
    series = np.zeros_like(t)
    for factor in reversed(_ERF):
        series = t * (np.float32(factor) + series)
    error = np.copysign(1 - series * np.exp(-scaled * scaled), values)
    return np.asarray(values * np.float32(0.5) * (1 + error), np.float32)
