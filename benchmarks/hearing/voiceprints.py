"""Real people told by their voice: how often a guest is taken for a known person.

Each speaker of `EDGEVOX_PEOPLE` (see `people`) with more than three orders is enrolled twenty times
with three of them, in quiet; all orders of other speakers are guests'. At the equal error, both
kinds of mistake are as frequent. The held-out half of the speakers is reported; the other half
(`--tuning`) chose the threshold. **A speaker encoder labelled the speakers of these recordings**,
so the figures flatter.
"""

import argparse
import sys
from collections.abc import Iterator, Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from benchmarks.core.figures import Figure, Measured, NotHere, printed
from benchmarks.hearing.people import in_noise, orders, recording
from edgevox.models import ModelMissing, locate
from edgevox.voice.voiceprint import ALIKE, ENCODER, SENTENCES, Floats, VoiceEncoder, mean_of
from training.acoustics import Half

TABLE = "People told by their voice"
CONDITIONS = ("quiet", "24 dB", "12 dB")
DRAWS = 20
Spoken = Mapping[str, Sequence[Floats]]
"""What the encoder makes of each speaker's orders."""


def main(arguments: Sequence[str] | None = None) -> int:
    """Print the figures."""
    parser = argparse.ArgumentParser(description="Tell real people by their voice.")
    parser.add_argument("--quick", action="store_true", help="only in quiet")
    parser.add_argument("--tuning", action="store_true", help="the speakers to choose with")
    asked = parser.parse_args(arguments)
    half = Half.TUNING if asked.tuning else Half.HELD_OUT
    return printed("voiceprints", lambda: measure(asked.quick, half))


def measure(quick: bool = False, half: Half = Half.HELD_OUT) -> Measured:
    """Every condition. Raises `NotHere` without recordings or weights."""
    every = orders(half)
    try:
        encoder = VoiceEncoder(locate(ENCODER))
    except ModelMissing as error:
        raise NotHere(str(error)) from error
    spoken = dict[str, Spoken]()
    for condition in CONDITIONS[: 1 if quick else None]:
        vectors = dict[str, list[Floats]]()
        for one in every:
            heard = encoder.of(in_noise(recording(one.file), condition, one.file.name))
            if heard is not None:
                vectors.setdefault(one.speaker, []).append(heard)
        spoken[condition] = vectors
    return Measured(figures=tuple(_figures(spoken)))


def equal_error(own: NDArray[np.float64], others: NDArray[np.float64]) -> float:
    """The share of errors at the threshold where both kinds are as frequent, 0 to 1."""
    at = np.unique(np.concatenate([own, others]))
    refused = np.searchsorted(np.sort(own), at) / own.size
    taken = 1 - np.searchsorted(np.sort(others), at) / others.size
    nearest = int(np.argmin(np.abs(refused - taken)))
    return float(refused[nearest] + taken[nearest]) / 2


def _figures(spoken: Mapping[str, Spoken]) -> Iterator[Figure]:
    for condition, heard in spoken.items():
        own, others = _likenesses(spoken["quiet"], heard)
        key = condition.replace(" ", "").lower()
        yield Figure.of(
            f"equal.{key}", TABLE, condition, [100 * equal_error(own, others)], "%",
            column=f"equal error, {len(heard)} speakers", wanted=5.0 if key == "quiet" else None,
        )  # fmt: skip
        for name, column, wrong in (
            ("refused", "a known voice taken for a guest's", own < ALIKE),
            ("taken", "a guest taken for a known voice", others >= ALIKE),
        ):
            yield Figure.share(
                f"{name}.{key}", TABLE, condition, int(wrong.sum()), wrong.size, column=column
            )


def _likenesses(quiet: Spoken, heard: Spoken) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """How like their own print what people say is, and how like it what others say is."""
    rng = np.random.default_rng(3)
    own, others = list[float](), list[float]()
    for speaker in sorted(heard):
        if len(quiet[speaker]) <= SENTENCES or len(quiet[speaker]) != len(heard[speaker]):
            continue
        guests = [one for other in sorted(heard) if other != speaker for one in heard[other]]
        for _ in range(DRAWS):
            enrolled = rng.choice(len(quiet[speaker]), SENTENCES, replace=False)
            voice = mean_of([quiet[speaker][number] for number in enrolled])
            rest = [one for n, one in enumerate(heard[speaker]) if n not in enrolled]
            own += [float(one @ voice) for one in rest]
            others += [float(one @ voice) for one in guests]
    return np.array(own), np.array(others)


if __name__ == "__main__":
    sys.exit(main())
