"""Real people who say stop words in Arabic, and what else stops a robot that they talk to.

`EDGEVOX_PEOPLE_ARABIC` names a folder of the Arabic Speech Commands Dataset (A. Ghandoura, CC BY
4.0): a folder of recordings for each word, by 30 people; the first number of a file's name is the
speaker. Half of the speakers are held out and reported. Noise is that of `people`, mixed in the
same way. Sound passes the product's listener, with Whisper and the spotter of English stop words,
and ends a drive where the words are a stop word or sound like one.
"""

import os
import sys
from collections.abc import Iterator
from pathlib import Path

from benchmarks.core.figures import Figure, Measured, NotHere, printed
from benchmarks.hearing.people import in_noise, recording
from benchmarks.hearing.people_stops import CONDITIONS, Driven
from edgevox.models import ModelMissing
from training.acoustics import Half
from training.acoustics.people import half_of

FOLDER = "EDGEVOX_PEOPLE_ARABIC"
LANGUAGE = "ar"
STOPS, OTHERS = ("stop", "cancel"), ("no", "yes", "move", "start")
TABLE = "People who say a stop word in Arabic"
EVERY = {**dict.fromkeys(STOPS, 5), **dict.fromkeys(OTHERS, 20)}
"""Each speaker has said each word ten times; of them one in so many is heard."""


def recordings(word: str, half: Half) -> list[Path]:
    """Those of a word by the speakers of this half. Raises `NotHere`."""
    place = Path(os.environ.get(FOLDER, "")) / word
    if not os.environ.get(FOLDER) or not place.is_dir():
        raise NotHere(f"{FOLDER} names no folder with recordings of {word!r}")
    return [one for one in sorted(place.glob("*.wav")) if half_of(one.name.split("_")[0]) is half]


def measure(quick: bool = False) -> Measured:
    """Each word in each condition. Raises `NotHere`."""
    try:
        return Measured(figures=tuple(_figures(Driven(LANGUAGE), 5 if quick else 1)))
    except ModelMissing as error:
        raise NotHere(str(error)) from error


def _figures(robot: Driven, step: int) -> Iterator[Figure]:
    for word, every in EVERY.items():
        files = recordings(word, Half.HELD_OUT)[:: every * step]
        for condition in CONDITIONS:
            sounds = (in_noise(recording(one), condition, f"{word} {one.name}") for one in files)
            wanted = word in STOPS
            yield Figure.share(
                f"{word}.{condition.replace(' ', '').lower()}", TABLE,
                f'"{word}" ends a drive' if wanted else f'"{word}" ends a drive, wrongly',
                sum(bool(robot.stopped_by(one)) for one in sounds), len(files), column=condition,
                more_is_better=wanted,
            )  # fmt: skip


if __name__ == "__main__":
    sys.exit(printed("people_stops_arabic", measure))
