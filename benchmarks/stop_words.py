"""How well the stop word spotter hears: what it misses, what it takes for a stop, how soon.

Voices, noises and rooms are those held out from its training, see `acoustics`. A word is said with
a second of what is around before it and after it; speech without stop words goes on for hours.

    python benchmarks/stop_words.py [--quick] [--half train]
"""

import argparse
import itertools
import random
import re
import sys
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from acoustics import Half
from acoustics.mixing import at_level, mixed
from acoustics.noises import kinds, noise
from acoustics.rooms import in_room, rooms
from acoustics.voices import espeak_voices, is_cached, kokoro_voices, say
from figures import Figure, Measured
from numpy.typing import NDArray

from edgevox.voice.audio import FRAME_S, FRAME_SAMPLES, RATE_HZ, Samples
from edgevox.voice.stop_features import ROWS, features_of
from edgevox.voice.stop_network import STRIDE, StopNetwork, Weights, read_weights
from edgevox.voice.stop_spotter import StopJudge, StopSpotter

TABLE, FALSE = "Stop words heard", "False stops"
SAID = {
    "stop": ("Stop!", "Stop.", "Please stop."),
    "halt": ("Halt!",),
    "freeze": ("Freeze!",),
    "stop moving": ("Stop moving!",),
}
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
HOURS = {"speech": 5.0, "speech in noise": 1.5, "babble": 0.75, "noise": 0.75}
"""Of what is heard without a stop word: eight in all."""
WANTED_FALSE = 2.0
POOL = 2_400
"""Sentences of espeak-ng's voices: some three hours, heard again at other speeds and elsewhere."""
LEVELS_DB = (-38.0, -18.0)
LEAD_S, TAIL_S = 1.2, 0.9
PATIENCE_S = 0.5
_STOPPING = re.compile(r"stop|halt|fre[ea]z|friez|\bfrees\b", re.IGNORECASE)


class Ears:
    """Hears whole sounds at once, as a `StopSpotter` hears them frame by frame, but sooner done."""

    def __init__(self, weights: Weights) -> None:
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
    for voice, text in itertools.chain(*itertools.repeat(list(_texts(half)), rounds)):
        clip = _resampled(say(voice, text), rng.uniform(0.92, 1.08))
        kind = kinds(half)[rng.integers(len(kinds(half)))]
        lead, tail = int(LEAD_S * RATE_HZ), int(TAIL_S * RATE_HZ)
        track = np.concatenate([np.zeros(lead), clip, np.zeros(tail)])
        if snr_db is not None:
            track = in_room(track, responses[rng.integers(len(responses))])[: track.size]
            seed = int(rng.integers(40))
            around = _noise(kind, seed, half)
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


def _texts(half: Half) -> Iterator[tuple[str, str]]:
    for voice in kokoro_voices(half):
        for text in itertools.chain(*SAID.values()):
            if is_cached(voice, text):
                yield voice, text
    rng = random.Random(3)
    for voice in espeak_voices(half):
        for texts in SAID.values():
            yield voice, rng.choice(texts)


_known: dict[tuple[str, int, Half], NDArray[np.float32]] = {}


def _noise(kind: str, seed: int, half: Half) -> NDArray[np.float32]:
    """Eight seconds of it, made once."""
    key = (kind, seed % 6, half)
    if key not in _known:
        _known[key] = noise(kind, 8.0, 7_000 + seed % 6, half).astype(np.float32)
    return _known[key]


def _resampled(sound: Samples, step: float) -> NDArray[np.float64]:
    n = int(sound.size / step)
    return np.interp(np.arange(n) * step, np.arange(sound.size), sound.astype(np.float64))


def sentences(rng: random.Random) -> Iterator[str]:
    """English without stop words, from the documentation of this repository."""
    found: list[str] = []
    folder = Path(__file__).resolve().parents[1]
    for page in [folder / "README.md", *sorted((folder / "docs").glob("*.md"))]:
        for line in page.read_text("utf-8").splitlines():
            if line.startswith(("#", "|", "-", "`", " ", "<", ">", "!")):
                continue
            for one in re.split(r"(?<=[.!?:]) ", line):
                plain = re.sub(r"[`*_\[\]<>(){}|/\\#=]", " ", one)
                if 15 < len(plain) < 160 and not _STOPPING.search(plain):
                    found.append(plain)
    while True:
        yield rng.choice(found)


