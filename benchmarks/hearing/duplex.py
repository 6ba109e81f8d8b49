"""Hearing a person through the robot's own voice: the gate alone, and the echo canceller.

The robot speaks with Piper. Held-out English voices of Kokoro and espeak-ng speak over it, after
its first 5 s and after 20 s. Six simulated paths from loudspeaker to microphone (`echo_paths`) have
delays of 20 to 250 ms, clocks up to 100 ppm apart, distortion, and rooms. The robot speaks without
end, and in short answers between seconds of silence; the canceller learns again each minute. Time
is simulated: only the share of a core depends on the machine.
"""

import itertools
import time
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from listener_rig import frames, says_piper
from voice_engines import words, wrong_words

from benchmarks.core.figures import Figure, Measured, NotHere
from benchmarks.hearing.duplex_room import Room, listen_in
from benchmarks.hearing.echo_paths import PATHS, EchoPath, Sound, as_samples, at_level, noise_floor
from benchmarks.hearing.listening import NoWords
from edgevox.models import ModelMissing, locate
from edgevox.voice.audio import RATE_HZ, rms
from edgevox.voice.echo.canceller import open_echo
from edgevox.voice.echo.played import PlayedSound
from edgevox.voice.stop_spotter.detector import StopDetector
from edgevox.voice.stop_spotter.network import ENCODER
from edgevox.voice.stop_spotter.spotter import open_stop_spotter
from edgevox.voice.stt.speech_to_text import SpeechToText
from edgevox.voice.stt.whisper import Whisper
from edgevox.voice.wake.micro import MicroWakeWord
from training.acoustics import Half
from training.acoustics.voices import native_voices, say

TABLE = "Hearing through its own voice"
Way = Literal["gate", "cancel"]
WAYS: dict[Way, str] = {"gate": "the gate alone", "cancel": "echo cancelled, the gate behind it"}
PLAYED_LEVEL = 0.1
PERSON_DB = -5.0
"""So much louder than the loudspeaker is the person at the microphone."""
OWN_MINUTES = 30.0
OWN = {
    "interrupted": "its own voice taken for a person's",
    "answered": "its own words understood, which it would answer",
    "stopped": "its own stop word taken for a person's",
}
SAYS = (
    "I am going to the kitchen now, and I will tell you when I have arrived.",
    "My battery is at eighty five percent, which is enough for the next two hours.",
    "There is a chair in front of me, so I take another way around the table.",
    "I have put the cube into the left bin, and now I will come back to the door.",
    "The living room is the largest room, it lies between the kitchen and the hall.",
    "Somebody stands in my way, so I wait a moment and then I try it again.",
    "I can drive, turn, look around, fetch things and tell you where I am.",
)
ANSWERS = (
    "Stopped.",
    "Yes.",
    "I am in the kitchen.",
    "On my way to the office.",
    "I have arrived.",
    "Stopped. I am in the hall.",
    *SAYS[:4],
)
SILENT_S = (1.5, 8.0)
"""Between two answers."""
COMMANDS = (
    "Go to the kitchen.",
    "What is your battery level?",
    "Drive to the bedroom, please.",
    "Turn left.",
    "Stop right now.",
    "Where are you?",
)
SPOKE_S = {"person": (5.0, ""), "later": (20.0, ", once it has spoken for 20 s")}
"""How long it has spoken, since its start, when a person begins, and how that is told: the
canceller learns meanwhile."""
VOICES = (*native_voices(Half.HELD_OUT), "espeak:en-us+m3")
"""Of the people who speak over the robot."""


@dataclass(frozen=True, slots=True)
class Tally:
    """Of the people who spoke over the robot: how many it noticed, and understood word by word."""

    noticed: int
    understood: int
    of: int
    took_s: tuple[float, ...]


def measure(quick: bool = False) -> Measured:
    """Who is heard, whether it hears itself, and what that costs."""
    try:
        stt = Whisper(lambda _: locate("whisper-tiny.en"), threads=2)
        people = list(_people(VOICES[:1] if quick else VOICES))
    except ModelMissing as error:
        raise NotHere(str(error)) from error
    minutes = 1.0 if quick else OWN_MINUTES
    figures = []
    for way in WAYS:
        figures += _heard_itself(way, stt, minutes)
        for person, (spoke_s, told) in SPOKE_S.items():
            tally = _interrupted(way, stt, people, spoke_s)
            figures += _of_people(way, person, told, tally)
    figures += _cancelled()
    figures += _costs(60.0 if quick else 300.0)
    return Measured(figures=tuple(figures))


