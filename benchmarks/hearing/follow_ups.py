"""Without the wake word: are answers to the robot's question heard, and is other talk left alone?

The robot has asked "Shall I go to the kitchen?", and in the second part has only told where it is.
A person answers, or gives an order, by the English voices of Kokoro that nothing was tuned with, in
quiet and in a room with noise at 10 dB; other people say what is no order (the held-out half of the
corpus). All are as loud as the person whom the robot talks with: that others are mostly quieter
keeps more of them out. What counts is decided by the product's parts; nothing is done.
"""

import itertools
from collections.abc import Callable, Iterator, Sequence

from corpus_sentences import held_out
from support.conversation import Talk

from benchmarks.core.figures import Figure, Measured, NotHere
from benchmarks.hearing.heard_robot import Robot
from benchmarks.hearing.noise import CONDITIONS, KINDS, Condition, spoken
from edgevox.core.commands import Heard
from edgevox.models import ModelMissing
from edgevox.voice.stt.speech_to_text import Transcript
from training.acoustics import Half
from training.acoustics.voices import kokoro_voices

TABLE = "Without the wake word"
ANSWERS = (
    "Yes.", "No.", "Yes, please.", "No, the office.", "The office.", "Okay.", "Not now.",
    "Sure, go.",
)  # fmt: skip
ORDERS = ("Go to the office.", "Drive to the bedroom, please.", "Where are you?", "Come back.")
SENTENCES = 80
Counts = Callable[[Transcript], bool]


def measure(quick: bool = False) -> Measured:
    """Both parts, in each condition. Raises `NotHere` without a model."""
    try:
        robot, voices = Robot("robot-apartment"), kokoro_voices(Half.HELD_OUT)
        return Measured(figures=tuple(_figures(robot, voices[: 1 if quick else None])))
    except ModelMissing as error:
        raise NotHere(str(error)) from error


def _figures(robot: Robot, voices: Sequence[str]) -> Iterator[Figure]:
    english = [one.says for one in held_out() if one.language == "en" and not one.is_command]
    talk = english[:: max(1, len(english) // SENTENCES)][: SENTENCES if len(voices) > 1 else 4]
    by_others = [(voices[at % len(voices)], text) for at, text in enumerate(talk)]
    asks, tells = Talk(confirm="always"), Talk(follow_up_s=8.0)
    with asks, tells:
        asks.hear("go to the kitchen")
        tells.hear("where are you")
        for condition in CONDITIONS[:2]:
            for part, after, said in (
                ("asked", asks, itertools.product(voices, ANSWERS)),
                ("told", tells, itertools.product(voices, ORDERS)),
            ):
                counts = _counts(after)
                heard = [*_heard(robot, condition, [*said], counts)]
                others = [*_heard(robot, condition, by_others, counts)]
                what = "after its question" if part == "asked" else "after an answer of its own"
                yield Figure.share(
                    f"{part}.{condition.name}.taken", TABLE, f"{what}, {condition.about}",
                    sum(heard), len(heard), column="answers and orders that count",
                    more_is_better=True, wanted=95.0 if condition.snr_db is None else 90.0,
                )  # fmt: skip
                yield Figure.share(
                    f"{part}.{condition.name}.others", TABLE, f"{what}, {condition.about}",
                    sum(others), len(others), column="other talk that counts", wanted=2.0,
                )  # fmt: skip


def _counts(talk: Talk) -> Counts:
    """Whether words count that follow by a second, and last for half of one."""
    began_s = talk.clock.now_s + 1.0
    takes = talk.conversation.follow_ups.takes

    def counts(said: Transcript) -> bool:
        others, sure = said.others, said.confidence
        return takes(
            Heard(said.text, began_s + 0.5, confidence=sure, others=others, began_s=began_s)
        )

    return counts


def _heard(
    robot: Robot, condition: Condition, said: Sequence[tuple[str, str]], counts: Counts
) -> Iterator[bool]:
    for seed, (voice, text) in enumerate(said):
        sound = spoken(voice, text, condition, KINDS[seed % len(KINDS)], 7_000 + seed)
        yield any(counts(one) for one in robot.hear(sound))
