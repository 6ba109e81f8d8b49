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
    torch.manual_seed(seed)
    rng, network, mean = np.random.default_rng(seed), Network(), 0.0
    optimiser = torch.optim.AdamW(network.parameters(), weight_decay=DECAY)
    rate = torch.optim.lr_scheduler.OneCycleLR(optimiser, FASTEST, steps, pct_start=WARMING)
    for step in range(1, steps + 1):
        encoded, labels = _batch(rounds, rng)
        loss = cross_entropy(network(encoded), labels, label_smoothing=SMOOTHED)
        optimiser.zero_grad()
        loss.backward()
        optimiser.step()
        rate.step()
        mean += loss.item() / _TOLD_EVERY
        if step % _TOLD_EVERY == 0:
            told(f"step {step} of {steps}, loss {mean:.3f}")
            mean = 0.0
    write_whole(file, lambda out: np.savez(out, **arrays_of(network.eval(), THRESHOLD)))


def _batch(rounds: Sequence[Looks], rng: np.random.Generator) -> tuple[torch.Tensor, torch.Tensor]:
    """Of all rounds, by how many looks they have."""
    sizes = np.array([len(one.labels) for one in rounds])
    odds = sizes * np.where(np.arange(len(rounds)), LATER_COUNT, 1)
    each = rng.multinomial(BATCH, odds / odds.sum())
    where = [np.sort(rng.integers(size, size=n)) for size, n in zip(sizes, each, strict=True)]
    encoded = [one.seen[at] for one, at in zip(rounds, where, strict=True)]
    labels = [one.labels[at] for one, at in zip(rounds, where, strict=True)]
    return (
        torch.from_numpy(np.concatenate(encoded).astype(np.float32)),
        torch.from_numpy(np.concatenate(labels).astype(np.int64)),
    )
