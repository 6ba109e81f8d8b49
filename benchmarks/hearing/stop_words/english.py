"""The stop word spotter: what it misses, its false stops, and its delay.

Voices, sentences, noises and rooms are held out from its training and its threshold
(`training.acoustics`). A second of sound is before and after each word; hours of speech have no
stop word. The intervals are Wilson's, as if each word had its own voice. Nothing is measured unless
all clips are there: `python -m benchmarks.hearing.stop_words.english --speak` makes them in half an
hour.
"""

import argparse
import itertools
import multiprocessing
import re
import sys
from collections import Counter
from collections.abc import Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor

import numpy as np

from benchmarks.core.figures import Figure, Measured, NotHere
from benchmarks.hearing.heard_robot import Robot
from benchmarks.hearing.stop_words.ears import (
    SHARES,
    FalseStops,
    Trial,
    ears_of,
    false_stops,
    stretches,
    trials,
)
from benchmarks.hearing.stop_words.sounds import alike, clips, words
from edgevox.agent.nlu.hearing.near import NearStop
from edgevox.agent.stop.words import SafetyWords
from edgevox.apps.agent.models import open_phonemes
from edgevox.voice.audio import RATE_HZ, Samples
from edgevox.voice.stop_spotter.network import read_weights
from training.acoustics import Half
from training.acoustics.clips import Clip, of_engine, speak, standing_on
from training.acoustics.mixing import at_level

TABLE, FALSE = "Stop words heard", "False stops"
EITHER = "Stop words heard by their sound or, later, by their words"
CONDITIONS = {
    "quiet": (None, 99.5),
    "room, noise at 10 dB": (10.0, 98.0),
    "room, noise at 5 dB": (5.0, 95.0),
}
"""Signal to noise ratio, and how many of a hundred words should be heard."""
HOURS = 8.0
WANTED_FALSE = 2.0
"""At most, in 8 hours."""
HALF = Half.HELD_OUT
SPEAK = "python -m benchmarks.hearing.stop_words.english --speak"
QUICK = 41
"""A quick run takes one of so many clips, which are no multiple of the texts of a voice."""


def measure(quick: bool = False, only: str = "", every_note: bool = False) -> Measured:
    """All of it, or `only` what is "heard" or "false".

    What was missed and what was taken for a stop is counted in the notes, or told with
    `every_note`. Raises `NotHere` where a clip is missing.
    """
    need(clips(HALF))
    step = QUICK if quick else 1
    hours = {what: share * HOURS / step for what, share in SHARES.items()}
    like = alike(HALF)[::step] if only != "heard" else []
    with ProcessPoolExecutor(mp_context=multiprocessing.get_context("spawn")) as pool:
        without = [pool.submit(_taken_for_a_stop, what, hours[what]) for what in hours if like]
        names = CONDITIONS if only != "false" else ()
        heard = [pool.submit(_recall, name, step, every_note) for name in names]
        alarms = _alike(like)
        told = [one.result() for one in without]
        recalled = [one.result() for one in heard]
    figures = [one for some, _ in recalled for one in some]
    notes = {heading: lines for _, some in recalled for heading, lines in some.items()}
    if recalled:
        notes["Stop words"] = standing_on("stop words", words(HALF)[::step])
    if told:
        figures += _false(told, HOURS / step)
        figures.append(
            Figure.share(
                "false.alike", FALSE, "words that sound alike, taken for a stop", len(alarms),
                len(like), wanted=1.0,
            )
        )  # fmt: skip
        notes["Without a stop word"] = (
            *standing_on("sentences", [clip for one in told for clip in one.clips]),
            *standing_on("words that sound alike", like),
        )
    if told and every_note:
        notes["Taken for a stop"] = tuple(line for one in told for line in one.wrong)
        notes["Sounds alike"] = tuple(alarms)
    return Measured(figures=tuple(figures), notes=notes)


def need(whole: Sequence[Clip]) -> None:
    """Raise `NotHere` where one of these clips is missing."""
    missing = sum(not clip.is_here for clip in whole)
    if missing:
        raise NotHere(f"{missing} of {len(whole)} clips are not spoken yet: {SPEAK}")


def _recall(
    name: str, step: int, every_note: bool
) -> tuple[list[Figure], dict[str, tuple[str, ...]]]:
    """What it hears in a condition, by engine and by word, and in notes what it missed."""
    (snr_db, wanted), transcribed = CONDITIONS[name], _Words()
    found = list(trials(HALF, ears_of(read_weights()), words(HALF)[::step], snr_db))
    missed = [trial for trial in found if not trial.heard]
    late = sum(transcribed.stop(trial.sound) for trial in missed)
    either = Figure.share(
        f"either.{_identifier(name)}", EITHER, name, len(found) - len(missed) + late,
        len(found), wanted=wanted, more_is_better=True,
    )  # fmt: skip
    note = (
        tuple(f"{t.clip.voice}, {t.clip.text}, {t.noise}" for t in missed)
        if every_note
        else (_worst("voices", Counter(t.clip.voice for t in missed)),
              _worst("texts", Counter(t.clip.text for t in missed)))
    )  # fmt: skip
    return [*_heard(name, found, wanted), either], {f"Missed, {name}": note}


