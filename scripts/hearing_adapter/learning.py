"""Learns to hear in noise what was said, and to make of it what Whisper makes of the clean sound.

20 s a hundred sounds on one core, in half precision.
"""

import math
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import torch
from torch import nn
from torch.nn.functional import cross_entropy, kl_div, log_softmax

from hearing_adapter.batches import AS_TAUGHT, UNWANTED, Batch
from hearing_adapter.network import Hearing

RANK_OF_ENCODER, RANK_OF_DECODER = 16, 8
FASTEST, WARMING_STEPS, DECAY, SMOOTHED, STEEPEST = 1e-3, 40, 0.01, 0.02, 1.0
TAUGHT_EVERY, TAUGHT_SHARE = 2, 0.5
"""At every second step half of what is learnt is how sure Whisper is of the clean sound."""
_SLOWEST = 0.01
_TOLD_EVERY, _KEPT_EVERY = 20, 50


class Learning:
    """A training that goes on where it was cut off, and writes what it learnt to `weights`."""

    def __init__(self, folder: Path, no_speech: int, file: Path, weights: Path, steps: int) -> None:
        torch.manual_seed(7)
        self._whisper = Hearing(folder, 0, 0)
        self._hearing = Hearing(folder, RANK_OF_ENCODER, RANK_OF_DECODER)
        self._no_speech = no_speech
        self._file, self._weights, self._steps = file, weights, steps
        self._parameters = [*self._hearing.parameters()]
        self._optimiser = torch.optim.AdamW(
            self._parameters, lr=FASTEST, weight_decay=DECAY, betas=(0.9, 0.98)
        )
        self._rate = torch.optim.lr_scheduler.LambdaLR(self._optimiser, self._speed)
        self.done = 0
        if file.exists():
            self._go_on(torch.load(file))

    def learn(self, batches: Iterator[Batch], told: Callable[[str], None]) -> None:
        """Until all steps are done."""
        means = np.zeros(2)
        while self.done < self._steps:
            loss, right = self._losses(next(batches))
            self._optimiser.zero_grad()
            loss.backward()
            nn.utils.clip_grad_norm_(self._parameters, STEEPEST)
            self._optimiser.step()
            self._rate.step()
            self.done += 1
            means += np.array([loss.item(), right]) / _TOLD_EVERY
            if self.done % _TOLD_EVERY == 0:
                told(
                    f"step {self.done} of {self._steps}, loss {means[0]:.3f}, right {means[1]:.3f}"
                )
                means[:] = 0
            if self.done % _KEPT_EVERY == 0 or self.done == self._steps:
                self._keep()

    def _losses(self, batch: Batch) -> tuple[torch.Tensor, float]:
        """What is to become less, and the share of tokens that were right."""
        wanted = batch.follow != UNWANTED
        follow = batch.follow[wanted]
        with torch.autocast("cpu", torch.bfloat16):
            scores = self._hearing(batch.heard, batch.tokens, wanted)
        text = follow >= 0
        loss = cross_entropy(scores[text], follow[text], label_smoothing=SMOOTHED)
        right = (scores[text].argmax(1) == follow[text]).float().mean().item()
        if self.done % TAUGHT_EVERY:
            return loss, right
        with torch.no_grad(), torch.autocast("cpu", torch.bfloat16):
            clean = self._whisper(batch.said, batch.tokens, wanted)
        known = (clean.argmax(1) == follow) & (follow != self._no_speech)
        taught = known | (follow == AS_TAUGHT)
        unlike = kl_div(
            log_softmax(scores[taught], 1), log_softmax(clean[taught], 1),
            log_target=True, reduction="batchmean",
        )  # fmt: skip
        return (1 - TAUGHT_SHARE) * loss + TAUGHT_SHARE * unlike, right

    def _speed(self, step: int) -> float:
        """Of the fastest: more and more at first, then less and less."""
        falling = 0.5 * (1 + math.cos(math.pi * step / self._steps)) + _SLOWEST
        return min(1, (step + 1) / WARMING_STEPS) * falling

    def _go_on(self, kept: dict) -> None:
        self._hearing.load_state_dict(kept["hearing"])
        self._optimiser.load_state_dict(kept["optimiser"])
        self._rate.load_state_dict(kept["rate"])
        self.done = kept["done"]

    def _keep(self) -> None:
        kept = {
            "hearing": self._hearing.state_dict(),
            "optimiser": self._optimiser.state_dict(),
            "rate": self._rate.state_dict(),
            "done": self.done,
        }
        for file, write in (
            (self._file, lambda out: torch.save(kept, out)),
            (self._weights, lambda out: np.savez(out, **self._hearing.added())),
        ):
            part = file.with_suffix(".new")
            with part.open("wb") as out:
                write(out)
            part.replace(file)