def pool(half: Half) -> list[tuple[str, str, int, int]]:
    """Who says what without a stop word, at which pitch and speed."""
    rng = random.Random(31)
    said, voices = sentences(rng), espeak_voices(half)
    return [
        (rng.choice(voices), next(said), rng.randint(20, 85), rng.randint(130, 220))
        for _ in range(POOL)
    ]


def tracks(half: Half, what: str, seconds: float) -> Iterator[tuple[str, Samples]]:
    """What is said without a stop word, and who says it, until it is enough."""
    rng, done = np.random.default_rng(31), 0.0
    responses = [room.response() for room in rooms(half, 20)]
    said = pool(half)
    told = [(voice, text, 50, 175) for voice, text in _told(half)]
    while done < seconds:
        if what in ("babble", "noise"):
            some = [kind for kind in kinds(half) if (kind == "babble") == (what == "babble")]
            note = some[rng.integers(len(some))]
            track = noise(note, 20.0, int(rng.integers(1_000, 900_000)), half)
        else:
            some = told if told and rng.random() < 0.3 else said
            voice, text, pitch, speed = some[rng.integers(len(some))]
            clip = say(voice, text, pitch=pitch, words_a_minute=speed)
            note, track = f"{voice} {text}", _resampled(clip, rng.uniform(0.9, 1.12))
            if rng.random() < 0.6:
                track = in_room(track, responses[rng.integers(len(responses))])
        if what == "speech in noise":
            kind = kinds(half)[rng.integers(len(kinds(half)))]
            track = mixed(track, _noise(kind, int(rng.integers(40)), half), rng.uniform(0, 15))
            note = f"{kind} {note}"
        pause = rng.normal(0, 1e-3 * np.abs(track).max() + 1, int(rng.uniform(0.1, 0.5) * RATE_HZ))
        sound = at_level(np.concatenate([track, pause]), rng.uniform(*LEVELS_DB))
        done += sound.size / RATE_HZ
        yield note, sound


def _told(half: Half) -> list[tuple[str, str]]:
    """What voices of Kokoro have said by now that holds no stop word."""
    sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "scripts"))
    from stop_spotter import texts

    some = (*texts.ALIKE, *texts.COMMANDS, *texts.OWN, *texts.CHAT)
    return [(v, t) for v in kokoro_voices(half) for t in some if is_cached(v, t)]


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


def measure(quick: bool = False, half: Half = Half.HELD_OUT) -> Measured:
    """All of it; the notes say what was missed and what was taken for a stop."""
    ears, figures, notes = Ears(read_weights()), [], {}
    for name, (snr_db, wanted) in CONDITIONS.items():
        found = list(trials(half, ears, snr_db, 1 if quick else 2))
        figures += _recall(name, found, wanted)
        notes[f"Missed, {name}"] = tuple(
            f"{t.voice}, {t.said}, {t.noise}" for t in found if not t.heard
        )
    total, wrong = 0.0, []
    for what, hours in HOURS.items():
        took, some = false_stops(ears, half, what, hours / (40 if quick else 1))
        identifier = f"false.{what.replace(' ', '_')}"
        figures.append(Figure.of(identifier, FALSE, f"{what}, {took:.2f} h", [len(some)]))
        total, wrong = total + took, wrong + some
    figures.append(
        Figure.of("false.all", FALSE, f"all, {total:.2f} h", [len(wrong)], wanted=WANTED_FALSE)
    )
    number, some = alike(ears, half)
    figures.append(Figure.of("false.alike", FALSE, f"{number} words that sound alike", [len(some)]))
    notes["Taken for a stop"], notes["Sounds alike"] = tuple(wrong), tuple(some)
    share = share_of_a_core(StopSpotter(ears.weights))
    figures.append(Figure.of("core", "What it takes", "share of a core", [share], "%", wanted=3.0))
    return Measured(figures=tuple(figures), notes=notes)


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
    asked = parser.parse_args()
    found = measure(asked.quick, asked.half)
    for one in found.figures:
        print(f"{one.what:60} {one.value:8} {one.unit:3} wanted {one.wanted}")
    for heading, lines in found.notes.items():
        print(f"{heading}: {len(lines)}")
        for line in lines[:40]:
            print("   ", line)
    return 0


if __name__ == "__main__":
    sys.exit(main())
