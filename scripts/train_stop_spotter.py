"""Train the stop word spotter: `edgevox/voice/stop_spotter.npz`.

Needs PyTorch, which nothing else here does: `pip install torch` into an environment of its own that
sees this one's packages. Speaks with espeak-ng, Piper and Kokoro, which takes an hour the first
time, and keeps what was said; see `benchmarks/acoustics`. Of voices, noises and rooms it uses the
half to train with, and nothing of the one held out. `benchmarks/stop_words.py` tells how well it
hears then.

    python scripts/train_stop_spotter.py [--minutes 30] [--only-spoken] [FILE]
"""

import argparse
import sys
import time
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import torch

ROOT = Path(__file__).parents[1]
sys.path[:0] = [str(ROOT / "benchmarks"), str(ROOT / "scripts")]

from stop_spotter import texts
from stop_spotter.clips import Clip, all_clips
from stop_spotter.examples import Examples, Sound
from stop_spotter.network import Network, arrays_of, loss_of

from edgevox.voice.stop_network import WEIGHTS_FILE

FILE = ROOT / "edgevox" / "voice" / WEIGHTS_FILE
THRESHOLD = 0.6
BATCH, FRESH, FIRST = 96, 16, 800
"""Examples a step, how many of them are new, and how many there are at first."""
EASY = 0.1
"""Beside its cost: so likely is an example that was learnt to be seen again."""
FASTEST = 3e-3
WEIGHTS = {"kokoro": 6.0, "piper": 3.0, "espeak": 1.0}
"""How often a clip of an engine is drawn beside the others': there are few natural voices."""


def sounds_of(clips: Sequence[Clip]) -> list[Sound]:
    """The clips, spoken."""
    return [
        Sound(
            clip.samples,
            1 + texts.WORDS.index(clip.word) if clip.word else 0,
            clip.within,
            WEIGHTS[clip.voice.split(":", maxsplit=1)[0]],
        )
        for clip in clips
    ]


def train(sounds: Sequence[Sound], minutes: float, seed: int, save: Path, network: Network) -> None:
    """Learn for so long from examples made on the way, and write the file now and then."""
    torch.manual_seed(seed)
    makes, rng = Examples(list(sounds), seed), np.random.default_rng(seed)
    kept = [makes.make() for _ in range(FIRST)]
    costs = np.ones(FIRST)
    averaged = torch.optim.swa_utils.AveragedModel(
        network, multi_avg_fn=torch.optim.swa_utils.get_ema_multi_avg_fn(0.99), use_buffers=True
    )
    optimiser = torch.optim.AdamW(network.parameters(), lr=FASTEST, weight_decay=0.01)
    began, step, mean = time.monotonic(), 0, 0.0
    while (done := (time.monotonic() - began) / 60 / minutes) < 1:
        for group in optimiser.param_groups:
            group["lr"] = (
                FASTEST * min(1, (step + 1) / 50) * max(0.01, np.cos(done * np.pi / 2) ** 2)
            )
        fresh = [makes.make() for _ in range(FRESH)]
        kept += fresh
        costs = np.append(costs, np.full(FRESH, costs.max()))
        where = np.append(
            rng.choice(len(kept) - FRESH, BATCH - FRESH, p=_odds(costs[:-FRESH])),
            np.arange(len(kept) - FRESH, len(kept)),
        )
        chosen = [kept[i] for i in where]
        network.train()
        rows = torch.from_numpy(np.stack([one[0] for one in chosen]).astype(np.float32))
        labels = torch.from_numpy(np.stack([one[1] for one in chosen]).astype(np.int64))
        word = torch.tensor([one[2] for one in chosen])
        each = loss_of(network(rows), labels, word)
        costs[where] = each.detach().numpy()
        loss = each.mean()
        optimiser.zero_grad()
        loss.backward()
        torch.nn.utils.clip_grad_norm_(network.parameters(), 2.0)
        optimiser.step()
        averaged.update_parameters(network)
        mean = 0.97 * mean + 0.03 * loss.item() if step else loss.item()
        step += 1
        if step % 50 == 0:
            print(f"{done:.2f} step {step} examples {len(kept)} loss {mean:.3f}", flush=True)
            write(averaged.module, save)
    write(averaged.module, save)


def _odds(costs: np.ndarray) -> np.ndarray:
    """How likely every example is to be seen again: those more so that cost more."""
    worth = EASY + np.minimum(costs, 3.0)
    return worth / worth.sum()


def write(network: Network, place: Path, threshold: float = THRESHOLD) -> None:
    """The file that `edgevox/voice/stop_network.py` reads."""
    with place.open("wb") as file:
        np.savez(file, **arrays_of(network, threshold))
    torch.save(network.state_dict(), place.with_suffix(".pt"))


def main() -> int:
    """Speak what is not there yet, train and write the file."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("file", nargs="?", type=Path, default=FILE)
    parser.add_argument("--minutes", type=float, default=30.0, help="how long to train")
    parser.add_argument("--only-spoken", action="store_true", help="only what was spoken before")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--go-on-from", type=Path, metavar="FILE.pt")
    asked = parser.parse_args()
    torch.set_num_threads(1)
    clips = [clip for clip in all_clips() if clip.is_here or not asked.only_spoken]
    print(f"{len(clips)} clips", flush=True)
    network = Network()
    if asked.go_on_from:
        network.load_state_dict(torch.load(asked.go_on_from))
    train(sounds_of(clips), asked.minutes, asked.seed, asked.file, network)
    print(f"{asked.file}: {asked.file.stat().st_size} bytes")
    return 0


if __name__ == "__main__":
    sys.exit(main())
