"""The robot's own motors, fans and steps: false voices, and speech over them.

The sounds are generated (`training.acoustics.noises`) and nothing was tuned with them: drive
wheels, servos, a humanoid's steps, fans. Alone they are as loud as a voice at -26 dB of full scale,
and 12 dB louder, as at a microphone on the chassis. They play in one go: a voice detector that was
just opened takes loud servos for a short utterance about once in the first ten seconds.

Beside the robot's own voice, over the six paths of `duplex`, they are as loud as the person. Then a
person says commands at 0 dB in a room, and an utterance is over by its words, as in `endings`.
"cut" was over more than 0.3 s earlier than in quiet, without the words that were said; "late", more
than 0.5 s later, mostly because no words were understood. "Stop!" may also be spotted by its sound.
"""

import itertools
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field

import numpy as np
from listener_rig import frames
from voice_engines import words

from benchmarks.core.figures import Figure, Measured, NotHere
from benchmarks.hearing.duplex import PERSON_DB, PLAYED_LEVEL, own_voice
from benchmarks.hearing.duplex_room import Room, listen_in
from benchmarks.hearing.echo_paths import PATHS
from benchmarks.hearing.endings import Utterance, endings, listen, recogniser
from benchmarks.hearing.heard_robot import Robot
from benchmarks.hearing.listening import NoWords
from benchmarks.hearing.wake_words import ENGINES, PHRASES
from edgevox.models import ModelMissing, locate
from edgevox.voice.audio import FULL_SCALE, RATE_HZ, Samples
from edgevox.voice.stop_spotter.network import ENCODER
from edgevox.voice.stop_spotter.spotter import open_stop_spotter
from edgevox.voice.utterance_end import Endpointer, SpeechEnded
from edgevox.voice.vad import open_vad
from training.acoustics import Half
from training.acoustics.mixing import at_level, mixed
from training.acoustics.noises import ITS_OWN, noise
from training.acoustics.rooms import in_room, room_of
from training.acoustics.voices import kokoro_voices, say

ALONE, OVER = "Its own motors alone", "Its own motors, while it speaks"
SPEECH = "Speech over its own motors, at 0 dB"
LEVELS_DB = {"as loud as a voice": -26.0, "12 dB louder": -14.0}
ALONE_S, PIECE_S = 3600.0, 30.0
OVER_S = 15.0
"""Of each sound in each way."""
STOP = "Stop!"
COMMANDS = (
    "Go to the kitchen.", "Turn left.", "Where are you?", STOP, "Walk forward one metre.",
    "What is your battery level?",
)  # fmt: skip
RT60_S, BEFORE_S, AFTER_S = 0.4, 4.0, 4.0
CUT_S, LATE_S = 0.3, 0.5


@dataclass
class Taken:
    """What motors were taken for."""

    utterances: list[Samples] = field(default_factory=list)
    wakes: int = 0
    stops: int = 0


def measure(quick: bool = False) -> Measured:
    """Motors alone, motors while it speaks, and speech over motors."""
    try:
        figures = [
            *_alone(240.0 if quick else ALONE_S),
            *_over_its_voice(2.0 if quick else OVER_S),
            *_of_speech(kokoro_voices(Half.HELD_OUT)[: 1 if quick else None]),
        ]
    except ModelMissing as error:
        raise NotHere(str(error)) from error
    return Measured(figures=tuple(figures))


def motors(kind: str, seconds: float, seed: int, level_db: float) -> Samples:
    """So much of a sound, at so many dB of full scale."""
    sound = noise(kind, seconds, seed, Half.HELD_OUT) * FULL_SCALE * 10 ** (level_db / 20)
    return np.clip(sound, -FULL_SCALE, FULL_SCALE - 1).astype(np.int16)


def _alone(seconds: float) -> Iterator[Figure]:
    pieces = max(1, round(seconds / PIECE_S / len(ITS_OWN) / len(LEVELS_DB)))
    robot = Robot("robot-apartment")
    for name, level_db in LEVELS_DB.items():
        key, minutes = f"{-level_db:.0f}", pieces * len(ITS_OWN) * PIECE_S / 60
        taken = _taken(motors(kind, PIECE_S, seed, level_db)
                       for kind, seed in itertools.product(ITS_OWN, range(pieces)))  # fmt: skip
        understood = [said for one in taken.utterances if (said := robot.hear_out(one)).text]
        for what, count, wanted in (
            ("wake words, of four phrases", taken.wakes, 0),
            ("stops by their sound", taken.stops, 0),
            ("utterances", len(taken.utterances), None),
            ("utterances in which words were heard", len(understood), None),
            ("motions for them", sum(map(robot.moves, understood)), 0),
        ):
            yield Figure(
                id=f"alone.{key}.{what.split()[0]}" + (".words" if "in which" in what else ""),
                table=ALONE, what=what, column=f"{name}, in {minutes:.0f} min", value=count,
                wanted=wanted,
            )  # fmt: skip


