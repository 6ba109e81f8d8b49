"""Words that people say: the test files of Speech Commands (P. Warden, CC BY 4.0).

`EDGEVOX_SPEECH_COMMANDS` names their folder: a folder of recordings for each word, of 1 s, by 156
people who say "stop" and as many others; the first part of a file's name is the speaker. Some are
cut off, hold nothing or are loud with noise, as microphones in browsers are.
"""

import hashlib
import os
import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from edgevox.voice.audio import Samples
from edgevox.voice.wav import stream_wav
from training.acoustics import Half

FOLDER = "EDGEVOX_SPEECH_COMMANDS"
STOP = "stop"
SILENCE = "_silence_"
UNKNOWN = "_unknown_"
"""The folder of many words, each of which begins its file's name."""
_NAME = re.compile(r"(?:([a-z]+)_)?([0-9a-f]{8})_nohash_\d+")


@dataclass(frozen=True, slots=True)
class Recording:
    """A word by one of its speakers."""

    word: str
    speaker: str
    file: Path

    @property
    def samples(self) -> Samples:
        """Its sound."""
        return np.concatenate([*stream_wav(self.file)])

    @property
    def part(self) -> Half:
        """Whether this speaker trains, tunes or tests."""
        return part_of(self.speaker)


def recordings() -> Iterator[Recording]:
    """All words of all speakers; none where there is no folder."""
    place = os.environ.get(FOLDER, "")
    for file in sorted(Path(place).glob("*/*.wav")) if place else ():
        found = _NAME.match(file.name)
        if found and file.parent.name != SILENCE:
            word = found[1] if file.parent.name == UNKNOWN else file.parent.name
            yield Recording(word or "", found[2], file)


def half_of(speaker: str) -> Half:
    """On which side of the split a speaker is."""
    return Half.TUNING if _digest(speaker)[0] % 2 else Half.HELD_OUT


def part_of(speaker: str) -> Half:
    """The part of a speaker. Of speakers who are not held out, two of three train."""
    half = half_of(speaker)
    return Half.TRAIN if half is Half.TUNING and _digest(speaker)[1] % 3 else half


def _digest(speaker: str) -> bytes:
    return hashlib.sha256(speaker.encode()).digest()
