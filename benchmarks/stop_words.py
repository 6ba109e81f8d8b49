"""How well the stop word spotter hears: what it misses, what it takes for a stop, how soon.

Voices, noises and rooms are those held out from its training, see `acoustics`. A word is said with
a second of what is around before it and after it; speech without stop words goes on for hours.

    python benchmarks/stop_words.py [--quick] [--half train] [--hours 8] [--only heard]
"""

import argparse
import itertools
import random
import re
import sys
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from acoustics import Half
from acoustics.mixing import at_level, mixed
from acoustics.noises import kinds
from acoustics.rooms import in_room, rooms
from acoustics.voices import espeak_voices, say
from figures import Figure, Measured
from stop_words_sounds import LEVELS_DB, at_speed, noise_of, texts_of, tracks

from edgevox.voice.audio import FRAME_S, FRAME_SAMPLES, RATE_HZ, Samples
from edgevox.voice.stop_features import ROWS, features_of
from edgevox.voice.stop_network import STRIDE, StopNetwork, StopWeights, read_weights
from edgevox.voice.stop_spotter import StopJudge, StopSpotter

TABLE, FALSE = "Stop words heard", "False stops"
CONDITIONS = {
    "quiet": (None, 99.5),
    "room, noise at 10 dB": (10.0, 98.0),
    "room, noise at 5 dB": (5.0, 95.0),
}
"""Signal to noise ratio, and how many of a hundred words should be heard."""
ALIKE = (
    "shop", "top", "stuff", "step", "drop", "stock", "spot", "start", "salt", "hall", "fault",
    "hold", "halter", "freezer", "breeze", "please", "three", "fleas", "hop", "heart", "vault",
    "star",
)  # fmt: skip
"""Words that sound like a stop word; their sentences are "The <word> is here." and the like."""
SHARES = {"speech": 0.62, "speech in noise": 0.18, "babble": 0.1, "noise": 0.1}
"""Of what is heard without a stop word."""
WANTED_FALSE = 2.0
"""At most, in 8 hours."""
LEAD_S, TAIL_S = 1.2, 0.9
PATIENCE_S = 0.5


