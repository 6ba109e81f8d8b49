"""What people said to robots, in their own words: orders to walk, and orders about a house.

`EDGEVOX_PEOPLE_WORDS` names a folder with `scout_moves.jsonl` (utterances of commanders who drove a
robot by voice, each with the call it meant: ARL-SCOUT) and `huric.jsonl` (commands to a house robot
with their frames: HuRIC).

Sentences count as heard without a doubt; no language model takes part. "asked" is the right call,
asked about first; a wrong motion begins unasked. A house sentence with no other frame than Motion
and Change_direction asks the robot to go; no other may move it.
"""

import json
import os
import sys
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from benchmarks.core.figures import Figure, Measured, NotHere, printed
from benchmarks.hearing.heard_robot import Outcome, Robot
from edgevox.agent.skills import Call
from edgevox.models import ModelMissing
from edgevox.voice.stt.speech_to_text import Transcript

FOLDER = "EDGEVOX_PEOPLE_WORDS"
WALKS = "People's orders to a robot that they drove by voice"
HOUSE = "People's orders to a robot in a house"
GOING = frozenset({"Motion", "Change_direction"})
GOES, OTHER = "ask it to go", "ask for what it cannot, or for nothing"


def main() -> int:
    """Print the figures and each sentence that did not come out as it was meant."""
    return printed("people_words", lambda: _judged(1))


def measure(quick: bool = False) -> Measured:
    """Both sets. Raises `NotHere` without the sentences or a model.

    The sentences themselves are other people's, and are kept nowhere.
    """
    return Measured(figures=_judged(8 if quick else 1).figures)


def _judged(every: int) -> Measured:
    try:
        walks, went_wrong = _walks(_rows("scout_moves.jsonl")[::every])
        house, moved = _house(_rows("huric.jsonl")[::every])
    except ModelMissing as error:
        raise NotHere(str(error)) from error
    return Measured(figures=(*walks, *house), notes={WALKS: went_wrong, HOUSE: moved})


def _rows(name: str) -> list[Mapping[str, Any]]:
    file = Path(os.environ.get(FOLDER, "")) / name
    if FOLDER not in os.environ or not file.is_file():
        raise NotHere(f"{FOLDER} names no folder with a {name} of people's words")
    return [json.loads(line) for line in file.read_text("utf-8").splitlines()]


def _walks(rows: Sequence[Mapping[str, Any]]) -> tuple[list[Figure], tuple[str, ...]]:
    robot, lines = Robot("robot-humanoid"), []
    different, said = Counter[Outcome](), Counter[Outcome]()
    for row in rows:
        ((skill, arguments),) = row["calls"]
        outcome = robot.does([Transcript(row["text"], 1.0)], Call(skill, arguments))
        different[outcome] += 1
        said[outcome] += row["said"]
        if outcome is not Outcome.RIGHT:
            lines.append(f"{row['text']}: {outcome.value}")
    return [*_shares("different", different), *_shares("said", said)], tuple(lines)


def _shares(what: str, counts: Counter[Outcome]) -> Iterator[Figure]:
    label = {"different": "each sentence once", "said": "as often as it was said"}[what]
    for outcome in Outcome:
        yield Figure.share(
            f"walks.{what}.{outcome.name.lower()}", WALKS, label, counts[outcome], counts.total(),
            column=outcome.value, more_is_better=outcome is Outcome.RIGHT,
        )  # fmt: skip


def _house(rows: Sequence[Mapping[str, Any]]) -> tuple[list[Figure], tuple[str, ...]]:
    robot, counts, lines = Robot("robot-apartment"), Counter[tuple[str, str]](), []
    for row in rows:
        if row["language"] != "en":
            continue
        kind = GOES if {frame for frame, _ in row["frames"]} <= GOING else OTHER
        effect = robot.effect(Transcript(row["text"], 1.0))
        counts[kind, effect] += 1
        if (kind, effect) not in {(GOES, "moves"), (OTHER, "nothing, or an answer")}:
            lines.append(f"{row['text']}: {effect}")
    kinds = Counter[str]()
    for (kind, _), number in counts.items():
        kinds[kind] += number
    return [
        Figure.share(
            f"house.{kind.split()[-1]}.{effect.split(',')[0]}".replace(" ", "_"), HOUSE, kind,
            counts[kind, effect], kinds[kind], column=effect,
        )
        for kind in (GOES, OTHER)
        for effect in ("moves", "asks", "changes something for good", "nothing, or an answer")
    ], tuple(lines)  # fmt: skip


if __name__ == "__main__":
    sys.exit(main())