def _identifier(name: str) -> str:
    return re.sub(r"[^a-z0-9]+", "_", name.casefold())


def _worst(what: str, counted: Counter[str]) -> str:
    some = ", ".join(f"{name} {number}" for name, number in counted.most_common(6))
    return f"{what} missed most often: {some or 'none'}"


def _heard(name: str, found: Sequence[Trial], wanted: float) -> Iterator[Figure]:
    identifier = _identifier(name)
    rows = {"all": found}
    for engine in of_engine([trial.clip for trial in found]):
        rows[engine] = [trial for trial in found if trial.clip.engine == engine]
        for word in dict.fromkeys(trial.clip.word for trial in found):
            rows[f"{engine}, {word}"] = [t for t in rows[engine] if t.clip.word == word]
    for row, some in rows.items():
        if not some:
            continue
        slug = row.replace(", ", ".")
        yield Figure.share(
            f"heard.{identifier}.{slug}", TABLE, f"{name}: {row}", sum(t.heard for t in some),
            len(some), wanted=wanted, more_is_better=True,
        )  # fmt: skip
    delays = [1000 * t.delay_s for t in found if t.delay_s is not None and not t.clip.within]
    if delays:
        yield Figure.of(
            f"delay.{identifier}", TABLE, f"{name}: from the end of the word", delays, "ms",
            wanted=150.0,
        )  # fmt: skip
        worst = float(np.percentile(delays, 95))
        yield Figure.of(
            f"delay95.{identifier}", TABLE, f"{name}: the same, 95th percentile", [worst], "ms",
            wanted=150.0,
        )  # fmt: skip


class _Words:
    """What Whisper makes of a sound, utterance by utterance, and whether that stops a robot that
    drives: by a stop word, or by words that sound like one.
    """

    def __init__(self) -> None:
        self._robot = Robot("robot-apartment")
        self._safety = SafetyWords("en")
        phonemes = open_phonemes()
        self._near = NearStop("en", phonemes) if phonemes else None

    def stop(self, sound: Samples) -> bool:
        """Whether they do."""
        return any(self._is_stop(said.text) for said in self._robot.hear(sound))

    def _is_stop(self, text: str) -> bool:
        near = self._near.find(text) if self._near else None
        return (self._safety.find(text) or near) is not None


def _taken_for_a_stop(what: str, hours: float) -> FalseStops:
    """What it does in so many hours of it."""
    found = false_stops(ears_of(read_weights()), what, stretches(HALF, what, hours))
    _told(f"{what}: {len(found.wrong)} false stops in {found.hours:.2f} h")
    return found


def _false(told: Sequence[FalseStops], hours: float) -> Iterator[Figure]:
    """How often it stopped, by what was heard, and in all."""
    for what, found in zip(SHARES, told, strict=True):
        identifier = f"false.{what.replace(' ', '_')}"
        yield Figure.of(identifier, FALSE, f"{what}, {found.hours:.2f} h", [len(found.wrong)])
    wrong, total = sum(len(one.wrong) for one in told), sum(one.hours for one in told)
    wanted = WANTED_FALSE * hours / HOURS
    yield Figure.of("false.all", FALSE, f"all, {total:.2f} h", [wrong], wanted=wanted)


def _alike(said: Sequence[Clip]) -> list[str]:
    """Which of the words that sound like a stop word stopped."""
    wrong, ears = [], ears_of(read_weights())
    for clip in said:
        sound = at_level(np.append(clip.samples, np.zeros(RATE_HZ // 2)), -26.0)
        wrong += [f"{clip.voice} {clip.text}" for _ in itertools.islice(ears.stops(sound), 1)]
    return wrong


def _told(line: str) -> None:
    print(line, file=sys.stderr, flush=True)


def main() -> int:
    """Speak what is missing, then print what is found."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--quick", action="store_true")
    parser.add_argument("--only", choices=("heard", "false"), default="")
    parser.add_argument("--speak", action="store_true", help="only speak, for the threshold too")
    asked = parser.parse_args()
    speak([*clips(HALF), *(clips(Half.TUNING) if asked.speak else ())], _told)
    if asked.speak:
        return 0
    found = measure(asked.quick, asked.only, every_note=True)
    for one in found.figures:
        between = "" if one.low is None else f"{one.low:.1f} to {one.high:.1f}"
        print(f"{one.what:60} {one.value:8} {one.unit:3} {between:16} wanted {one.wanted}")
    for heading, lines in found.notes.items():
        print(f"{heading}: {len(lines)}")
        for line in lines[:40]:
            print("   ", line)
    return 0


if __name__ == "__main__":
    sys.exit(main())
