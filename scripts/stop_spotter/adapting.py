"""Lets Whisper's encoder and the network on it learn together, for noise and rooms.

It begins with a network that was trained on the encoder as it is. In rounds it learns from few
looks at new examples, and from what the network got wrong all along others. It computes in half
precision, as half of it is the encoder's products: 20 ms a look on one core.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import torch
from torch import nn
from torch.nn.functional import cross_entropy
from whisper_training.course import Course
from whisper_training.encoder import Encoder
from whisper_training.whole_file import write_whole

from edgevox.voice.stop_encoder import BANDS, STEPS
from edgevox.voice.stop_network import StopWeights
from stop_spotter.looks import Looks
from stop_spotter.network import arrays_of, network_of
from stop_spotter.training import THRESHOLD

ROUNDS, STEPS_OF_A_ROUND = 5, 120
RANK = 8
POOL, LEARNT, WRONG_SHARE = 256, 128, 0.375
"""So many looks are heard at each step, and so many of them learnt from: mostly those that were
heard wrongly. Of what is heard, so much was wrong before.
"""
EVEN = 0.03
"""How likely a look that was heard rightly is to be learnt from, beside one with a loss of 1."""
FASTEST_ADDED, FASTEST_NETWORK, SMOOTHED = 2e-3, 5e-4, 0.005
_TOLD_EVERY = 20


class Both(nn.Module):
    """The encoder with what is added to it, and the network on it: bands to scores."""

    def __init__(self, folder: Path, start: StopWeights) -> None:
        super().__init__()
        self.encoder = Encoder(folder, RANK, start.added)
        self.network = network_of(start)

    def forward(self, bands: torch.Tensor) -> torch.Tensor:
        return self.network(self.encoder(bands)).float()


@dataclass(frozen=True, slots=True)
class Drawn:
    """Where looks come from: of few looks at each example, and of those that were heard wrongly."""

    some: Sequence[Looks]
    wrong: Sequence[Looks]

    def pool(self, rng: np.random.Generator) -> tuple[np.ndarray, np.ndarray]:
        """Bands (looks, bands, rows), with some of them masked, and labels."""
        wrong = int(POOL * WRONG_SHARE) if self.wrong else 0
        drawn = [*_of(self.some, POOL - wrong, rng), *_of(self.wrong, wrong, rng)]
        bands = np.concatenate([one for one, _ in drawn]).astype(np.float32)
        return _masked(bands, rng), np.concatenate([one for _, one in drawn]).astype(np.int64)


def _of(
    some: Sequence[Looks], how_many: int, rng: np.random.Generator
) -> list[tuple[np.ndarray, np.ndarray]]:
    sizes = np.array([len(one.labels) for one in some], float)
    if not how_many:
        return []
    each = rng.multinomial(how_many, sizes / sizes.sum())
    where = [
        np.sort(rng.integers(len(one.labels), size=n)) for one, n in zip(some, each, strict=True)
    ]
    return [(one.seen[at], one.labels[at]) for one, at in zip(some, where, strict=True)]


def _masked(bands: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    """Some without a few bands, some without a moment (SpecAugment, Park and others 2019)."""
    for one in bands:
        if rng.random() < 0.3:
            wide = rng.integers(2, 12)
            first = rng.integers(BANDS - wide)
            one[first : first + wide] = one.mean()
        if rng.random() < 0.15:
            long = rng.integers(2, 8)
            first = rng.integers(2 * STEPS - long)
            one[:, first : first + long] = one.min()
    return bands


class Adapting:
    """A training that goes on from round to round; its file keeps all that it needs for that."""

    def __init__(self, folder: Path, start: StopWeights, file: Path, steps: int) -> None:
        torch.manual_seed(7)
        self.both = Both(folder, start)
        speeds = {self.both.encoder: FASTEST_ADDED, self.both.network: FASTEST_NETWORK}
        self._course = Course(self.both, speeds, file, steps)

    @property
    def done(self) -> int:
        """How many steps are."""
        return self._course.done

    def learn(self, drawn: Drawn, until: int, weights: Path, told: Callable[[str], None]) -> None:
        """Until so many steps are done in all; then what runs is written to `weights`."""
        rng = np.random.default_rng((23, self.done))
        means = np.zeros(2)
        while self.done < until:
            bands, labels = (torch.from_numpy(one) for one in drawn.pool(rng))
            at, heard = self._to_learn(bands, labels, rng)
            self.both.train()
            with torch.autocast("cpu", torch.bfloat16):
                scores = self.both(bands[at])
            loss = cross_entropy(scores, labels[at], label_smoothing=SMOOTHED)
            self._course.step(loss)
            means += np.array([heard, loss.item()]) / _TOLD_EVERY
            if self.done % _TOLD_EVERY == 0:
                of = f"step {self.done} of {self._course.steps}"
                told(f"{of}, loss {means[0]:.3f}, learnt {means[1]:.3f}")
                means[:] = 0
        self._keep(weights)

    def _to_learn(
        self, bands: torch.Tensor, labels: torch.Tensor, rng: np.random.Generator
    ) -> tuple[torch.Tensor, float]:
        """Which of these looks, and the mean loss of all."""
        self.both.eval()
        with torch.no_grad(), torch.autocast("cpu", torch.bfloat16):
            losses = cross_entropy(self.both(bands), labels, reduction="none").numpy()
        odds = np.minimum(losses, 1.0).astype(np.float64) + EVEN
        at = rng.choice(len(losses), LEARNT, replace=False, p=odds / odds.sum())
        return torch.from_numpy(np.sort(at)), float(losses.mean())

    def _keep(self, weights: Path) -> None:
        self._course.keep()
        self.both.eval()
        arrays = arrays_of(self.both.network, THRESHOLD)
        arrays |= {name: one.astype(np.float16) for name, one in self.both.encoder.added()}
        write_whole(weights, lambda out: np.savez(out, **arrays))
