"""The network of the stop word spotter, as it runs: causal convolutions over time, in NumPy.

A first convolution halves the rate to one step in 16 ms; blocks follow, each a convolution over
three steps of the past that lie further and further apart, added to what went in. A softmax tells
nothing from the words. It keeps what its convolutions reach back to, so that each step is computed
once.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from importlib.resources import files
from io import BytesIO
from typing import Any

import numpy as np

from edgevox.voice.stop_features import BANDS, Floats

WEIGHTS_FILE = "stop_spotter.npz"
"""Made by `scripts/train_stop_spotter.py`."""
STRIDE = 2
"""Rows of features a step."""


@dataclass(frozen=True, slots=True)
class Block:
    """`mixing` (taps * channels, channels) and its bias; the taps are `dilation` steps apart."""

    mixing: Floats
    bias: Floats
    dilation: int

    @property
    def taps(self) -> int:
        return len(self.mixing) // len(self.bias)

    @property
    def reach(self) -> int:
        """How many steps it looks back."""
        return (self.taps - 1) * self.dilation


@dataclass(frozen=True, slots=True)
class StopWeights:
    """Of the whole network; `words` are its outputs, the first one for none.

    `first` has the shape (taps * bands, channels). From `threshold` on, a word counts as said.
    """

    words: tuple[str, ...]
    first: Floats
    first_bias: Floats
    blocks: tuple[Block, ...]
    last: Floats
    last_bias: Floats
    threshold: float


class StopNetwork:
    """Takes rows of features as they come, and says at every step how likely each word is."""

    def __init__(self, weights: StopWeights) -> None:
        self._weights = weights
        self._taps = len(weights.first) // BANDS
        self.forget()

    def forget(self) -> None:
        """What comes next does not follow on what was before."""
        channels = self._weights.first.shape[1]
        self._rows = np.zeros((self._taps - STRIDE, BANDS), np.float32)
        self._past = [np.zeros((b.reach, channels), np.float32) for b in self._weights.blocks]

    def push(self, rows: Floats) -> Floats:
        """Likelihoods, shape (steps, words), after an even number of rows."""
        known = self._weights
        rows = np.concatenate([self._rows, rows])
        self._rows = rows[len(rows) - len(self._rows) :]
        steps = (len(rows) - self._taps) // STRIDE + 1
        seen = np.stack([rows[n * STRIDE : n * STRIDE + self._taps].ravel() for n in range(steps)])
        values = np.maximum(seen @ known.first + known.first_bias, 0)
        for number, block in enumerate(known.blocks):
            whole = np.concatenate([self._past[number], values])
            self._past[number] = whole[steps:]
            taps = [
                whole[n * block.dilation : n * block.dilation + steps] for n in range(block.taps)
            ]
            mixed = np.concatenate(taps, axis=1) @ block.mixing + block.bias
            values = values + np.maximum(mixed, 0)
        scores = values @ known.last + known.last_bias
        grown = np.exp(scores - scores.max(axis=1, keepdims=True))
        return np.asarray(grown / grown.sum(axis=1, keepdims=True), np.float32)


def read_weights() -> StopWeights:
    """Those that this package brings."""
    with np.load(BytesIO(files(__package__).joinpath(WEIGHTS_FILE).read_bytes())) as data:
        return weights_of(data)


def weights_of(data: Mapping[str, Any]) -> StopWeights:
    """From the arrays of their file, which keeps them in half precision."""

    def floats(name: str) -> Floats:
        return np.asarray(data[name], np.float32)

    blocks = tuple(
        Block(floats(f"block{n}"), floats(f"block_bias{n}"), int(dilation))
        for n, dilation in enumerate(data["dilations"])
    )
    return StopWeights(
        tuple(str(word) for word in data["words"]), floats("first"), floats("first_bias"), blocks,
        floats("last"), floats("last_bias"), float(data["threshold"]),
    )  # fmt: skip
