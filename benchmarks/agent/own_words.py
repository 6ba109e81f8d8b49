"""Orders in people's own words to three robots: what becomes of them.

The sentences of `own_words.yaml` count as heard without a doubt; no language model takes part. Of
an order "rightly asked" is the right call, asked about first, and "asks something else" another
one. Of a sentence that is no order, one that the robot cannot do, or one that lacks something, only
what moves at once is counted.
"""

import sys
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import yaml
from corpus_robots import whole

from benchmarks.core.figures import Figure, Measured, NotHere, printed
from benchmarks.hearing.heard_robot import Outcome, Robot
from edgevox.agent.skills import Call, SkillSet
from edgevox.models import ModelMissing
from edgevox.voice.stt.speech_to_text import Transcript

FILE = Path(__file__).with_name("own_words.yaml")
ORDERS = "Orders in people's own words"
OTHERS = "No order, beyond the robot, or not complete"
HALVES = {
    "ordinary": "in ordinary words, looked at",
    "seen": "looked at",
    "apart": "kept apart",
}
RIGHT, WRONG, NOTHING = (one.value for one in (Outcome.RIGHT, Outcome.WRONG, Outcome.NOTHING))
ASKED, ELSE = "rightly asked", "asks something else"
COLUMNS = RIGHT, ASKED, WRONG, ELSE, NOTHING
_NEAR = 0.011
"""Largest part by which an amount may differ from the wanted one: feet are rounded."""


def main() -> int:
    """Print the figures, and each sentence that is not done rightly."""
    return printed("own_words", lambda: _judged(1))


def measure(quick: bool = False) -> Measured:
    """Both halves. Raises `NotHere` without a model."""
    return Measured(figures=_judged(8 if quick else 1).figures)


def _judged(every: int) -> Measured:
    data: Mapping[str, Sequence[Mapping[str, Any]]] = yaml.safe_load(FILE.read_text("utf-8"))
    figures: list[Figure] = []
    lines: list[str] = []
    try:
        robots = {name: Robot(name) for name in {one["robot"] for one in data["seen"]}}
    except ModelMissing as error:
        raise NotHere(str(error)) from error
    for half, about in HALVES.items():
        found = Counter[str]()
        for one in data[half][::every]:
            became = _became(robots[one["robot"]], one)
            found[became] += 1
            if half != "apart" and became not in {RIGHT, ASKED, "still"}:
                lines.append(f"{one['robot']}: {one['says']}: {became}")
        figures += _figures(half, about, found)
    return Measured(figures=tuple(figures), notes={ORDERS: tuple(lines)})


def _became(robot: Robot, one: Mapping[str, Any]) -> str:
    """What became of a sentence: one of `COLUMNS`, or whether one that is no order moves."""
    meaning, _ = robot.answer(Transcript(one["says"], 1.0))
    moves = robot.effect_of(meaning) == "moves"
    if isinstance(one["wants"], str):
        return "moves" if moves else "still"
    if meaning is None:
        return NOTHING
    wanted = [Call(name, args) for call in one["wants"] for name, args in call.items()]
    right = _are_alike(robot.skills, wanted, meaning.every_call)
    if meaning.sure:
        return RIGHT if right else WRONG if moves else NOTHING
    return ASKED if right else ELSE


def _are_alike(skills: SkillSet, wanted: Sequence[Call], calls: Sequence[Call]) -> bool:
    """Whether these are the same calls; "it" is the object of the call before.

    "A bit" is no amount in the file, and is the skill's own in a call.
    """
    calls = [
        one if at < len(wanted) and wanted[at].arguments else _without_little(skills, one)
        for at, one in enumerate(calls)
    ]
    first, second = whole(skills, tuple(_named(wanted))), whole(skills, tuple(_named(calls)))
    return len(first) == len(second) and all(
        one.skill == other.skill
        and one.arguments.keys() == other.arguments.keys()
        and all(is_near(one.arguments[key], other.arguments[key]) for key in one.arguments)
        for one, other in zip(first, second, strict=True)
    )


def _without_little(skills: SkillSet, call: Call) -> Call:
    little = skills[call.skill].little
    return Call(call.skill) if little and dict(call.arguments) == dict(little) else call


def _named(calls: Sequence[Call]) -> Iterator[Call]:
    last = None
    for one in calls:
        said = one.arguments.get("object")
        last = last if said == "it" else said
        yield Call(one.skill, {**one.arguments, **({"object": last} if said else {})})


def is_near(wanted: object, found: object) -> bool:
    """Whether a value is the wanted one, or an amount that rounding makes of it."""
    if isinstance(wanted, int | float) and isinstance(found, int | float):
        return abs(wanted - found) <= _NEAR * max(1.0, abs(wanted))
    return wanted == found


def _figures(half: str, about: str, found: Counter[str]) -> Iterator[Figure]:
    orders = sum(found[column] for column in COLUMNS)
    for column in COLUMNS:
        yield Figure.share(
            f"{half}.{column.split()[0].strip(',')}", ORDERS, about, found[column], orders,
            column=column, wanted=0.0 if column == WRONG else None,
        )  # fmt: skip
    others = found["moves"] + found["still"]
    yield Figure.share(
        f"{half}.moves", OTHERS, about, found["moves"], others, column="moves", wanted=0.0
    )


if __name__ == "__main__":
    sys.exit(main())
