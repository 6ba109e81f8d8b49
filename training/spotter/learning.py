"""Whisper's encoder and the networks on it learn together, from looks that are made meanwhile.

Of many looks those are learnt from that were heard wrongly, and a few of the others.
"""

from collections.abc import Callable, Iterator, Mapping
from pathlib import Path

import numpy as np
import torch
from torch import nn
from torch.nn.functional import cross_entropy

from edgevox.voice.stop_spotter.network import LANGUAGES_FILE, WEIGHTS_FILE, StopWeights
from training.spotter.examples import IGNORED
from training.spotter.installing import encoder_of
from training.spotter.languages import Outputs
from training.spotter.looks import Block
from training.spotter.network import INNER, INNER_OF_LANGUAGES, Network, layers_of, load
from training.whisper.bands import Bands
from training.whisper.course import Course
from training.whisper.encoder import Encoder
from training.whisper.program import write_whole
from training.whisper.surroundings import Place, Surroundings

RANK = 32
PLACE = Place(room_share=0.65, quiet_share=0.2, snr_db=(-1, 25))
LEARNT_SHARE = 0.25
"""Of the looks that are heard at each step so many are learnt from: mostly those that were heard
wrongly.
"""
EVEN = 0.03
"""How likely a look that was heard rightly is to be learnt from, beside one with a loss of 1."""
FASTEST_ADDED, FASTEST_NETWORKS, SMOOTHED = 1.5e-3, 1e-3, 0.002
THRESHOLD = 0.9
"""Of what was trained; which one is right is chosen afterwards."""
_TOLD_EVERY, _KEPT_EVERY = 20, 200

Start = tuple[StopWeights, Mapping[str, StopWeights]]
"""English, and the other languages by their codes."""


class Spotter(nn.Module):
    """The encoder with what is added to it, and the networks on it: bands to scores of all outputs
    (looks, outputs).
    """

    def __init__(self, folder: Path, outputs: Outputs, start: Start | None) -> None:
        super().__init__()
        self.english = Network(INNER, outputs.of_english)
        self.others = Network(INNER_OF_LANGUAGES, len(outputs) - outputs.of_english)
        self.encoder = Encoder(folder, RANK, start[0].added if start else {})
        if start:
            load(self.english, [start[0]])
            load(self.others, list(dict(sorted(start[1].items())).values()))

    def forward(self, bands: torch.Tensor) -> torch.Tensor:
        encoded = self.encoder(bands)
        return torch.cat([self.english(encoded), self.others(encoded)], 1).float()