def _taken(sounds: Iterator[Samples]) -> Taken:
    """One sound after the other, by all that listens for a person."""
    found, vad, endpointer = Taken(), open_vad(), Endpointer()
    wakewords = [ENGINES["micro"](phrase) for phrase in PHRASES]
    spotter = open_stop_spotter(locate(ENCODER))
    for frame in frames(np.concatenate(list(sounds))):
        probability = vad.probability(frame.samples)
        found.wakes += sum(one.heard(frame.samples, probability) for one in wakewords)
        found.stops += spotter.heard(frame.samples, vad.any_voice)
        signal = endpointer.push(frame, probability)
        if isinstance(signal, SpeechEnded):
            found.utterances.append(signal.samples)
    for one in wakewords:
        one.close()
    return found


def _over_its_voice(seconds: float) -> Iterator[Figure]:
    """It speaks and moves; nobody else is there."""
    counts = Counter[str]()
    for kind, path in itertools.product(ITS_OWN, PATHS):
        level_db = 20 * np.log10(PLAYED_LEVEL) + path.gain_db + PERSON_DB
        beside = motors(kind, seconds, path.seed, level_db) / FULL_SCALE
        speech = own_voice(seconds, path.seed)
        room = Room(speech, path, np.zeros(0), 0.0, yields=False, beside=beside)
        happened = listen_in(room, "cancel", NoWords(), open_stop_spotter(locate(ENCODER)))
        counts.update(
            held=len(happened.held_s),
            interrupted=len(happened.interrupted_s),
            stopped=len(happened.stopped_s),
        )
    minutes = seconds * len(ITS_OWN) * len(PATHS) / 60
    for name, what in (
        ("held", "it pauses to listen"),
        ("interrupted", "it falls silent for more than a second of voice"),
        ("stopped", "it stops"),
    ):
        yield Figure(
            id=f"over.{name}", table=OVER, what=f"{what}, in {minutes:.0f} min",
            value=counts[name], unit="times", wanted=0,
        )  # fmt: skip


def _of_speech(voices: Sequence[str]) -> Iterator[Figure]:
    """What becomes of a command, beside each sound."""
    fates = {kind: Counter[str]() for kind in ITS_OWN}
    late_s = {kind: list[float]() for kind in ITS_OWN}
    whisper, ending = recogniser(), endings().of
    for seed, (voice, text) in enumerate(itertools.product(voices, COMMANDS)):
        response = room_of(RT60_S, Half.HELD_OUT, seed).response()
        margins = (int(BEFORE_S * RATE_HZ), int(AFTER_S * RATE_HZ))
        spoken = np.pad(in_room(say(voice, text), response), margins)
        alone = at_level(spoken, LEVELS_DB["as loud as a voice"])
        quiet = listen(alone, whisper, ending).utterances[-1]
        for kind in ITS_OWN:
            beside = noise(kind, spoken.size / RATE_HZ + 0.1, seed, Half.HELD_OUT)
            sound = at_level(mixed(spoken, beside, 0.0), LEVELS_DB["as loud as a voice"])
            fate, after_s = _fate(text, quiet, listen(sound, whisper, ending).utterances)
            if fate == "not heard" and text == STOP and _taken(iter([sound])).stops:
                fate = "spotted"
            fates[kind][fate] += 1
            late_s[kind] += after_s
    for kind, each in fates.items():
        for fate in ("on time", "late", "cut", "spotted", "not heard"):
            yield Figure.share(
                f"speech.{kind}.{fate.replace(' ', '_')}", SPEECH, kind, each[fate], each.total(),
                column=fate, more_is_better=fate == "on time",
                wanted={"cut": 2.0}.get(fate),
            )  # fmt: skip
        yield Figure.of(
            f"speech.{kind}.after", SPEECH, kind, late_s[kind], "s",
            column="its end, after that in quiet",
        )  # fmt: skip


def _fate(text: str, quiet: Utterance, found: Sequence[Utterance]) -> tuple[str, list[float]]:
    its = [one for one in found if one.began_s < quiet.ended_s and one.ended_s > quiet.began_s]
    if not its:
        return "not heard", []
    late_s = its[-1].over_s - quiet.over_s
    after_s = [late_s] if np.isfinite(late_s) else []
    if late_s > LATE_S:
        return "late", after_s
    whole = any(words(one.words) == words(text) for one in its)
    cut = (late_s < -CUT_S or len(its) > 1) and not whole
    return "cut" if cut else "on time", after_s
