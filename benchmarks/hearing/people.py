"""Real people: orders to a coffee machine, a wake word, and words that are no stop words.

`EDGEVOX_PEOPLE` names a folder with `index.jsonl`: `orders/` has spoken orders with their slots and
speakers (Picovoice's Speech-to-Intent Benchmark), `words/` single words (its Wake Word Benchmark),
`noise/` a kitchen and a gym.

Half of the speakers are held out and reported; the others (`Half.TUNING`) choose thresholds and
weights. Noise is mixed as in the published figures: scaled by the loudest 128 ms of both. Sound
passes voice activity, the end of an utterance, the product's Whisper, and the interpreter for the
robot file `barista.yaml`. "right" is the whole order, unasked; a wrong motion is another order,
unasked. A transcript is right if it has each slot's words; beside it stands the same Whisper
without the product's adapter, to which no words are shown.
"""

import argparse
import json
import os
import re
import sys
import zlib
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from faster_whisper import decode_audio
from numpy.typing import NDArray

from benchmarks.core.figures import Figure, Measured, NotHere
from benchmarks.hearing.heard_robot import MODEL, Outcome, Robot
from benchmarks.hearing.speech_to_text import untouched
from benchmarks.hearing.wake_words import ENGINES, LABELS, is_heard, judged
from edgevox.agent.skills import Call, SkillSet
from edgevox.models import ModelMissing, locate
from edgevox.ros2.robot_file.skills import load_described
from edgevox.voice.audio import RATE_HZ, Samples
from edgevox.voice.stop_spotter.network import ENCODER
from edgevox.voice.stop_spotter.spotter import open_stop_spotter
from training.acoustics import Half
from training.acoustics.people import half_of

FOLDER = "EDGEVOX_PEOPLE"
BARISTA = Path(__file__).with_name("barista.yaml")
ORDERS = "People's orders, whole, speakers kept apart"
WORDS = "People's words: transcripts of whole orders"
WAKE, STOPS = "People who say the wake word", "People's words that are no stop words"
CONDITIONS = ("quiet", "24 dB", "12 dB", "6 dB")
"""Noise of a kitchen and a gym, by the loudest 128 ms of speech and of noise."""
LOUDEST = round(0.128 * RATE_HZ)
BEFORE_S, AFTER_S = 1.0, 1.2
NUMBERS = {"8": "eight", "12": "twelve", "16": "sixteen", "20": "twenty", "oz": "ounce"}
AMOUNTS = ("some", "a bit of", "a little bit of", "a lot of", "lots of")


@dataclass(frozen=True, slots=True)
class Order:
    """A recording of one order. `slots` has what was ordered, in the words of the data set."""

    file: Path
    speaker: str
    slots: Mapping[str, str]

    @property
    def wanted(self) -> Call:
        """The call of the robot file's skill."""
        names = {
            "coffeeDrink": "drink", "size": "size", "roast": "roast", "numberOfShots": "shots",
        }  # fmt: skip
        found = {names[key]: said for key, said in self.slots.items() if key in names}
        for key, name in (("milkAmount", "milk"), ("sugarAmount", "sugar")):
            if said := self.slots.get(key):
                much = next((one for one in AMOUNTS[::-1] if said.startswith(f"{one} ")), "")
                found[name] = said.removeprefix(much).strip()
                if much:
                    found[f"much_{name}"] = much
        return Call("order_coffee", found)


@dataclass
class Heard:
    """What became of each order in one condition, and whose transcripts were whole."""

    outcomes: list[Outcome] = field(default_factory=list)
    ours: list[bool] = field(default_factory=list)
    untouched: list[bool] = field(default_factory=list)
    lines: list[str] = field(default_factory=list)


def folder() -> Path:
    """The recordings. Raises `NotHere`."""
    place = os.environ.get(FOLDER, "")
    if not place or not (Path(place) / "index.jsonl").is_file():
        raise NotHere(f"{FOLDER} names no folder with an index.jsonl of people's recordings")
    return Path(place)


