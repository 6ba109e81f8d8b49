"""Learns to hear in noise what was said, and to make of it what Whisper makes of the clean sound.

20 s a hundred sounds on one core, in half precision.
"""

from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import torch
from torch.nn.functional import cross_entropy, kl_div, log_softmax
from whisper_training.course import Course
from whisper_training.whole_file import write_whole

from hearing_adapter.batches import AS_TAUGHT, UNWANTED, Batch
from hearing_adapter.network import Hearing

RANK_OF_ENCODER, RANK_OF_DECODER = 16, 8
FASTEST, SLOWEST, SMOOTHED = 1e-3, 0.01, 0.02
TAUGHT_EVERY, TAUGHT_SHARE = 2, 0.5
"""At every second step half of what is learnt is how sure Whisper is of the clean sound."""
_TOLD_EVERY, _KEPT_EVERY = 20, 50


class Learning:
    """A training that goes on where it was cut off, and writes what it learnt to `weights`."""

    def __init__(self, folder: Path, no_speech: int, file: Path, weights: Path, steps: int) -> None:
        torch.manual_seed(7)
        self._whisper = Hearing(folder, 0, 0)
        self._hearing = Hearing(folder, RANK_OF_ENCODER, RANK_OF_DECODER)
        self._no_speech = no_speech
        self._weights = weights
        self._course = Course(self._hearing, {self._hearing: FASTEST}, file, steps, SLOWEST)

    @property
    def done(self) -> int:
        """How many steps are."""
        return self._course.done

    def learn(self, batches: Iterator[Batch], told: Callable[[str], None]) -> None:
        """Until all steps are done."""
        means = np.zeros(2)
        steps = self._course.steps
        while self.done < steps:
            loss, right = self._losses(next(batches))
            self._course.step(loss)
            means += np.array([loss.item(), right]) / _TOLD_EVERY
            if self.done % _TOLD_EVERY == 0:
                told(f"step {self.done} of {steps}, loss {means[0]:.3f}, right {means[1]:.3f}")
                means[:] = 0
            if self.done % _KEPT_EVERY == 0 or self.done == steps:
                self._course.keep()
                write_whole(self._weights, lambda out: np.savez(out, **self._hearing.added()))

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
