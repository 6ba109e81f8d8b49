"""Learns to hear in noise what was said, and to make of it what Whisper makes of the clean sound.

20 s a hundred sounds on one core, in half precision.
"""

from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from types import MappingProxyType

import numpy as np
import torch
from torch.nn.functional import cross_entropy, kl_div, log_softmax

from edgevox.voice.stt.adapter import ADAPTER_FILE, Added
from training.adapter.batches import AS_TAUGHT, UNWANTED, Batch, tokens_of
from training.adapter.network import Hearing
from training.whisper.bands import Bands
from training.whisper.course import Course
from training.whisper.program import write_whole
from training.whisper.surroundings import Place, Surroundings, as_samples

RANK_OF_ENCODER, RANK_OF_DECODER = 16, 8
FASTEST, SLOWEST, SMOOTHED = 1e-3, 0.01, 0.02
TAUGHT_EVERY, TAUGHT_SHARE = 2, 0.5
"""At every second step half of what is learnt is how sure Whisper is of the clean sound."""
PLACE = Place(room_share=0.8, quiet_share=0.12, snr_db=(1, 20))
CLEAN_DB, FLOOR_DB = -26.0, -80.0
"""How loud a clean sound is of full scale, and what any microphone rustles."""
_TOLD_EVERY, _KEPT_EVERY = 20, 50


class Learning:
    """A training that goes on from its file, `learning.pt` in this folder."""

    def __init__(
        self,
        model: Path,
        folder: Path,
        steps: int,
        *,
        noises: torch.Tensor,
        device: str = "cpu",
        start: Mapping[str, Added] = MappingProxyType({}),
    ) -> None:
        torch.manual_seed(7)
        self._device, self._bands = device, Bands(device)
        self._surroundings = Surroundings(PLACE, noises.to(device))
        self._whisper = Hearing(model, 0, 0).to(device)
        self._hearing = Hearing(model, RANK_OF_ENCODER, RANK_OF_DECODER, start).to(device)
        self._no_speech = tokens_of(str(model / "tokenizer.json")).no_speech
        self._weights = folder / ADAPTER_FILE
        file = folder / "learning.pt"
        self.course = Course(self._hearing, {self._hearing: FASTEST}, file, steps, SLOWEST)

    def learn(self, batches: Iterator[Batch], told: Callable[[str], None]) -> None:
        """Until all steps are done."""
        torch.manual_seed(self.course.done)
        means = np.zeros(2)
        while self.course.done < (steps := self.course.steps):
            loss, right = self._losses(next(batches))
            self.course.step(loss)
            means += np.array([loss.item(), right]) / _TOLD_EVERY
            if self.course.done % _TOLD_EVERY == 0:
                told(
                    f"step {self.course.done} of {steps}, loss {means[0]:.3f}, right {means[1]:.3f}"
                )
                means[:] = 0
            if self.course.done % _KEPT_EVERY == 0 or self.course.done == steps:
                self.keep()

    def keep(self) -> None:
        """Write how far it is, and what is added."""
        self.course.keep()
        write_whole(self._weights, lambda out: np.savez(out, **self._hearing.added()))

    def _losses(self, batch: Batch) -> tuple[torch.Tensor, float]:
        """What is to become less, and the share of tokens that were right."""
        tracks, sizes, tokens, follow = (
            one.to(self._device) for one in (batch.tracks, batch.sizes, batch.tokens, batch.follow)
        )
        there = torch.arange(tracks.shape[1], device=self._device) < sizes[:, None]
        heard = self._surroundings.heard(tracks) * there
        wanted = follow != UNWANTED
        follow = follow[wanted]
        with torch.autocast(self._device, torch.bfloat16):
            scores = self._hearing(self._bands.of_sounds(heard, sizes, batch.rows), tokens, wanted)
        text = follow >= 0
        loss = cross_entropy(scores[text], follow[text], label_smoothing=SMOOTHED)
        right = (scores[text].argmax(1) == follow[text]).float().mean().item()
        if self.course.done % TAUGHT_EVERY:
            return loss, right
        said = _clean(tracks) * there
        with torch.no_grad(), torch.autocast(self._device, torch.bfloat16):
            clean = self._whisper(self._bands.of_sounds(said, sizes, batch.rows), tokens, wanted)
        known = (clean.argmax(1) == follow) & (follow != self._no_speech)
        taught = known | (follow == AS_TAUGHT)
        unlike = kl_div(
            log_softmax(scores[taught], 1), log_softmax(clean[taught], 1),
            log_target=True, reduction="batchmean",
        )  # fmt: skip
        return (1 - TAUGHT_SHARE) * loss + TAUGHT_SHARE * unlike, right


def _clean(tracks: torch.Tensor) -> torch.Tensor:
    """As they are said, by a microphone beside the mouth: int16."""
    rustle = 10 ** (FLOOR_DB / 20) * torch.randn(tracks.shape, device=tracks.device)
    return as_samples(10 ** (CLEAN_DB / 20) * tracks.float() + rustle)
