"""Choose the stop word spotter's threshold of each other language, with what tunes.

    python -m training.spotter.language_thresholds [--weights FILE]

For each threshold it prints how many words of the language are heard by its own outputs, how many
that sound alike are taken for one, and how often an hour it stops for nothing in what people say.
The voices, sentences, noises and rooms are neither those of the training nor those of the test.
"""

import argparse
import sys
from collections.abc import Iterator
from pathlib import Path

from benchmarks.hearing.stop_words.ears import Ears, joined
from benchmarks.hearing.stop_words.language_sounds import said_in, tracks_of
from edgevox.models import locate
from edgevox.voice.stop_spotter.network import (
    ENCODER,
    StopEncoder,
    StopWeights,
    read_language_weights,
    read_weights,
)
from training.acoustics.clips import speak
from training.spotter.threshold import CONDITIONS, HALF, THRESHOLDS, heard_of, stops_in


def lines(encoder: StopEncoder, weights: StopWeights, language: str) -> Iterator[str]:
    """The table of one language."""
    ears, said = Ears(encoder, weights, None), said_in(language, HALF)
    speak(said.clips, lambda line: print(line, file=sys.stderr, flush=True))
    heard = [heard_of(ears, said.words, snr_db) for snr_db in CONDITIONS]
    alike, _ = stops_in(ears, joined(tracks_of(said.alike, HALF)))
    false, hours = stops_in(ears, joined(tracks_of(said.talk, HALF)))
    yield f"{language}: {len(said.words)} words, {len(said.alike)} alike, {hours:.2f} h without one"
    yield f"{'from':>5} {'quiet':>7} {'10 dB':>7} {'5 dB':>7} {'alike':>7} {'false an hour':>14}"
    for one in THRESHOLDS:
        shares = (some[one] / len(said.words) for some in heard)
        told = "".join(f"{100 * share:8.1f}" for share in (*shares, alike[one] / len(said.alike)))
        yield f"{one:5.2f}{told} {false[one] / hours:14.1f}"


def main() -> int:
    """Speak what is missing, then print the tables."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--weights", type=Path, metavar="FILE", help="other than the package's")
    asked = parser.parse_args()
    encoder = StopEncoder(locate(ENCODER), read_weights().added)
    for language, weights in read_language_weights(asked.weights).items():
        for line in lines(encoder, weights, language):
            print(line, flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
