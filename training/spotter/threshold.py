"""Choose from where on the stop word spotter stops, with what tunes: never with what was learnt.

    python -m training.spotter.threshold [--weights FILE] [--alone] [--hours 2]

For some odds (`LEAST_ODDS` of `edgevox/voice/stop_spotter/spotter.py`) it prints how many words are
heard, and how often an hour it stops for nothing; with `--alone` for the thresholds of the network,
which decide where the second look fails. The voices, sentences, noises and rooms are neither those
of the training nor those of the test.
"""

import argparse
import sys
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from benchmarks.core.figures import wilson
from benchmarks.hearing.stop_words.ears import (
    SHARES,
    Ears,
    Listened,
    Stretch,
    ears_of,
    spots,
    stretches,
)
from benchmarks.hearing.stop_words.sounds import clips, words
from edgevox.voice.stop_spotter.network import read_weights
from training.acoustics import Half
from training.acoustics.clips import Clip, speak, standing_on

HALF = Half.TUNING
ODDS = (0.01, 0.02, 0.05, 0.1, 0.14, 0.2, 0.5, 1.0)
THRESHOLDS = (0.5, 0.6, 0.7, 0.8, 0.85, 0.9, 0.93, 0.95, 0.97, 0.98, 0.99)
CONDITIONS = (None, 10.0, 5.0)


@dataclass(frozen=True, slots=True)
class Row:
    """From where on it stops, and what that does: how many of the words of each condition it hears,
    false stops.
    """

    least: float
    heard: tuple[int, ...]
    false: int


def rows(ears: Ears, said: Sequence[Clip], hours: float) -> tuple[list[Row], float]:
    """For each of the odds or thresholds, and the hours that were heard without a stop word."""
    heard = [heard_of(ears, said, snr_db) for snr_db in CONDITIONS]
    stretch = (
        one for what, share in SHARES.items() for one in stretches(HALF, what, share * hours)
    )
    false, heard_h = stops_in(ears, stretch)
    return [Row(one, tuple(some[one] for some in heard), false[one]) for one in false], heard_h


def heard_of(ears: Ears, said: Sequence[Clip], snr_db: float | None) -> dict[float, int]:
    """How many of the words each of the odds or thresholds hears."""
    found = dict.fromkeys(_leasts(ears), 0)
    for spot in spots(HALF, said, snr_db):
        looks = ears.looks(spot.sound)
        for one in found:
            found[one] += spot.heard(_judged(ears, looks, one)) is not None
    return found


def stops_in(ears: Ears, heard: Iterable[Stretch]) -> tuple[dict[float, int], float]:
    """How often it stops in them by each of the odds or thresholds, and how many hours they are."""
    found, hours = dict.fromkeys(_leasts(ears), 0), 0.0
    for stretch in heard:
        hours += stretch.hours
        looks = ears.looks(stretch.sound)
        for one in found:
            found[one] += len([*_judged(ears, looks, one)])
    return found, hours


def _leasts(ears: Ears) -> Sequence[float]:
    return ODDS if ears.second else THRESHOLDS


def _judged(ears: Ears, looks: Listened, least: float) -> Iterator[float]:
    if ears.second:
        return ears.judged(looks, least_odds=least)
    return ears.judged(looks, threshold=least)


def lines(found: Sequence[Row], number: int, hours: float) -> Iterator[str]:
    """A table of them."""
    names = ("quiet" if one is None else f"{one:g} dB" for one in CONDITIONS)
    yield f"{'from':>5} {''.join(f'{name:>24}' for name in names)} {'false an hour':>15}"
    for row in found:
        shares = "".join(f"{_share(heard, number):>24}" for heard in row.heard)
        yield f"{row.least:5.2f} {shares} {row.false / hours:15.2f}"


def _share(hits: int, tries: int) -> str:
    low, high = (100 * end for end in wilson(hits, tries))
    return f"{100 * hits / tries:.1f} % ({low:.1f} to {high:.1f})"


def main() -> int:
    """Speak what is missing, then print the table."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--weights", type=Path, metavar="FILE", help="other than the package's")
    parser.add_argument("--alone", action="store_true", help="without the second look")
    parser.add_argument("--hours", type=float, default=2.0, help="of sound without a stop word")
    asked = parser.parse_args()
    speak(clips(HALF), lambda line: print(line, file=sys.stderr, flush=True))
    said, ears = words(HALF), ears_of(read_weights(asked.weights))
    if asked.alone:
        ears.second = None
    found, hours = rows(ears, said, asked.hours)
    print(*standing_on("stop words", said), f"{hours:.2f} h without one", sep="\n")
    print(*lines(found, len(said), hours), sep="\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
