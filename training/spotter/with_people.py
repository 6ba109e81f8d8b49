"""Let the English network of the spotter learn again, with people, into a folder of one's own.

    EDGEVOX_SPEECH_COMMANDS=... python -m training.spotter.with_people FOLDER

The encoder, and with it the other languages, stay as the package has them: what it makes of each
look is computed once, and two cores learn in 40 minutes. It begins with the package's weights.
Two rounds: first from all looks, then with as many more, of which mostly those that were heard
wrongly are kept. What synthetic voices say is learnt from where it was spoken before; `train.py`
speaks it. Needs PyTorch and the recordings that `training.acoustics.people` reads; `train.py`
installs what comes of it.
"""

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np
import torch
from torch.nn.functional import cross_entropy

from edgevox.models import locate
from edgevox.voice.stop_spotter.network import (
    ENCODER,
    WEIGHTS_FILE,
    StopEncoder,
    StopWeights,
    likelihoods,
    read_weights,
)
from training.acoustics import Half
from training.acoustics.languages import languages
from training.acoustics.noises import kinds
from training.acoustics.people import FOLDER
from training.spotter import clips
from training.spotter.languages import ENGLISH, Outputs, sounds_of, sounds_of_people
from training.spotter.learning import PLACE
from training.spotter.looks import Looks
from training.spotter.network import INNER, Network, layers_of, load
from training.spotter.train import NOISE_S, SEED, told
from training.spotter.train import PLACE as SHIPPED
from training.whisper.course import Course
from training.whisper.making import all_made_beside
from training.whisper.program import write_whole
from training.whisper.surroundings import Surroundings, noise_to_train

LOOKS, MORE_LOOKS = 90_000, 140_000
SHARES = (0.6, 0.2, 0.2)
"""Of the words: people say the first."""
NOISES_OF_A_KIND = 12
HEARD_WELL, KEPT_SHARE = 0.8, 0.08
"""The second round keeps looks with a likelihood below the first, and this share of the others."""
EPOCHS, BATCH, FASTEST, SMOOTHED = 5, 256, 5e-4, 0.01


class Pool(NamedTuple):
    """What the encoder made of looks, in half precision, and which word each is to find."""

    encoded: torch.Tensor
    wanted: torch.Tensor

    def with_more(self, other: "Pool") -> "Pool":
        """Both together."""
        return Pool(*(torch.cat(some) for some in zip(self, other, strict=True)))


class Maker:
    """Makes looks of people and synthetic voices, in rooms and noise, and encodes them."""

    def __init__(self) -> None:
        said = (*clips.all_clips(), *clips.clips_after_words(), *clips.alike_clips())
        here = [one for one in dict.fromkeys(said) if one.is_here]
        people = sounds_of_people()
        if not people:
            raise SystemExit(f"{FOLDER} names no folder with recordings of people")
        told(f"{len(here)} clips of synthetic voices, {len(people)} of people")
        self._sounds = {ENGLISH: [*sounds_of(ENGLISH, here), *people]}
        every = kinds(Half.TRAIN)
        noises = all_made_beside(
            lambda number: noise_to_train(every, NOISE_S, SEED, number),
            len(every) * NOISES_OF_A_KIND, 0,
        )  # fmt: skip
        self._surroundings = Surroundings(PLACE, noises)
        self._encoder = StopEncoder(locate(ENCODER), read_weights().added)

    def pool(self, many: int, seed: int, known: StopWeights | None = None) -> Pool:
        """Of so many looks, those that `known` does not hear well, and a few others; else all."""
        rng, blocks = np.random.default_rng(seed), iter(self._looks(seed))
        encoded, wanted, made = [], [], 0
        while made < many:
            block = next(blocks)
            looks = block.looks(self._surroundings.heard(block.tracks)).numpy()
            found = np.concatenate(
                [self._encoder.of(list(looks[at : at + 64])) for at in range(0, len(looks), 64)]
            )
            labels, made = block.english.numpy(), made + len(looks)
            keep = labels >= 0
            if known:
                right = likelihoods(known, found)[np.arange(len(labels)), np.maximum(labels, 0)]
                keep &= (right < HEARD_WELL) | (rng.random(len(labels)) < KEPT_SHARE)
            encoded.append(torch.from_numpy(found[keep].astype(np.float16)))
            wanted.append(torch.from_numpy(labels[keep]).long())
        told(f"{made} looks, {sum(map(len, wanted))} of them to learn from")
        return Pool(torch.cat(encoded), torch.cat(wanted))

    def _looks(self, seed: int) -> Looks:
        return Looks(self._sounds, Outputs(sorted(languages())), seed, SHARES)


def learnt(pool: Pool, start: StopWeights, folder: Path) -> Network:
    """The network that goes on from `start`."""
    network, many = Network(INNER, len(start.words)), len(pool.wanted)
    load(network, [start])
    steps = EPOCHS * (many // BATCH)
    course = Course(network, {network: FASTEST}, folder / "with_people.pt", steps)
    network.train()
    for epoch in range(EPOCHS):
        order, total = torch.randperm(many), 0.0
        for at in range(0, many - BATCH + 1, BATCH):
            some = order[at : at + BATCH]
            scores = network(pool.encoded[some].float())
            loss = cross_entropy(scores, pool.wanted[some], label_smoothing=SMOOTHED)
            course.step(loss)
            total += loss.item()
        told(f"epoch {epoch + 1} of {EPOCHS}, loss {total / (many // BATCH):.4f}")
    return network


def write(network: Network, folder: Path) -> StopWeights:
    """All arrays of the package's file, those of the English network as they are now."""
    with np.load(SHIPPED) as held:
        arrays = {**held, **layers_of(network)}
    file = folder / WEIGHTS_FILE
    write_whole(file, lambda out: np.savez(out, **arrays))
    return read_weights(file)


def main(arguments: Sequence[str] | None = None) -> int:
    """Learn into the folder."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("folder", type=Path, help="where the network goes")
    parser.add_argument("--looks", type=int, default=LOOKS, help="of the first round")
    parser.add_argument("--more", type=int, default=MORE_LOOKS, help="of the second")
    asked = parser.parse_args(arguments)
    asked.folder.mkdir(parents=True, exist_ok=True)
    torch.manual_seed(SEED)
    maker = Maker()
    pool = maker.pool(asked.looks, 1)
    first = write(learnt(pool, read_weights(), asked.folder), asked.folder)
    more = pool.with_more(maker.pool(asked.more, 3, first))
    write(learnt(more, first, asked.folder), asked.folder)
    return 0


if __name__ == "__main__":
    sys.exit(main())
