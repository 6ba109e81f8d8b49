"""What is learnt from: looks at examples, as they are given on (seen), kept in a folder.

The first round looks a few times at each of many examples. Each later one looks at fewer examples,
all along, and keeps what the network of the round before got wrong, with a few of the rest.
"""

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from whisper_training.whole_file import write_whole

from edgevox.voice.audio import FRAME_SAMPLES, RATE_HZ, Samples
from edgevox.voice.stop_encoder import SAMPLES, Floats, StopEncoder, bands_of
from edgevox.voice.stop_network import StopWeights, likelihoods
from edgevox.voice.stop_spotter import LOOKS_EVERY
from stop_spotter.examples import IGNORED, Example

WRONG = 0.1
"""A look is kept whose likelihood is off by so much."""
OTHERS = 0.02
"""The share of all others that is kept, too."""
_STEP = 2 * LOOKS_EVERY * FRAME_SAMPLES

See = Callable[[Sequence[Samples]], Floats]
"""What is learnt from, of sounds: what the encoder makes of them, or only their bands."""


def bands(sounds: Sequence[Samples]) -> Floats:
    """For a training of which the encoder is a part: shape (looks, bands, rows)."""
    return np.stack([bands_of(sound) for sound in sounds])


@dataclass(frozen=True, slots=True)
class Looks:
    """Each as it was seen, and its label."""

    seen: NDArray[np.float16]
    labels: NDArray[np.int8]


def round_file(folder: Path, number: int, what: str = "round") -> Path:
    """Where the looks of a round are, once all are there; their labels are beside it."""
    return folder / f"{what}{number}.npy"


def read(folder: Path, number: int, what: str = "round") -> Looks:
    """The looks of a round; what was seen stays on the disk until it is wanted."""
    file = round_file(folder, number, what)
    return Looks(np.load(file, mmap_mode="r"), np.load(file.with_suffix(".labels.npy")))


Labelled = Iterator[tuple[NDArray[np.float16], int]]


def keep(folder: Path, number: int, labelled: Labelled, what: str = "round") -> None:
    """Write the looks of a round: all of them, or it is not there."""
    seen, labels = zip(*labelled, strict=True)
    file = round_file(folder, number, what)
    np.save(file.with_suffix(".labels.npy"), np.array(labels, np.int8))
    write_whole(file, lambda out: np.save(out, np.stack(seen)))


def some(examples: Iterable[Example], see: See, seed: int) -> Labelled:
    """A few looks at each example."""
    rng = np.random.default_rng(seed)
    for example in examples:
        labelled = [(when, example.label(when)) for when in example.times(rng)]
        judged = [(when, label) for when, label in labelled if label != IGNORED]
        if judged:
            seen = see([example.looked_at(when) for when, _ in judged])
            yield from zip(seen.astype(np.float16), (one for _, one in judged), strict=True)


def wrong(
    examples: Iterable[Example], see: See, encoder: StopEncoder, weights: StopWeights, seed: int
) -> Labelled:
    """What a network gets wrong in each example, and a few other looks."""
    rng = np.random.default_rng(seed)
    for example in examples:
        ends = range(SAMPLES + int(rng.integers(_STEP)), example.sound.size + 1, _STEP)
        labelled = [(end, example.label(end / RATE_HZ)) for end in ends]
        judged = [(end, label) for end, label in labelled if label != IGNORED]
        if not judged:
            continue
        sounds = [example.sound[end - SAMPLES : end] for end, _ in judged]
        found = likelihoods(weights, encoder.of(sounds))
        for (_, label), sound, likely in zip(judged, sounds, found, strict=True):
            drawn = rng.random() < OTHERS
            if drawn or 1 - likely[label] > WRONG:
                yield see([sound])[0].astype(np.float16), label
