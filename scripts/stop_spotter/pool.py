"""The examples that are learnt from: the newest ones, of which those that cost more come again."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Example = tuple[NDArray[np.float16], NDArray[np.int8], int]
"""Features (rows, bands), labels (steps,) and the word, 0 for none."""
EASY = 0.1
"""Beside its cost: so likely is an example that was learnt to be seen again."""
_HARDEST = 3.0  # what costs more comes no more often: it may be wrong


@dataclass(frozen=True, slots=True)
class Batch:
    """Examples to learn from, and where they are in the pool."""

    where: NDArray[np.int64]
    rows: NDArray[np.float16]
    labels: NDArray[np.int8]
    words: NDArray[np.int8]


class Pool:
    """Holds so many examples; a new one takes the place of the oldest."""

    def __init__(self, size: int) -> None:
        self.size = size
        self.added = 0
        self._arrays: dict[str, NDArray[np.generic]] = {}

    def __len__(self) -> int:
        return min(self.added, self.size)

    def add(self, examples: Sequence[Example]) -> NDArray[np.int64]:
        """Where they are. They cost as much as the costliest until somebody knows better."""
        if not self._arrays:
            self._arrays = self._empty(examples[0])
        costs = self._arrays["costs"]
        cost = float(costs[: len(self)].max()) if len(self) else 1.0
        where = (self.added + np.arange(len(examples))) % self.size
        for at, (rows, labels, word) in zip(where, examples, strict=True):
            self._arrays["rows"][at] = rows
            self._arrays["labels"][at] = labels
            self._arrays["words"][at] = word
            costs[at] = cost
        self.added += len(examples)
        return where

    def batch(self, fresh: NDArray[np.int64], number: int, rng: np.random.Generator) -> Batch:
        """The fresh ones, and others by what they cost, so many together."""
        odds = EASY + np.minimum(self._arrays["costs"][: len(self)].astype(np.float64), _HARDEST)
        odds[fresh] = 0
        chosen = rng.choice(len(self), number - fresh.size, p=odds / odds.sum())
        where = np.append(chosen, fresh)
        return Batch(where, *(self._arrays[name][where] for name in ("rows", "labels", "words")))

    def costed(self, where: NDArray[np.int64], costs: NDArray[np.floating]) -> None:
        """What these cost when they were seen last."""
        self._arrays["costs"][where] = costs

    def state(self) -> dict[str, NDArray[np.generic]]:
        """All of it as arrays, for a checkpoint."""
        return {**self._arrays, "added": np.array([self.added])}

    def resume(self, state: dict[str, NDArray[np.generic]]) -> None:
        """Go on from what `state` gave."""
        self.added = int(state["added"][0])
        self._arrays = {name: array for name, array in state.items() if name != "added"}
        self.size = len(self._arrays["costs"])

    def _empty(self, example: Example) -> dict[str, NDArray[np.generic]]:
        rows, labels, _ = example
        return {
            "rows": np.zeros((self.size, *rows.shape), np.float16),
            "labels": np.zeros((self.size, *labels.shape), np.int8),
            "words": np.zeros(self.size, np.int8),
            "costs": np.zeros(self.size, np.float32),
        }
