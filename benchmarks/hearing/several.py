"""Five robots in one hall hear the same person: which of them answers.

Each robot is a process with the real listener and ROS 2 node, on one machine. The hall is simulated
and changes with each round: robots at least 2 m apart, a held-out voice 0.5 to 1.2 m from one of
them and at least 1 m farther from the others, noise equal within 0.5 dB, sensitivity within 3 dB.
**Speech to text is a stand-in** that takes 0.3 to 0.8 s and finds the words: five at once need more
cores than this machine has. In some rounds the nearest robot is killed within 0.4 s after its
claim. The last table is computed for many halls, without processes.
"""

import contextlib
import itertools
import json
import math
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from waiting import Heard as Told

from benchmarks import ROOT
from benchmarks.core.figures import Figure, Measured, NotHere
from benchmarks.core.talker import isolate
from benchmarks.hearing.several_robot import Round
from edgevox.core.commands import Heard
from edgevox.core.hearers import Hearers
from edgevox.models import ModelMissing
from edgevox.voice.audio import FULL_SCALE, RATE_HZ, Samples
from edgevox.voice.noise_floor import speech_db
from training.acoustics import Half
from training.acoustics.rooms import Room, in_room
from training.acoustics.voices import native_voices, say

PROGRAM = (sys.executable, "-m", "benchmarks.hearing.several_robot")
NAMES = ("Rosie", "Marvin", "Bender", "Eve", "Sonny")
SAYS = (
    "Go to the kitchen.",
    "What is your battery level?",
    "Drive to the bedroom, please.",
    "Turn left.",
    "Where are you?",
)
SIZES_M = ((7.0, 12.0), (6.0, 10.0), (2.5, 3.5))
RT60_S = (0.3, 0.6)
APART_M, NEAR_M, NEARER_M = 2.0, (0.5, 1.2), 1.0
"""Between two robots; from the person to the nearest; by which all others are farther away."""
HEIGHT_M, MOUTH_M = 0.8, 1.5
SPEECH_DB, NOISE_DB = -30.0, -58.0
"""Of full scale: the person 1 m from the middle microphone without a hall, and the noise."""
GAINS_DB, NOISES_DB = 3.0, 0.5
"""By which microphones are more or less sensitive, and their noise louder or softer."""
UNEVEN_DB, HALLS = (0.5, 1.5, 3.0), 200
"""By how much the noise differs in the halls that are only computed."""
BEFORE_S, AFTER_S = 0.6, 1.5
WORDS_S = (0.3, 0.8)
DIES_S = 0.4
HUNG_S = 60.0
START_S = 0.3
TABLE = "Five robots hear one person"
TIMES = "Time from the known words to the decision"
UNEVEN = "Halls in which the nearest robot hears best"


Place = tuple[float, float, float]


@dataclass
class Decided:
    """What came of one round, by robot."""

    nearest: str
    named: str = ""
    answers: dict[str, dict[str, Any]] = field(default_factory=dict)
    died_s: float = 0.0
    """When the nearest was killed; 0 if it was not."""
    heard: bool = False
    """Whether any robot noticed a voice."""

    def take(self, name: str, told: dict[str, Any]) -> None:
        """Take what a robot tells."""
        self.heard |= "claimed" in told
        self.died_s = told.get("dies_s", self.died_s)
        if "answers" in told:
            self.answers.setdefault(name, told)

    @property
    def answering(self) -> list[str]:
        """The robots that answered; one may have died since."""
        return [name for name, one in self.answers.items() if one["answers"] == "I"]

    @property
    def best(self) -> str:
        """The robot that says that it heard the person best."""
        levels = {name: one["level_db"] or 0.0 for name, one in self.answers.items()}
        return max(levels, key=lambda name: levels[name], default="")

    @property
    def wait_s(self) -> float:
        """Seconds that the group, and the death of the nearest, added to the answer."""
        one = self.answers[self.answering[0]]
        died_s = self.died_s if self.answering != [self.nearest] else 0.0
        return max(0.0, one["decided_s"] - max(one["words_s"], died_s))

    @property
    def agreed_s(self) -> float:
        """Seconds until the last robot knew, since it and the one that answers knew the words."""
        first_s = self.answers[self.answering[0]]["words_s"]
        return max(one["decided_s"] - max(one["words_s"], first_s) for one in self.answers.values())