def own_voice(seconds: float, first: int = 0) -> Sound:
    """The robot, speaking with short pauses."""
    said: list[Sound] = []
    while sum(one.size for one in said) < seconds * RATE_HZ:
        text = SAYS[(first + len(said)) % len(SAYS)]
        spoken = at_level(says_piper(text) / 32768.0, PLAYED_LEVEL)
        said.append(np.concatenate([spoken, np.zeros(round(0.3 * RATE_HZ))]))
    return np.concatenate(said)


def own_answers(seconds: float, seed: int) -> Sound:
    """The robot, which says something short now and then."""
    rng = np.random.default_rng(seed)
    said: list[Sound] = []
    while sum(one.size for one in said) < seconds * RATE_HZ:
        spoken = says_piper(ANSWERS[rng.integers(len(ANSWERS))]) / 32768.0
        said.append(at_level(spoken, PLAYED_LEVEL))
        said.append(np.zeros(round(rng.uniform(*SILENT_S) * RATE_HZ)))
    return np.concatenate(said)


def heard_itself(
    way: Way, path: EchoPath, stt: SpeechToText, said: Sound, spotter: StopDetector | None = None
) -> Counter[str]:
    """How often it fell silent for itself, stopped itself and understood words of its own."""
    room = Room(said, path, np.zeros(0), 0.0, yields=False)
    happened = listen_in(room, way, stt, spotter)
    return Counter(
        interrupted=len(happened.held_s),
        answered=sum(bool(one.text.strip()) for one in happened.heard),
        stopped=len(happened.stopped_s),
    )


def _heard_itself(way: Way, stt: SpeechToText, minutes: float) -> Iterator[Figure]:
    each = max(1, round(minutes / len(PATHS)))
    at = f"in {each * len(PATHS)} min"
    found: Counter[str] = Counter()
    for path in PATHS:
        found += heard_itself(way, path, stt, own_voice(60.0 * each, path.seed))
    for name in ("interrupted", "answered"):
        yield _own(f"itself.{name}", f"{OWN[name]}, {at}", found[name], way)
    found.clear()
    for path, number in itertools.product(PATHS, range(each)):
        said = own_answers(60.0, 100 * number + path.seed)
        found += heard_itself(way, path, stt, said, open_stop_spotter(locate(ENCODER)))
    for name, what in OWN.items():
        yield _own(f"answers.{name}", f"{what}, {at} of short answers", found[name], way)


def _own(identifier: str, what: str, count: int, way: Way) -> Figure:
    return Figure.of(
        f"{identifier}.{way}", TABLE, what, [count], "times",
        column=WAYS[way], wanted=0 if way == "cancel" else None,
    )  # fmt: skip


def _interrupted(
    way: Way, stt: SpeechToText, people: list[tuple[str, Sound]], spoke_s: float
) -> Tally:
    noticed, understood, took_s = 0, 0, []
    for number, (said, spoken) in enumerate(people):
        path, at_s = way_of(number), begins_s(number, spoke_s)
        room = Room(own_voice(spoke_s + 3.0, number), path, person(spoken, path), at_s, yields=True)
        happened = listen_in(room, way, stt)
        after_s = [one - at_s for one in happened.held_s if one >= at_s]
        heard = " ".join(one.text for one in happened.heard)
        noticed += bool(after_s)
        took_s += after_s[:1]
        right = wrong_words(words(said), words(heard)) == 0
        understood += bool(after_s) and right
        print(f"  {way}: {path.name()}: {said!r} heard as {heard!r}", flush=True)
    return Tally(noticed, understood, len(people), tuple(took_s))