class Ears:
    """Hears whole sounds at once, as a `StopSpotter` hears them frame by frame, but sooner done."""

    def __init__(self, weights: StopWeights) -> None:
        self.weights = weights
        self.word = ""

    def stops(self, sound: Samples) -> Iterator[float]:
        """When it stops, in seconds of the sound; nothing is known of what was before."""
        judge = StopJudge(self.weights)
        steps = StopNetwork(self.weights).push(features_of(sound))
        for number in range(sound.size // FRAME_SAMPLES):
            if judge.said(steps[number * ROWS // STRIDE : (number + 1) * ROWS // STRIDE]):
                self.word = judge.word
                yield (number + 1) * FRAME_S


@dataclass(frozen=True, slots=True)
class Trial:
    """A word in sound: whether it was heard, and how long after its end."""

    engine: str
    voice: str
    said: str
    noise: str
    heard: bool
    delay_s: float


def trials(half: Half, ears: Ears, snr_db: float | None, rounds: int) -> Iterator[Trial]:
    """Every voice of this half says every text that it has said by now."""
    rng = np.random.default_rng(29)
    responses = [room.response() for room in rooms(half, 20)]
    for voice, text in itertools.chain(*itertools.repeat(list(texts_of(half)), rounds)):
        clip = at_speed(say(voice, text), rng.uniform(0.92, 1.08))
        kind = kinds(half)[rng.integers(len(kinds(half)))]
        lead, tail = int(LEAD_S * RATE_HZ), int(TAIL_S * RATE_HZ)
        track = np.concatenate([np.zeros(lead), clip, np.zeros(tail)])
        if snr_db is not None:
            track = in_room(track, responses[rng.integers(len(responses))])[: track.size]
            seed = int(rng.integers(40))
            around = noise_of(kind, seed, half)
            start = rng.integers(around.size - track.size)
            track = mixed(track, around[start : start + track.size], snr_db)
        else:
            track = track + rng.normal(0, 3, track.size)
        sound = at_level(track, rng.uniform(*LEVELS_DB))
        end_s = (lead + clip.size) / RATE_HZ
        begins = lead / RATE_HZ
        found = [t for t in ears.stops(sound) if begins + 0.1 <= t <= end_s + PATIENCE_S]
        engine = voice.split(":", maxsplit=1)[0]
        delay = found[0] - end_s if found else float("nan")
        yield Trial(engine, voice, text, kind, bool(found), delay)


def false_stops(ears: Ears, half: Half, what: str, hours: float) -> tuple[float, list[str]]:
    """Hours heard, and what it took for a stop."""
    heard_s, wrong = 0.0, []
    for some in _batches(tracks(half, what, 3600 * hours)):
        sound = np.concatenate([one for _, one in some])
        ends = np.cumsum([one.size for _, one in some]) / RATE_HZ
        heard_s += sound.size / RATE_HZ
        for when in ears.stops(sound):
            note = some[min(int(np.searchsorted(ends, when)), len(some) - 1)][0]
            wrong.append(f"{what}: {note} (took it for {ears.word})")
    return heard_s / 3600, wrong


def _batches(
    told: Iterator[tuple[str, Samples]], number: int = 30
) -> Iterator[list[tuple[str, Samples]]]:
    """Some after each other: what one ends with is there when the next one begins."""
    while some := list(itertools.islice(told, number)):
        yield some


def alike(ears: Ears, half: Half) -> tuple[int, list[str]]:
    """How many words that sound like a stop word were said, and which of them stopped."""
    rng, wrong, number = random.Random(37), [], 0
    for voice in espeak_voices(half)[::2]:
        for word in rng.sample(ALIKE, 8):
            number += 1
            text = rng.choice(("The {} is here.", "{}.", "Where is the {}?")).format(word)
            sound = at_level(np.append(say(voice, text), np.zeros(RATE_HZ // 2)), -26.0)
            wrong += [f"{voice} {text}" for _ in ears.stops(sound)]
    return number, wrong


def share_of_a_core(spotter: StopSpotter) -> float:
    """Of the time of a frame, what it takes to hear it."""
    sound = np.random.default_rng(1).normal(0, 500, 3_000 * FRAME_SAMPLES).astype(np.int16)
    began = time.process_time()
    for number in range(3_000):
        spotter.heard(sound[number * FRAME_SAMPLES : (number + 1) * FRAME_SAMPLES])
    return 100 * (time.process_time() - began) / (3_000 * FRAME_S)


def measure(
    quick: bool = False, half: Half = Half.HELD_OUT, hours: float = 8.0, only: str = ""
) -> Measured:
    """All of it, or `only` what is "heard" or "false".

    The notes say what was missed and what was taken for a stop.
    """
    ears, figures, notes = Ears(read_weights()), [], {}
    if only != "false":
        for name, (snr_db, wanted) in CONDITIONS.items():
            found = list(trials(half, ears, snr_db, 1 if quick else 2))
            figures += _recall(name, found, wanted)
            missed = (f"{t.voice}, {t.said}, {t.noise}" for t in found if not t.heard)
            notes[f"Missed, {name}"] = tuple(missed)
        share = share_of_a_core(StopSpotter(ears.weights))
        figures.append(
            Figure.of("core", "What it takes", "share of a core", [share], "%", wanted=3.0)
        )
    if only != "heard":
        some, wrong = _false(ears, half, hours / (40 if quick else 1))
        number, alarms = alike(ears, half)
        figures += some
        figures.append(
            Figure.of("false.alike", FALSE, f"{number} words that sound alike", [len(alarms)])
        )
        notes |= {"Taken for a stop": tuple(wrong), "Sounds alike": tuple(alarms)}
    return Measured(figures=tuple(figures), notes=notes)


def _false(ears: Ears, half: Half, hours: float) -> tuple[list[Figure], list[str]]:
    """How often it stops in so many hours, by what was heard, and at what."""
    figures, total, wrong = [], 0.0, []
    for what, share in SHARES.items():
        took, some = false_stops(ears, half, what, share * hours)
        identifier = f"false.{what.replace(' ', '_')}"
        figures.append(Figure.of(identifier, FALSE, f"{what}, {took:.2f} h", [len(some)]))
        total, wrong = total + took, wrong + some
    wanted = WANTED_FALSE * hours / 8
    figures.append(
        Figure.of("false.all", FALSE, f"all, {total:.2f} h", [len(wrong)], wanted=wanted)
    )
    return figures, wrong


def _recall(name: str, found: Sequence[Trial], wanted: float) -> Iterator[Figure]:
    identifier = re.sub(r"[^a-z0-9]+", "_", name.casefold())
    rows = {"all": found}
    for engine in dict.fromkeys(trial.engine for trial in found):
        rows[engine] = [trial for trial in found if trial.engine == engine]
    for row, some in rows.items():
        share = 100 * sum(trial.heard for trial in some) / len(some)
        yield Figure.of(
            f"heard.{identifier}.{row}", TABLE, f"{name}: {row}, {len(some)} words", [share], "%",
            column="heard", wanted=wanted if row == "all" else None, more_is_better=True,
        )  # fmt: skip
    delays = [1000 * t.delay_s for t in found if t.heard and t.said != "Stop moving!"]
    if delays:
        yield Figure.of(
            f"delay.{identifier}", TABLE, f"{name}: from the end of the word", delays, "ms",
            column="delay", wanted=150.0,
        )  # fmt: skip
        worst = float(np.percentile(delays, 95))
        yield Figure.of(
            f"delay95.{identifier}", TABLE, f"{name}: the same, 95th percentile", [worst], "ms",
            column="delay",
        )  # fmt: skip


def main() -> int:
    """Print what is found."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--quick", action="store_true")
    parser.add_argument("--half", type=Half, default=Half.HELD_OUT)
    parser.add_argument("--hours", type=float, default=8.0, help="of sound without a stop word")
    parser.add_argument("--only", choices=("heard", "false"), default="")
    asked = parser.parse_args()
    found = measure(asked.quick, asked.half, asked.hours, asked.only)
    for one in found.figures:
        print(f"{one.what:60} {one.value:8} {one.unit:3} wanted {one.wanted}")
    for heading, lines in found.notes.items():
        print(f"{heading}: {len(lines)}")
        for line in lines[:40]:
            print("   ", line)
    return 0


if __name__ == "__main__":
    sys.exit(main())