class Scenes:
    """What the robots' microphones hear of a person, in one hall after the other."""

    def __init__(self, seed: int, noises_db: float = NOISES_DB) -> None:
        self.rng = np.random.default_rng(seed)
        uneven = self.rng.uniform(-1, 1, (2, len(NAMES)))
        self._gains_db = dict(zip(NAMES, GAINS_DB * uneven[0], strict=True))
        self._noises_db = dict(zip(NAMES, noises_db * uneven[1], strict=True))

    def sounds(self, speech: Samples) -> tuple[str, Mapping[str, Samples]]:
        """The nearest robot, and what each of them hears."""
        rng = self.rng
        size = tuple(float(rng.uniform(*side)) for side in SIZES_M)
        person, places = self._places(size)
        rt60_s, seed = float(rng.uniform(*RT60_S)), int(rng.integers(1 << 30))
        before, dry = round(BEFORE_S * RATE_HZ), speech.astype(np.float64)
        length = before + speech.size + round(AFTER_S * RATE_HZ)
        dry *= 10 ** (SPEECH_DB / 20) / np.sqrt(np.mean(dry**2))
        critical_m = 0.057 * np.sqrt(np.prod(size) / rt60_s)
        sounds = {}
        for name, place in places.items():
            room = Room(size, rt60_s, person, place, seed)
            strength = np.sqrt(1 / room.distance_m**2 + 1 / critical_m**2)
            heard = in_room(dry, room.response())[: length - before]
            sound = rng.normal(0, 10 ** ((NOISE_DB + self._noises_db[name]) / 20), length)
            sound[before : before + heard.size] += strength * heard
            sound *= FULL_SCALE * 10 ** (self._gains_db[name] / 20)
            sounds[name] = np.clip(sound, -FULL_SCALE, FULL_SCALE - 1).astype(np.int16)
        return next(iter(places)), sounds

    def _places(self, size: Sequence[float]) -> tuple[Place, Mapping[str, Place]]:
        """A person, and the robots, the nearest first."""
        rng = self.rng
        while True:
            at = [
                (float(rng.uniform(0.5, size[0] - 0.5)), float(rng.uniform(0.5, size[1] - 0.5)))
                for _ in NAMES
            ]
            apart_m = min(math.dist(a, b) for a, b in itertools.combinations(at, 2))
            angle, near_m = rng.uniform(0, 2 * np.pi), rng.uniform(*NEAR_M)
            x = float(at[0][0] + near_m * np.cos(angle))
            y = float(at[0][1] + near_m * np.sin(angle))
            far_m = [math.dist((x, y), one) for one in at]
            inside = 0.3 < x < size[0] - 0.3 and 0.3 < y < size[1] - 0.3
            if inside and apart_m > APART_M and far_m[0] + NEARER_M < min(far_m[1:]):
                names = rng.permutation(NAMES).tolist()
                return (x, y, MOUTH_M), {
                    name: (*one, HEIGHT_M) for name, one in zip(names, at, strict=True)
                }


class Robot:
    """A robot's process."""

    def __init__(self, name: str) -> None:
        self.process = subprocess.Popen(
            [*PROGRAM, name], cwd=ROOT, text=True, stdin=subprocess.PIPE, stdout=subprocess.PIPE
        )
        self.told = Told[dict[str, Any]]()
        self._reader = threading.Thread(target=self._read, name=name)
        self._reader.start()

    def begin(self, one: Round) -> None:
        """Have it hear a round."""
        assert self.process.stdin
        self.process.stdin.write(json.dumps(asdict(one)) + "\n")
        self.process.stdin.flush()

    def hears_out(self, number: int) -> None:
        """Wait until it has heard the round, and decided what it claimed, or until it dies."""
        over, claimed = {"number": number, "over": True}, {"number": number, "claimed": True}
        with contextlib.suppress(AssertionError):
            self.told.wait_for(lambda one: one == over, HUNG_S)
            if claimed in self.told.messages:
                self.told.wait_for(
                    lambda one: one.get("number") == number and "answers" in one, HUNG_S
                )

    def end(self) -> None:
        """Let it leave, unless it is dead."""
        assert self.process.stdin
        with contextlib.suppress(BrokenPipeError):
            self.process.stdin.close()
        self.process.wait(HUNG_S)
        self._reader.join()

    def _read(self) -> None:
        for line in self.process.stdout or ():
            self.told.add(json.loads(line))
        self.told.over()


class Hall:
    """The robots, and the rounds that they hear."""

    def __init__(self, folder: Path) -> None:
        self._folder, self._scenes = folder, Scenes(seed=7)
        self._numbers = itertools.count(1)
        self.robots = {name: Robot(name) for name in NAMES}
        self._meet()

    def close(self) -> None:
        """End all robots."""
        for one in self.robots.values():
            one.end()

    def round(self, voice: str, text: str, *, call: bool = False, dies: bool = False) -> Decided:
        """One utterance, which all robots may hear."""
        rng = self._scenes.rng
        nearest, sounds = self._scenes.sounds(say(voice, text))
        named = str(rng.choice([one for one in NAMES if one != nearest])) if call else ""
        number, start_s = next(self._numbers), time.monotonic() + START_S
        for name, sound in sounds.items():
            file = self._folder / f"{name}.npy"
            np.save(file, sound)
            dies_s = float(rng.uniform(0.0, DIES_S)) if dies and name == nearest else None
            words = f"{named}, {text}" if named else text
            words_s = float(rng.uniform(*WORDS_S))
            self.robots[name].begin(Round(number, str(file), start_s, words, words_s, dies_s))
        found = Decided(nearest, named)
        for name, robot in self.robots.items():
            robot.hears_out(number)
            for one in robot.told.messages:
                if one.get("number") == number:
                    found.take(name, one)
        if found.died_s:
            self.robots[nearest].end()
            self.robots[nearest] = Robot(nearest)
            self._meet()
        return found

    def _meet(self) -> None:
        for name, one in self.robots.items():
            others = {"here": sorted(set(NAMES) - {name})}
            one.told.wait_for(lambda told: told == others, HUNG_S)  # noqa: B023


