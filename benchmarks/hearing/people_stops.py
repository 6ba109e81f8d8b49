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

from support.recordings import InMemory

from benchmarks.core.figures import Figure, Measured, NotHere, printed
from benchmarks.hearing.people import half_of, in_noise, recording
from edgevox.agent.nlu.hearing.near import NearStop
from edgevox.agent.nlu.hearing.wordings import HearingPrompts
from edgevox.agent.skills import SkillSet
from edgevox.agent.stop.words import SafetyWords
from edgevox.apps.agent.models import open_phonemes
from edgevox.core.bus import Bus
from edgevox.core.commands import Command, Heard, StopSpotted
from edgevox.core.languages import LANGUAGES
from edgevox.models import ModelMissing, locate
from edgevox.voice.audio import Samples
from edgevox.voice.listener import Listener
from edgevox.voice.stop_spotter.network import ENCODER
from edgevox.voice.stop_spotter.spotter import open_stop_spotter
from edgevox.voice.stt.whisper import Whisper
from edgevox.voice.vad import open_vad
from training.acoustics import Half

FOLDER = "EDGEVOX_PEOPLE_ARABIC"
LANGUAGE = "ar"
CONDITIONS = ("quiet", "10 dB", "5 dB")
STOPS, OTHERS = ("stop", "cancel"), ("no", "yes", "move", "start")
TABLE = "People who say a stop word in Arabic"
EVERY = {**dict.fromkeys(STOPS, 5), **dict.fromkeys(OTHERS, 20)}
"""Each speaker has said each word ten times; of them one in so many is heard."""


class Driven:
    """A robot that drives and is spoken to in Arabic."""

    def __init__(self) -> None:
        self._safety, phonemes = SafetyWords(LANGUAGE), open_phonemes()
        if phonemes is None:
            raise NotHere("nothing here tells how words sound")
        self._near = NearStop(LANGUAGE, phonemes)
        self._whisper = Whisper(
            lambda code: locate(LANGUAGES[code].stt_model), prompt_of=HearingPrompts(SkillSet([]))
        )
        self._whisper.warm_up(LANGUAGE)
        self._spotter = open_stop_spotter(locate(ENCODER))
        self._spotter.warm_up()

    def stops_for(self, sound: Samples) -> bool:
        """Whether the drive is over after this sound."""
        told: list[Command] = []
        listener = Listener(
            InMemory(sound), open_vad(), self._whisper, submit=told.append, bus=Bus(),
            language=lambda: LANGUAGE, muted=lambda: False, audible=lambda: 0.0,
            is_stop=lambda text: self._safety.find(text) is not None, stop_detector=self._spotter,
            lossless=True,
        )  # fmt: skip
        listener.start()
        listener.wait_over()
        listener.close()
        return any(map(self._is_stop, told))

    def _is_stop(self, command: Command) -> bool:
        if isinstance(command, Heard):
            return bool(self._safety.find(command.text) or self._near.find(command.text))
        return isinstance(command, StopSpotted)


def recordings(word: str, half: Half) -> list[Path]:
    """Those of a word by the speakers of this half. Raises `NotHere`."""
    place = Path(os.environ.get(FOLDER, "")) / word
    if not os.environ.get(FOLDER) or not place.is_dir():
        raise NotHere(f"{FOLDER} names no folder with recordings of {word!r}")
    return [one for one in sorted(place.glob("*.wav")) if half_of(one.name.split("_")[0]) is half]


def measure(quick: bool = False) -> Measured:
    """Each word in each condition. Raises `NotHere`."""
    try:
        return Measured(figures=tuple(_figures(Driven(), 5 if quick else 1)))
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
                sum(map(robot.stops_for, sounds)), len(files), column=condition,
                more_is_better=wanted,
            )  # fmt: skip


if __name__ == "__main__":
    sys.exit(printed("people_stops", measure))