def _of_people(way: Way, person: str, told: str, tally: Tally) -> Iterator[Figure]:
    for name, what, count in (
        ("noticed", "who speaks over it is noticed", tally.noticed),
        ("understood", "and understood, word by word", tally.understood),
    ):
        yield Figure.share(
            f"{person}.{name}.{way}", TABLE, what + told, count, tally.of,
            column=WAYS[way], more_is_better=True, wanted=90.0 if way == "cancel" else None,
        )  # fmt: skip
    if tally.took_s:
        yield Figure.of(
            f"{person}.after.{way}", TABLE, f"noticed after{told}", tally.took_s, "s",
            column=WAYS[way],
        )  # fmt: skip


def _cancelled() -> Iterator[Figure]:
    """The ERLE of each way, after 5 s."""
    for path in PATHS:
        played = own_voice(30.0, path.seed)
        reference = PlayedSound()
        echo = open_echo("cancel", lambda: PLAYED_LEVEL, reference)
        heard, left = [], []
        for at, frame in enumerate(frames(as_samples(path.echo(played) + _floor(played, path)))):
            reference.add(as_samples(played[at * 512 : (at + 1) * 512]), RATE_HZ, at * 0.032)
            clean = echo.hear(frame).voice
            if at > 5 * RATE_HZ / 512:
                heard.append(rms(frame.samples) ** 2)
                left.append(rms(clean) ** 2)
        yield Figure.of(
            f"erle.{path.seed}", "Echo taken out", path.name(),
            [float(10 * np.log10(np.mean(heard) / np.mean(left)))], "dB",
            column="after 5 s", more_is_better=True,
        )  # fmt: skip


def _costs(seconds: float) -> Iterator[Figure]:
    """Share of a core while the robot speaks: of what hears through its voice, and of all that
    listens, without recognising what is said.
    """
    yield from _cost_of_echo(seconds)
    spotter = open_stop_spotter(locate(ENCODER))
    spotter.warm_up()
    wakeword = MicroWakeWord(locate("micro-wake-words") / "hey_jarvis.json")
    for way, called in WAYS.items():
        room = Room(own_voice(seconds), PATHS[2], np.zeros(0), 0.0, yields=False)
        began_s = time.process_time()
        listen_in(room, way, NoWords(), spotter, wakeword)
        spent_s = time.process_time() - began_s
        yield Figure.of(
            f"core.everything.{way}", TABLE,
            "the same of all that listens: for voices, stop words and a wake word, too",
            [100 * spent_s / room.now_s], "%", column=called, wanted=8.0,
        )  # fmt: skip
    wakeword.close()


def _cost_of_echo(seconds: float) -> Iterator[Figure]:
    path, played = PATHS[2], own_voice(seconds)
    heard = list(frames(as_samples(path.echo(played) + _floor(played, path))))
    for way, called in WAYS.items():
        reference = PlayedSound()
        echo = open_echo(way, lambda: PLAYED_LEVEL, reference)
        spent_s = 0.0
        for at, frame in enumerate(heard):
            reference.add(as_samples(played[at * 512 : (at + 1) * 512]), RATE_HZ, at * 0.032)
            began_s = time.thread_time()
            echo.hear(frame)
            spent_s += time.thread_time() - began_s
        yield Figure.of(
            f"core.{way}", TABLE, "share of a core while it speaks, this alone",
            [100 * spent_s / (len(heard) * 0.032)], "%", column=called,
        )  # fmt: skip


def way_of(number: int) -> EchoPath:
    """The way that a person of this number is heard in: each says each thing in another one."""
    return PATHS[(number + number // len(PATHS)) % len(PATHS)]


def begins_s(number: int, spoke_s: float) -> float:
    """When this person begins, a little later than the one before."""
    return spoke_s + 0.37 * (number % 5)


def person(spoken: Sound, path: EchoPath) -> Sound:
    """Somebody who speaks over the robot, as loud as they are at the microphone."""
    return at_level(spoken, PLAYED_LEVEL * 10 ** ((path.gain_db + PERSON_DB) / 20))


def _floor(played: Sound, path: EchoPath) -> Sound:
    return noise_floor(played.size, path.seed)


def _people(voices: Sequence[str]) -> Iterator[tuple[str, Sound]]:
    for voice, command in itertools.product(voices, COMMANDS):
        yield command, say(voice, command) / 32768.0
