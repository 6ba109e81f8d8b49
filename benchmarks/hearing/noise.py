"""Plain commands in quiet and in a noisy room: what the robot would do about them.

Sound passes voice activity, the end of an utterance (a fixed silence), Whisper with the product's
adapter, and the interpreter without a language model. Voices, noises and the room are held out of
`training.acoustics`. "right" is done as meant, unasked; "asked" is asked back about the right call;
a wrong motion begins unasked and was not meant. Voices behind the speaker count as utterances.

Talk that is no order is played in the same noise. Noise alone is cut into pieces that each count as
an utterance, far more than voice activity lets through.
"""

import itertools
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from corpus_robots import skills_of_robots
from corpus_sentences import held_out
from numpy.typing import NDArray

from benchmarks.core.figures import Figure, Measured, NotHere
from benchmarks.hearing.heard_robot import MODEL, Outcome, Robot, outcome_figure
from edgevox.agent.skills import Call
from edgevox.models import ModelMissing
from edgevox.voice.audio import RATE_HZ, Samples
from edgevox.voice.stt.speech_to_text import Transcript
from training.acoustics import Half
from training.acoustics.mixing import at_level, mixed
from training.acoustics.noises import kinds, noise
from training.acoustics.rooms import in_room, room_of
from training.acoustics.voices import kokoro_voices, say

TABLE = f"Plain commands in noise, {MODEL}"
BY_KIND = f"Commands that are right beside each kind of noise, {MODEL}"
NEARBY, NOTHING_SAID = "Talk in noise that is no order", "Noise without speech"
A, E, H, P = "robot-apartment", "robot-external", "robot-humanoid", "robot-panda"
COMMANDS: tuple[tuple[str, str, Call], ...] = (
    (A, "Go to the kitchen.", Call("navigate_to", {"room": "kitchen"})),
    (A, "Kitchen, please.", Call("navigate_to", {"room": "kitchen"})),
    (A, "Drive to the bedroom.", Call("navigate_to", {"room": "bedroom"})),
    (A, "Take me to the living room.", Call("navigate_to", {"room": "living_room"})),
    (A, "The office, please.", Call("navigate_to", {"room": "office"})),
    (A, "Where are you?", Call("get_pose")),
    (A, "What is your battery level?", Call("battery")),
    (A, "How much battery is left?", Call("battery")),
    (E, "Go to the loading bay.", Call("navigate_to", {"location": "loading_bay"})),
    (H, "Turn left.", Call("turn_left")),
    (H, "Turn around.", Call("turn_around")),
    (H, "Turn right ninety degrees.", Call("turn_right", {"degrees": 90.0})),
    (H, "Walk forward one metre.", Call("walk_forward", {"distance": 1.0})),
    (H, "Walk backward half a metre.", Call("walk_backward", {"distance": 0.5})),
    (P, "Pick up the red cube.", Call("grasp", {"object": "red_cube"})),
    (P, "Open your hand.", Call("release")),
)
KINDS = kinds(Half.HELD_OUT)
RT60_S = 0.4
BEFORE_S, AFTER_S, LEVEL_DB = 4.0, 1.0, -26.0
"""What is around does not begin with what is said."""
ALONE_S, PIECE_S = 600.0, 4.0
SENTENCES = 160
"""So much of what the corpus has said near robots, of its held-out half."""


@dataclass(frozen=True, slots=True)
class Condition:
    """How much louder the voice is than the noise in a room; None for neither noise nor room."""

    name: str
    about: str
    snr_db: float | None
    wanted: float

    def by(self, voice: str, kind: str) -> str:
        """Where and by whom something is said, beside which noise, if any."""
        beside = "" if self.snr_db is None else f", {kind}"
        return f"{self.about}{beside}, {voice}"


CONDITIONS = (
    Condition("quiet", "quiet", None, 99.0),
    Condition("db10", "room, noise at 10 dB", 10.0, 95.0),
    Condition("db5", "room, noise at 5 dB", 5.0, 85.0),
)


def measure(quick: bool = False) -> Measured:
    """Every command by every voice in every condition and every kind of noise."""
    try:
        robots = {name: Robot(name) for name in skills_of_robots()}
        voices = kokoro_voices(Half.HELD_OUT)
    except ModelMissing as error:
        raise NotHere(str(error)) from error
    figures: list[Figure] = []
    failed: list[str] = []
    for condition in CONDITIONS:
        heard = _heard(robots, condition, voices[: 1 if quick else None], quick)
        figures += _figures(condition, [one.outcome for one in heard])
        if condition.snr_db is not None:
            figures += _by_kind(condition, heard)
        failed += [one.line for one in heard if one.outcome is not Outcome.RIGHT]
        number = 4 if quick else SENTENCES
        moved = list(_moved_by_talk(robots, condition, voices, number))
        figures.append(
            Figure(id=f"talk.{condition.name}", table=NEARBY, what=condition.about,
                   column="wrong motions", value=len(moved), n=number, wanted=0)
        )  # fmt: skip
        failed += moved
    words = list(_words_of_noise(robots[A], 20.0 if quick else ALONE_S))
    figures.append(
        Figure(id="alone.words", table=NOTHING_SAID, what="pieces in which words were heard",
               value=len(words), n=int(ALONE_S / PIECE_S)),
    )  # fmt: skip
    done = [said for said in words if robots[A].moves(said)]
    figures.append(
        Figure(
            id="alone.moved", table=NOTHING_SAID, what="wrong motions", value=len(done), wanted=0
        )
    )
    notes = {"not done as meant": tuple(failed), "heard out of noise": tuple(w.text for w in words)}
    return Measured(figures=tuple(figures), notes=notes)