class Learning:
    """A training that goes on from its file, `learning.pt` in this folder, and hears so many looks
    at each step.
    """

    def __init__(
        self,
        model: Path,
        outputs: Outputs,
        folder: Path,
        steps: int,
        *,
        looks: int,
        noises: torch.Tensor,
        device: str = "cpu",
        start: Start | None = None,
    ) -> None:
        torch.manual_seed(7)
        self._outputs, self._folder, self._device = outputs, folder, device
        self._surroundings = Surroundings(PLACE, noises.to(device))
        self._looks = looks
        self._spotter = Spotter(model, outputs, start).to(device)
        self._bands = Bands(device)
        codes = list(dict.fromkeys(outputs.languages))
        of = torch.tensor([codes.index(code) for code in outputs.languages])
        self._others = (of[:, None] != of[None, :]).to(device)
        networks = nn.ModuleList([self._spotter.english, self._spotter.others])
        speeds = {self._spotter.encoder: FASTEST_ADDED, networks: FASTEST_NETWORKS}
        self.course = Course(self._spotter, speeds, folder / "learning.pt", steps)

    def learn(self, blocks: Iterator[Block], told: Callable[[str], None]) -> None:
        """Until all steps are done; what runs is written to the folder now and then."""
        torch.manual_seed(self.course.done)
        rng, course, means = np.random.default_rng((23, self.course.done)), self.course, np.zeros(2)
        while course.done < course.steps:
            bands, own, english = self._pool(blocks)
            heard = self._losses(bands, own, english)
            at = self._to_learn(heard, rng)
            self._spotter.train()
            with torch.autocast(self._device, torch.bfloat16):
                scores = self._spotter(self._masked(bands[at]))
            loss = self._loss(scores, own[at], english[at], SMOOTHED).mean()
            course.step(loss)
            means += np.array([heard.mean().item(), loss.item()]) / _TOLD_EVERY
            if course.done % _TOLD_EVERY == 0:
                of = f"step {course.done} of {course.steps}"
                told(f"{of}, loss {means[0]:.4f}, learnt {means[1]:.3f}")
                means[:] = 0
            if course.done % _KEPT_EVERY == 0 or course.done == course.steps:
                self.keep()

    def keep(self) -> None:
        """Write how far it is, and what runs."""
        self.course.keep()
        arrays = layers_of(self._spotter.english) | {
            "words": np.array(self._outputs.words[: self._outputs.of_english]),
            "threshold": np.float64(THRESHOLD),
        }
        added = {name: one.astype(np.float16) for name, one in self._spotter.encoder.added()}
        write_whole(self._folder / WEIGHTS_FILE, lambda out: np.savez(out, **arrays, **added))
        first = self._outputs.of_english
        languages = layers_of(self._spotter.others) | {
            "words": np.array(self._outputs.words[first:]),
            "languages": np.array(self._outputs.languages[first:]),
            "thresholds": np.full(len(self._outputs) - first, THRESHOLD),
            "encoder": np.array(encoder_of(added)),
        }
        write_whole(self._folder / LANGUAGES_FILE, lambda out: np.savez(out, **languages))

    def _pool(self, blocks: Iterator[Block]) -> tuple[torch.Tensor, torch.Tensor, torch.Tensor]:
        """Bands, and what is to be found in each look, of some blocks."""
        parts, many = [], 0
        while many < self._looks:
            block = Block(*(one.to(self._device, non_blocking=True) for one in next(blocks)))
            looks = block.looks(self._surroundings.heard(block.tracks))
            parts.append((self._bands.of_looks(looks), block.own, block.english))
            many += len(block.own)
        bands, own, english = (torch.cat(some) for some in zip(*parts, strict=True))
        return bands, own, english

    @torch.no_grad()
    def _losses(
        self, bands: torch.Tensor, own: torch.Tensor, english: torch.Tensor
    ) -> torch.Tensor:
        self._spotter.eval()
        with torch.autocast(self._device, torch.bfloat16):
            return self._loss(self._spotter(bands), own, english)

    def _loss(
        self, scores: torch.Tensor, own: torch.Tensor, english: torch.Tensor, smoothed: float = 0.0
    ) -> torch.Tensor:
        """Of each look, in its language and in English; outputs of other languages do not count."""
        return self._loss_of(scores, own, smoothed) + self._loss_of(scores, english, smoothed)

    def _loss_of(self, scores: torch.Tensor, labels: torch.Tensor, smoothed: float) -> torch.Tensor:
        others = self._others[labels.clamp(min=0)]
        known = scores.masked_fill(others, -torch.inf).log_softmax(1)
        plain = cross_entropy(known, labels, ignore_index=IGNORED, reduction="none")
        if not smoothed:
            return plain
        even = -known.masked_fill(others, 0).sum(1) / (~others).sum(1)
        return (1 - smoothed) * plain + smoothed * even * (labels != IGNORED)

    def _to_learn(self, heard: torch.Tensor, rng: np.random.Generator) -> torch.Tensor:
        """Which of these looks, by their losses."""
        losses = heard.cpu().numpy()
        odds = np.minimum(losses, 1.0).astype(np.float64) + EVEN
        many = int(self._looks * LEARNT_SHARE)
        at = rng.choice(len(losses), many, replace=False, p=odds / odds.sum())
        return torch.from_numpy(np.sort(at)).to(self._device)

    def _masked(self, bands: torch.Tensor) -> torch.Tensor:
        """Some without a few bands, some without a moment (SpecAugment, Park and others 2019)."""
        masked = self._places(bands, 1, 0.3, (2, 12)), self._places(bands, 2, 0.15, (2, 8))
        means = bands.mean((1, 2), keepdim=True)
        return torch.where(
            masked[0][:, :, None], means,
            torch.where(masked[1][:, None, :], bands.amin((1, 2), keepdim=True), bands),
        )  # fmt: skip

    def _places(
        self, bands: torch.Tensor, axis: int, share: float, wide: tuple[int, int]
    ) -> torch.Tensor:
        """Of a share of the looks, some places one after the other along an axis."""
        looks, places, on = len(bands), bands.shape[axis], self._device
        widths = torch.randint(*wide, (looks,), device=on) * (torch.rand(looks, device=on) < share)
        first = (torch.rand(looks, device=on) * (places - widths)).long()
        place = torch.arange(places, device=on)
        return (place >= first[:, None]) & (place < (first + widths)[:, None])
