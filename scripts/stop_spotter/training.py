"""Learns from examples made on the way, a step after the other, and can be cut off between two."""

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import torch

from stop_spotter.examples import Examples, Sound
from stop_spotter.network import Network, arrays_of, loss_of
from stop_spotter.pool import Pool
from stop_spotter.random_states import resume, state_of
from stop_spotter.schedule import rate

CHECKPOINT, TRAINED = "checkpoint.pt", "stop_spotter.npz"
THRESHOLD = 0.8
"""Of what was trained; which one is right is chosen afterwards."""
BATCH, FRESH, KEPT = 96, 24, 8_000
"""Examples a step, how many of them are new, and how many there are at most."""
SAVED_EVERY = 100


class Training:
    """The network that learns, and everything that the next step depends on."""

    def __init__(self, sounds: Sequence[Sound], steps: int, seed: int, kept: int = KEPT) -> None:
        torch.manual_seed(seed)
        self.steps, self.seed, self.step, self.mean = steps, seed, 0, 0.0
        self._makes = Examples(list(sounds), seed)
        self._rng = np.random.default_rng(seed)
        self._pool = Pool(kept)
        self._network = Network()
        self._averaged = torch.optim.swa_utils.AveragedModel(
            self._network,
            multi_avg_fn=torch.optim.swa_utils.get_ema_multi_avg_fn(0.99),
            use_buffers=True,
        )
        self._optimiser = torch.optim.AdamW(self._network.parameters(), weight_decay=0.01)

    def run(self, folder: Path, told: Callable[[str], None]) -> None:
        """Learn to the last step; a checkpoint and the network as it is go to the folder."""
        if not len(self._pool):
            self._pool.add([self._makes.make() for _ in range(BATCH)])
        while self.step < self.steps:
            self._learn()
            if self.step % SAVED_EVERY == 0 or self.step == self.steps:
                told(f"step {self.step} of {self.steps}, loss {self.mean:.3f}")
                self.save(folder)

    def save(self, folder: Path) -> None:
        """Both files, each whole or not at all."""
        part = folder / f"{CHECKPOINT}.new"
        torch.save(self._state(), part)
        part.replace(folder / CHECKPOINT)
        part = folder / f"{TRAINED}.new"
        with part.open("wb") as file:
            np.savez(file, **arrays_of(self._averaged.module, THRESHOLD))
        part.replace(folder / TRAINED)

    def resume(self, folder: Path) -> None:
        """Go on where the checkpoint of the folder was made, as if never cut off."""
        state = torch.load(folder / CHECKPOINT, weights_only=True)
        if (state["steps"], state["seed"]) != (self.steps, self.seed):
            raise ValueError(
                f"{folder / CHECKPOINT} is of a training of {state['steps']} steps with seed "
                f"{state['seed']}: ask for the same, or for another folder"
            )
        self.step, self.mean = state["step"], state["mean"]
        self._network.load_state_dict(state["network"])
        self._averaged.load_state_dict(state["averaged"])
        self._optimiser.load_state_dict(state["optimiser"])
        self._pool.resume({name: one.numpy() for name, one in state["pool"].items()})
        resume(self._rng, state["draws"])
        self._makes.resume(state["makes"])
        torch.set_rng_state(state["torch"])

    def _state(self) -> dict[str, Any]:
        return {
            "steps": self.steps,
            "seed": self.seed,
            "step": self.step,
            "mean": self.mean,
            "network": self._network.state_dict(),
            "averaged": self._averaged.state_dict(),
            "optimiser": self._optimiser.state_dict(),
            "pool": {name: torch.from_numpy(one) for name, one in self._pool.state().items()},
            "draws": state_of(self._rng),
            "makes": self._makes.state(),
            "torch": torch.get_rng_state(),
        }

    def _learn(self) -> None:
        for group in self._optimiser.param_groups:
            group["lr"] = rate(self.step, self.steps)
        fresh = self._pool.add([self._makes.make() for _ in range(FRESH)])
        batch = self._pool.batch(fresh, BATCH, self._rng)
        self._network.train()
        scores = self._network(torch.from_numpy(batch.rows.astype(np.float32)))
        labels = torch.from_numpy(batch.labels.astype(np.int64))
        each = loss_of(scores, labels, torch.from_numpy(batch.words.astype(np.int64)))
        self._pool.costed(batch.where, each.detach().numpy())
        loss = each.mean()
        self._optimiser.zero_grad()
        loss.backward()
        torch.nn.utils.clip_grad_norm_(self._network.parameters(), 2.0)
        self._optimiser.step()
        self._averaged.update_parameters(self._network)
        self.mean = 0.97 * self.mean + 0.03 * loss.item() if self.step else loss.item()
        self.step += 1