def orders(half: Half) -> list[Order]:
    """Every order by the speakers of this half. Raises `NotHere`."""
    rows = map(json.loads, (folder() / "index.jsonl").read_text("utf-8").splitlines())
    return [
        Order(folder() / row["file"], row["speaker"], row["slots"])
        for row in rows
        if "slots" in row and half_of(row["speaker"]) is half
    ]


def main(arguments: Sequence[str] | None = None) -> int:
    """Print the figures. A run of `benchmarks.core.run` keeps them."""
    parser = argparse.ArgumentParser(description="Measure hearing on real people's recordings.")
    parser.add_argument("--quick", action="store_true", help="only every twelfth recording")
    try:
        found = _measured(parser.parse_args(arguments).quick)
    except NotHere as reason:
        print(f"people: not measured: {reason}", file=sys.stderr)
        return 2
    for one in found.figures:
        print(f"{one.table}: {one.what}, {one.column}: {one.value} {one.unit} of {one.n} "
              f"({one.low} to {one.high})")  # fmt: skip
    for heading, lines in found.notes.items():
        print(f"\n{heading}, not as meant:", *lines, sep="\n")
    return 0


def measure(quick: bool = False) -> Measured:
    """All figures, to be kept: without a word that anybody said. Raises `NotHere`."""
    return Measured(figures=_measured(quick).figures)


def _measured(quick: bool) -> Measured:
    """All of it on the reported half. Raises `NotHere` without recordings or models."""
    every = orders(Half.HELD_OUT)[:: 12 if quick else 1]
    try:
        robot = Robot("barista", skills=barista())
        plain = untouched(locate(MODEL))
        heard = {name: _heard(every, robot, plain, name) for name in CONDITIONS}
        figures = [*_of_orders(heard), *_of_words(quick)]
    except ModelMissing as error:
        raise NotHere(str(error)) from error
    notes = {name: tuple(one.lines) for name, one in heard.items()}
    return Measured(figures=tuple(figures), notes=notes)


def barista() -> SkillSet:
    """The skills of the robot file."""
    return SkillSet([one.skill() for one in load_described(BARISTA).skills])


def in_noise(clip: Samples, condition: str, seed: str) -> Samples:
    """What the microphone hears: the clip with a second around it, and noise that begins before.

    `condition` is "quiet" or the distance to the noise, as in "12 dB".
    """
    padded = np.pad(clip.astype(np.float64), (int(BEFORE_S * RATE_HZ), int(AFTER_S * RATE_HZ)))
    snr_db = None if condition == "quiet" else float(condition.removesuffix(" dB"))
    rng = np.random.default_rng(zlib.crc32(f"{seed} {condition}".encode()))
    if snr_db is None:
        beside: NDArray[np.float64] = rng.normal(0.0, 3.0, padded.size)
    else:
        noises = sorted((folder() / "noise").iterdir())
        noise = recording(noises[rng.integers(len(noises))]).astype(np.float64)
        start = rng.integers(noise.size)
        beside = np.resize(np.roll(noise, -start), padded.size)
        beside *= np.sqrt(_loudest(clip) / _loudest(beside) / 10 ** (snr_db / 10))
    return np.clip(padded + beside, -32768, 32767).astype(np.int16)


@cache
def recording(file: Path) -> Samples:
    """A FLAC file as samples of 16 bit."""
    sound: NDArray[np.float32] = decode_audio(str(file), RATE_HZ)
    return np.clip(sound * 32768, -32768, 32767).astype(np.int16)


def is_whole(text: str, slots: Mapping[str, str]) -> bool:
    """Whether the words of each slot are in a transcript, side by side."""
    said = f" {_plain(text)} "
    return all(f" {_plain(one)} " in said for one in slots.values())


def _plain(text: str) -> str:
    words = re.sub(r"(\d)(oz)", r"\1 \2", text.lower().replace("-", " "))
    return " ".join(NUMBERS.get(one, one) for one in re.findall(r"[a-z']+|\d+", words))


