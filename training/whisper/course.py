"""The course of a training: steps that become slower, and a file from which it goes on."""

import math
from pathlib import Path

import torch
from torch import nn

from training.whisper.program import write_whole

WARMING_STEPS, STEEPEST = 40, 1.0
DECAY, BETAS = 0.01, (0.9, 0.98)


class Course:
    """Lets parts of a module learn, each as fast as it is told, over so many steps.

    A step is fastest after the first few, and the last one is `slowest` of that. What `keep`
    writes to the file, the next `Course` with it goes on from.
    """

    def __init__(
        self,
        module: nn.Module,
        parts: dict[nn.Module, float],
        file: Path,
        steps: int,
        slowest: float = 0.0,
    ) -> None:
        self.steps, self.done = steps, 0
        self._module, self._file, self._slowest = module, file, slowest
        self._parameters = [one for part in parts for one in part.parameters()]
        groups = [{"params": [*part.parameters()], "lr": rate} for part, rate in parts.items()]
        self._optimiser = torch.optim.AdamW(groups, weight_decay=DECAY, betas=BETAS)
        self._rate = torch.optim.lr_scheduler.LambdaLR(self._optimiser, self._speed)
        if file.exists():
            self._go_on(torch.load(file))

    def step(self, loss: torch.Tensor) -> None:
        """Make this less."""
        self._optimiser.zero_grad()
        loss.backward()
        nn.utils.clip_grad_norm_(self._parameters, STEEPEST)
        self._optimiser.step()
        self._rate.step()
        self.done += 1

    def keep(self) -> None:
        """Write all that it needs to go on."""
        kept = {
            "module": self._module.state_dict(),
            "optimiser": self._optimiser.state_dict(),
            "rate": self._rate.state_dict(),
            "done": self.done,
        }
        write_whole(self._file, lambda out: torch.save(kept, out))

    def _go_on(self, kept: dict) -> None:
        self._module.load_state_dict(kept["module"])
        self._optimiser.load_state_dict(kept["optimiser"])
        self._rate.load_state_dict(kept["rate"])
        self.done = kept["done"]

    def _speed(self, step: int) -> float:
        """Of the fastest: more and more at first, then less and less."""
        falling = 0.5 * (1 + math.cos(math.pi * step / self.steps)) + self._slowest
        return min(1, (step + 1) / WARMING_STEPS) * falling