def measure(quick: bool = False) -> Measured:
    """Rounds of each kind, one after the other, and halls that are only computed."""
    plain, named, killed = (6, 2, 2) if quick else (40, 12, 8)
    isolate()
    try:
        spoken = list(itertools.islice(_spoken(), plain + named + killed))
    except ModelMissing as error:
        raise NotHere(str(error)) from None
    with tempfile.TemporaryDirectory() as folder, contextlib.closing(Hall(Path(folder))) as hall:
        rounds = [hall.round(*one) for one in spoken[:plain]]
        called = [hall.round(*one, call=True) for one in spoken[plain : plain + named]]
        dead = [hall.round(*one, dies=True) for one in spoken[plain + named :]]
    unheard = sum(not one.heard for one in (*rounds, *called, *dead))
    what = "no robot notices a voice: not counted below"
    missed = Figure.share("unheard", TABLE, what, unheard, plain + named + killed)
    rounds, called, dead = ([one for one in these if one.heard] for these in (rounds, called, dead))
    shares = (missed, *_who(rounds, called), *_counts([*rounds, *called], dead))
    uneven = (_uneven(noise_db, HALLS // (10 if quick else 1)) for noise_db in UNEVEN_DB)
    return Measured(figures=(*shares, *_times(rounds, dead), *uneven))


def _spoken() -> Iterator[tuple[str, str]]:
    voices = native_voices(Half.HELD_OUT)
    for number in itertools.count():
        voice, text = voices[number % len(voices)], SAYS[number % len(SAYS)]
        say(voice, text)
        yield voice, text


def _who(rounds: Sequence[Decided], called: Sequence[Decided]) -> Iterator[Figure]:
    best = sum(one.answering == [one.best] for one in rounds)
    nearest = sum(one.answering == [one.nearest] for one in rounds)
    named = sum(one.answering == [one.named] for one in called)
    for name, what, hits, tries in (
        ("nearest", "the nearest answers", nearest, len(rounds)),
        ("best", "the one that hears best answers", best, len(rounds)),
        ("named", "the named one answers, which is not the nearest", named, len(called)),
    ):
        yield Figure.share(name, TABLE, what, hits, tries, wanted=95.0, more_is_better=True)


def _counts(rounds: Sequence[Decided], dead: Sequence[Decided]) -> Iterator[Figure]:
    for name, prefix, these in (("all", "", rounds), ("died", "the nearest is killed: ", dead)):
        two = sum(len(one.answering) > 1 for one in these)
        none = sum(not one.answering for one in these)
        for how, what, count in (("two", "two answer", two), ("none", "none answers", none)):
            yield Figure.share(
                f"{name}.{how}", TABLE, f"{prefix}{what}", count, len(these), wanted=0.0
            )


def _times(rounds: Sequence[Decided], dead: Sequence[Decided]) -> Iterator[Figure]:
    one = [found for found in rounds if len(found.answering) == 1]
    late = [found for found in dead if len(found.answering) == 1]
    for name, what, seconds in (
        ("wait", "until one answers", [found.wait_s for found in one]),
        ("agreed", "until all know which one answers", [found.agreed_s for found in one]),
        ("died", "the nearest is killed: until another one answers", [f.wait_s for f in late]),
        ("alone", "a robot without others", _alone()),
    ):
        for part, percent, wanted in (("median", 50, None), ("p95", 95, 300.0)):
            value_ms = 1000 * float(np.percentile(seconds, percent))
            yield Figure.of(
                f"{name}.{part}", TIMES, what, [value_ms], "ms", column=part, wanted=wanted
            )


def _alone(rounds: int = 1000) -> list[float]:
    """How long it takes a robot without others."""
    hearers, waited = Hearers("Rosie", "hall"), list[float]()
    for number in range(rounds):
        heard, asked_s = Heard("Go.", number + 0.5, began_s=float(number)), time.monotonic()
        hearers.settle(heard, lambda _: waited.append(time.monotonic() - asked_s))  # noqa: B023
    return waited


def _uneven(noises_db: float, halls: int) -> Figure:
    """How often the nearest is the one at which the voice stands out most."""
    scenes, hits, before = Scenes(11, noises_db), 0, round(BEFORE_S * RATE_HZ)
    for voice, text in itertools.islice(_spoken(), halls):
        nearest, sounds = scenes.sounds(say(voice, text))
        stands_out = {
            name: speech_db(sound[before : -round(AFTER_S * RATE_HZ)]) - speech_db(sound[:before])
            for name, sound in sounds.items()
        }
        hits += max(stands_out, key=lambda name: stands_out[name]) == nearest
    what = f"the noise differs by up to {2 * noises_db:g} dB"
    return Figure.share(f"uneven.{noises_db}", UNEVEN, what, hits, halls)