def commands_at_10_db(quick: bool = False) -> Measured:
    """The part of it that the README shows: the same commands, by the same voices, in one noise."""
    try:
        robots = {name: Robot(name) for name in skills_of_robots()}
        voices = kokoro_voices(Half.HELD_OUT)
    except ModelMissing as error:
        raise NotHere(str(error)) from error
    condition = next(one for one in CONDITIONS if one.name == "db10")
    heard = _heard(robots, condition, voices[: 1 if quick else None], quick)
    return Measured(figures=tuple(_figures(condition, [one.outcome for one in heard])))


def spoken(
    voice: str,
    text: str,
    condition: Condition,
    kind: str,
    seed: int,
    *,
    half: Half = Half.HELD_OUT,
) -> Samples:
    """What the microphone hears of a sentence."""
    voiced: NDArray[Any] = say(voice, text)
    if condition.snr_db is None:
        return at_level(_padded(voiced), LEVEL_DB)
    response = room_of(RT60_S, half, seed).response()
    heard = _padded(in_room(voiced, response))
    beside = noise(kind, heard.size / RATE_HZ + 0.1, seed, half)
    return at_level(mixed(heard, beside, condition.snr_db), LEVEL_DB)


def _padded(sound: NDArray[Any]) -> NDArray[np.float64]:
    return np.pad(np.asarray(sound, np.float64), (int(BEFORE_S * RATE_HZ), int(AFTER_S * RATE_HZ)))


@dataclass(frozen=True, slots=True)
class HeardCommand:
    """What became of a command beside a kind of noise; `line` says how it was heard."""

    kind: str
    outcome: Outcome
    line: str


def _heard(
    robots: dict[str, Robot], condition: Condition, voices: Sequence[str], quick: bool
) -> list[HeardCommand]:
    """Each command by each voice, beside every second kind of noise; in a quick run the kinds take
    turns.
    """
    found, once = [], quick or condition.snr_db is None
    every = [
        (row, voice, kind)
        for row, voice in itertools.product(range(len(COMMANDS)), voices)
        for kind in _kinds_beside(row + voices.index(voice), once)
    ]
    for seed, (row, voice, kind) in enumerate(every):
        robot, text, wanted = COMMANDS[row]
        said = robots[robot].hear(spoken(voice, text, condition, kind, seed))
        outcome = robots[robot].does(said, wanted)
        words = " ".join(f"{one.text!r} {one.confidence:.2f}" for one in said)
        line = f"{condition.by(voice, kind)}: {text} {words}"
        found.append(HeardCommand(kind, outcome, f"{line}: {outcome.value}"))
    return found


def _kinds_beside(number: int, once: bool) -> Sequence[str]:
    return KINDS[number % len(KINDS) :][:1] if once else KINDS[number % 2 :: 2]


def _moved_by_talk(
    robots: dict[str, Robot], condition: Condition, voices: Sequence[str], number: int
) -> Iterator[str]:
    """A line for each sentence for which a robot would move, though it was told nothing."""
    english = [one for one in held_out() if one.language == "en" and not one.is_command]
    for seed, one in enumerate(english[:: max(1, len(english) // number)][:number]):
        voice, kind = voices[seed % len(voices)], KINDS[seed // len(voices) % len(KINDS)]
        sound = spoken(voice, one.says, condition, kind, 5_000 + seed)
        for said in robots[one.robot].hear(sound):
            if robots[one.robot].moves(said):
                yield f"{condition.by(voice, kind)}: {one.says} {said.text!r}: it moves"


def _figures(condition: Condition, outcomes: Sequence[Outcome]) -> Iterator[Figure]:
    for outcome in (Outcome.RIGHT, Outcome.ASKED, Outcome.NOTHING, Outcome.WRONG):
        yield outcome_figure(
            outcome, outcomes.count(outcome), len(outcomes),
            id=f"{condition.name}.{outcome.name.lower()}", table=TABLE, what=condition.about,
            column=outcome.value,
            wanted={Outcome.WRONG: 0, Outcome.RIGHT: condition.wanted}.get(outcome),
        )  # fmt: skip


def _by_kind(condition: Condition, heard: Sequence[HeardCommand]) -> Iterator[Figure]:
    for kind in KINDS:
        some = [one.outcome for one in heard if one.kind == kind]
        if some:
            yield Figure(
                id=f"{condition.name}.kind.{kind}", table=BY_KIND, what=kind,
                column=condition.about, value=round(100 * some.count(Outcome.RIGHT) / len(some), 1),
                unit="%", n=len(some), more_is_better=True,
            )  # fmt: skip


def _words_of_noise(robot: Robot, seconds: float) -> Iterator[Transcript]:
    """What was heard where nobody speaks to it."""
    pieces = int(seconds / PIECE_S)
    for seed in range(pieces):
        kind = KINDS[seed % len(KINDS)]
        made = noise(kind, PIECE_S, 10_000 + seed, Half.HELD_OUT)
        if (said := robot.hear_out(at_level(made, LEVEL_DB))).text:
            yield said
