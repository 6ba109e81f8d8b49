"""Learns from the looks of all rounds that there are: minutes, so it begins anew each time."""

from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
import torch
from torch.nn.functional import cross_entropy
from whisper_training.whole_file import write_whole

from stop_spotter.looks import Looks
from stop_spotter.network import Network, arrays_of

THRESHOLD = 0.9
"""Of what was trained; which one is right is chosen afterwards."""
BATCH, FASTEST, DECAY, WARMING, SMOOTHED = 256, 1.5e-3, 0.02, 0.1, 0.005
LATER_COUNT = 4
"""A look of a later round is learnt from so many times as often as one of the first."""
_TOLD_EVERY = 200


def fit(
    rounds: Sequence[Looks], steps: int, seed: int, file: Path, told: Callable[[str], None]
) -> None:
    """Learn for so many steps, and write the network to its file."""
    drawn = [(one, LATER_COUNT if number else 1) for number, one in enumerate(rounds)]
    network = learnt(Network(), drawn, steps, loss_of_words, told, seed=seed)
    write_whole(file, lambda out: np.savez(out, **arrays_of(network.eval(), THRESHOLD)))


def loss_of_words(scores: torch.Tensor, labels: torch.Tensor) -> torch.Tensor:
    """Of scores (looks, words)."""
    return cross_entropy(scores, labels, label_smoothing=SMOOTHED)


Drawn = Sequence[tuple[Looks, int]]
"""Looks, and how often one of them is drawn beside one of the others."""
LossOf = Callable[[torch.Tensor, torch.Tensor], torch.Tensor]
"""Of scores (looks, outputs) and labels."""


def learnt(
    network: Network,
    drawn: Drawn,
    steps: int,
    loss_of: LossOf,
    told: Callable[[str], None],
    *,
    seed: int,
) -> Network:
    """The network after so many steps."""
    torch.manual_seed(seed)
    rng, mean = np.random.default_rng(seed), 0.0
    optimiser = torch.optim.AdamW(network.parameters(), weight_decay=DECAY)
    rate = torch.optim.lr_scheduler.OneCycleLR(optimiser, FASTEST, steps, pct_start=WARMING)
    for step in range(1, steps + 1):
        encoded, labels = _batch(drawn, rng)
        loss = loss_of(network(encoded), labels)
        optimiser.zero_grad()
        loss.backward()
        optimiser.step()
        rate.step()
        mean += loss.item() / _TOLD_EVERY
        if step % _TOLD_EVERY == 0:
            told(f"step {step} of {steps}, loss {mean:.3f}")
            mean = 0.0
    return network


def _batch(drawn: Drawn, rng: np.random.Generator) -> tuple[torch.Tensor, torch.Tensor]:
    """Of all looks, by how many there are."""
    rounds = [one for one, _ in drawn]
    sizes = np.array([len(one.labels) for one in rounds])
    shares = np.array([len(one.labels) * often for one, often in drawn])
    each = rng.multinomial(BATCH, shares / shares.sum())
    where = [np.sort(rng.integers(size, size=n)) for size, n in zip(sizes, each, strict=True)]
    encoded = [one.seen[at] for one, at in zip(rounds, where, strict=True)]
    labels = [one.labels[at] for one, at in zip(rounds, where, strict=True)]
    return (
        torch.from_numpy(np.concatenate(encoded).astype(np.float32)),
        torch.from_numpy(np.concatenate(labels).astype(np.int64)),
    )
