"""Choose the threshold of the stop word spotter, with what tunes: never with what was learnt.

    python benchmarks/stop_words_threshold.py [--weights FILE] [--hours 2]

For each threshold it prints how many words are heard, and how often an hour it stops for nothing.
The voices, sentences, noises and rooms are neither those of the training nor those of the test.
"""

import argparse
import sys
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from acoustics import Half
from acoustics.clips import Clip, speak, standing_on
from figures import wilson
from stop_words_ears import SHARES, Ears, ears_of, spots, stretches
from stop_words_sounds import clips, words

from edgevox.voice.stop_network import read_weights

HALF = Half.TUNING
THRESHOLDS = (0.5, 0.7, 0.8, 0.85, 0.9, 0.93, 0.95, 0.97, 0.98, 0.99)
CONDITIONS = (None, 10.0, 5.0)


@dataclass(frozen=True, slots=True)
class Row:
    """What a threshold does: how many of the words of each condition it hears, false stops."""

    threshold: float
    heard: tuple[int, ...]
    false: int


def rows(ears: Ears, said: Sequence[Clip], hours: float) -> tuple[list[Row], float]:
    """For each threshold, and the hours that were heard without a stop word."""
    heard = [_heard(ears, said, snr_db) for snr_db in CONDITIONS]
    false, heard_h = dict.fromkeys(THRESHOLDS, 0), 0.0
    for what, share in SHARES.items():
        for stretch in stretches(HALF, what, share * hours):
            heard_h += stretch.hours
            looks = ears.looks(stretch.sound)
            for one in THRESHOLDS:
                false[one] += len([*ears.judged(looks, one)])
    found = [Row(one, tuple(some[one] for some in heard), false[one]) for one in THRESHOLDS]
    return found, heard_h


def _heard(ears: Ears, said: Sequence[Clip], snr_db: float | None) -> dict[float, int]:
    """How many of the words each threshold hears."""
    found = dict.fromkeys(THRESHOLDS, 0)
    for spot in spots(HALF, said, snr_db):
        looks = ears.looks(spot.sound)
        for one in THRESHOLDS:
            found[one] += spot.heard(ears.judged(looks, one)) is not None
    return found


def lines(found: Sequence[Row], number: int, hours: float) -> Iterator[str]:
    """A table of them."""
    names = ("quiet" if one is None else f"{one:g} dB" for one in CONDITIONS)
    yield f"{'from':>5} {''.join(f'{name:>24}' for name in names)} {'false an hour':>15}"
    for row in found:
        shares = "".join(f"{_share(heard, number):>24}" for heard in row.heard)
        yield f"{row.threshold:5.2f} {shares} {row.false / hours:15.2f}"


def _share(hits: int, tries: int) -> str:
    low, high = (100 * end for end in wilson(hits, tries))
    return f"{100 * hits / tries:.1f} % ({low:.1f} to {high:.1f})"


def main() -> int:
    """Speak what is missing, then print the table."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--weights", type=Path, metavar="FILE", help="other than the package's")
    parser.add_argument("--hours", type=float, default=2.0, help="of sound without a stop word")
    asked = parser.parse_args()
    speak(clips(HALF), lambda line: print(line, file=sys.stderr, flush=True))
    said = words(HALF)
    found, hours = rows(ears_of(read_weights(asked.weights)), said, asked.hours)
    print(*standing_on("stop words", said), f"{hours:.2f} h without one", sep="\n")
    print(*lines(found, len(said), hours), sep="\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