def _loudest(sound: NDArray[Any]) -> float:
    """The mean power of its loudest 128 ms."""
    power = np.square(sound, dtype=np.float64)[: sound.size // LOUDEST * LOUDEST]
    return max(1e-9, float(power.reshape(-1, LOUDEST).mean(axis=1).max(initial=0.0)))


def _heard(
    every: Sequence[Order], robot: Robot, plain: Callable[[Samples], str], condition: str
) -> Heard:
    found = Heard()
    for one in every:
        sound = in_noise(recording(one.file), condition, one.file.name)
        said = robot.hear(sound)
        outcome = robot.does(said, one.wanted)
        text = " ".join(part.text for part in said)
        found.outcomes.append(outcome)
        found.ours.append(is_whole(text, one.slots))
        found.untouched.append(is_whole(plain(sound), one.slots))
        if outcome is not Outcome.RIGHT:
            found.lines.append(f"{one.file.stem}: {text!r}: {outcome.value}")
    return found


def _of_orders(heard: Mapping[str, Heard]) -> Iterator[Figure]:
    for condition, one in heard.items():
        tries = len(one.outcomes)
        at = condition.replace(" ", "").lower()
        for outcome in Outcome:
            wrong = outcome is Outcome.WRONG
            yield Figure.share(
                f"orders.{at}.{outcome.name.lower()}", ORDERS, condition,
                one.outcomes.count(outcome), tries, column=outcome.value,
                more_is_better=outcome is Outcome.RIGHT, wanted=1.0 if wrong else None,
            )  # fmt: skip
        yield Figure.share(
            f"words.{at}.untouched", WORDS, condition, sum(one.untouched), tries,
            column=f"{MODEL}, untouched", more_is_better=True,
        )  # fmt: skip
        yield Figure.share(
            f"words.{at}.ours", WORDS, condition, sum(one.ours), tries, column="as EdgeVox hears",
            more_is_better=True, baseline=f"words.{at}.untouched",
        )  # fmt: skip


def _of_words(quick: bool) -> Iterator[Figure]:
    """The wake word "alexa" by those who chose no threshold, and false alarms of all other words.

    No speaker is named: nearly every recording is another person's, and half of them are held out.
    """
    files = sorted((folder() / "words").iterdir())[:: 24 if quick else 1]
    called = [
        one for one in files if one.name.startswith("alexa") and half_of(one.name) is Half.HELD_OUT
    ]
    files = [one for one in files if one in called or not one.name.startswith("alexa")]
    detectors = {name: open_it("alexa") for name, open_it in ENGINES.items()}
    spotter = open_stop_spotter(locate(ENCODER))
    spotter.warm_up()
    alarms, stops = Counter[str](), 0
    hits = {condition: Counter[str]() for condition in ("quiet", "12 dB")}
    for file in files:
        for condition, hit in hits.items():
            if condition != "quiet" and file not in called:
                continue
            sound = judged(in_noise(recording(file), condition, file.name))
            wakes = Counter(n for n, one in detectors.items() if is_heard(one, sound))
            if file in called:
                hit.update(wakes)
            else:
                alarms.update(wakes)
            if condition == "quiet":
                spotter.forget()
                stops += any([spotter.heard(*one, "en") for one in sound])  # noqa: C419 - hear all
    for name, detector in detectors.items():
        for condition, hit in hits.items():
            yield Figure.share(
                f"wake.{name}.{condition.replace(' ', '')}".lower(), WAKE, LABELS[name], hit[name],
                len(called), column=f"heard, {condition}", more_is_better=True,
            )  # fmt: skip
        yield Figure.share(
            f"wake.{name}.others", WAKE, LABELS[name], alarms[name], len(files) - len(called),
            column="other words taken for it",
        )  # fmt: skip
        detector.close()
    yield Figure.share(
        "stops.false", STOPS, "taken for a stop word by the spotter", stops, len(files), wanted=0.0
    )


if __name__ == "__main__":
    sys.exit(main())
