"""Real people who say "stop" in English to a robot that drives, and other words that stop it.

`EDGEVOX_SPEECH_COMMANDS` names a folder with the test files of Speech Commands (P. Warden, CC BY
4.0): a folder of recordings for each word, of 1 s, made in browsers; some are cut off, or hold
hardly a word. Half of the speakers are held out and reported; the spotter learnt from some of the
others. `EDGEVOX_PEOPLE` has the noise, mixed as in `people`. Sound passes the product's listener,
with the spotter and with Whisper.
"""

import sys
from collections import Counter
from collections.abc import Iterator

from corpus_robots import skills_of_robots
from support.recordings import InMemory

from benchmarks.core.figures import Figure, Measured, NotHere, printed
from benchmarks.hearing.people import in_noise
from edgevox.agent.nlu.hearing.near import NearStop
from edgevox.agent.nlu.hearing.wordings import HearingPrompts
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
from training.acoustics.people import FOLDER, STOP, Recording, recordings

CONDITIONS = ("quiet", "10 dB", "5 dB")
TABLE, OTHERS = 'People who say "stop"', "People who say another word"
SOUND, WORDS = "by its sound", "by its words"
WANTED = {"quiet": 97.0, "10 dB": 95.0, "5 dB": 90.0}
EVERY = 4
"""Of the other words one in so many is heard."""


class Driven:
    """A robot that drives and is spoken to in a language."""

    def __init__(self, language: str) -> None:
        self._language, self._safety, phonemes = language, SafetyWords(language), open_phonemes()
        if phonemes is None:
            raise NotHere("nothing here tells how words sound")
        self._near = NearStop(language, phonemes)
        self._whisper = Whisper(
            lambda code: locate(LANGUAGES[code].stt_model),
            prompt_of=HearingPrompts(skills_of_robots()["robot-apartment"]),
        )
        self._whisper.warm_up(language)
        self._spotter = open_stop_spotter(locate(ENCODER))
        self._spotter.warm_up()

    def stopped_by(self, sound: Samples) -> set[str]:
        """What ends the drive: `SOUND`, `WORDS`, both or nothing."""
        told: list[Command] = []
        listener = Listener(
            InMemory(sound), open_vad(), self._whisper, submit=told.append, bus=Bus(),
            language=lambda: self._language, muted=lambda: False, audible=lambda: 0.0,
            is_stop=lambda text: self._safety.find(text) is not None, stop_detector=self._spotter,
            lossless=True,
        )  # fmt: skip
        listener.start()
        listener.wait_over()
        listener.close()
        return {way for one in told for way in self._ways(one)}

    def _ways(self, command: Command) -> Iterator[str]:
        if isinstance(command, StopSpotted):
            yield SOUND
        elif isinstance(command, Heard) and (
            self._safety.find(command.text) or self._near.find(command.text)
        ):
            yield WORDS


def measure(quick: bool = False) -> Measured:
    """Each recording in each condition. Raises `NotHere`."""
    held_out = [one for one in recordings() if one.part is Half.HELD_OUT]
    if not held_out:
        raise NotHere(f"{FOLDER} names no folder with recordings of people")
    try:
        robot = Driven("en")
    except ModelMissing as error:
        raise NotHere(str(error)) from error
    step = 10 if quick else 1
    stops = [one for one in held_out if one.word == STOP][::step]
    others = [one for one in held_out if one.word != STOP][:: EVERY * step]
    return Measured(figures=tuple(_figures(robot, stops, others)))


def _figures(robot: Driven, stops: list[Recording], others: list[Recording]) -> Iterator[Figure]:
    for condition in CONDITIONS:
        at = condition.replace(" ", "").lower()
        found = _counted(robot, stops, condition)
        yield Figure.share(
            f"sound.{at}", TABLE, "stops at once, by its sound", found[SOUND], len(stops),
            column=condition, more_is_better=True, wanted=WANTED[condition],
        )  # fmt: skip
        yield Figure.share(
            f"either.{at}", TABLE, "stops by its sound or, later, by its words", found["either"],
            len(stops), column=condition, more_is_better=True, wanted=99.5,
        )  # fmt: skip
        found = _counted(robot, others, condition)
        for way in (SOUND, WORDS):
            yield Figure.share(
                f"others.{way.split()[-1]}.{at}", OTHERS, f"stops {way}", found[way], len(others),
                column=condition,
            )  # fmt: skip


def _counted(robot: Driven, some: list[Recording], condition: str) -> Counter[str]:
    found = Counter[str]()
    for one in some:
        sound = in_noise(one.samples, condition, f"{one.word} {one.file.name}")
        ways = robot.stopped_by(sound)
        found.update(ways)
        found["either"] += bool(ways)
    return found


if __name__ == "__main__":
    sys.exit(printed("people_stops", measure))
