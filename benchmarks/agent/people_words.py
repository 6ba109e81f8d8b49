"""What people said to robots, in their own words: orders to walk, and orders about a house.

`EDGEVOX_PEOPLE_WORDS` names a folder with `scout_moves.jsonl` (utterances of commanders who drove a
robot by voice, each with the call it meant: ARL-SCOUT) and `huric.jsonl` (commands to a house robot
with their frames: HuRIC).

Sentences count as heard without a doubt; no language model takes part. "asked" is the right call,
asked about first; a wrong motion begins unasked. Sentences about a house are judged by what is done
and by what is said, by the keys of the robot's sentences:

- If they only ask it to go, it goes there, asks about just that, or says a true reason why not.
- If they ask for what it cannot do, it names all of that, even if it asks about the rest.
- If they only tell it something, it does and asks nothing.
"""

import json
import os
import re
import sys
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from itertools import product
from pathlib import Path
from typing import Any

from support.noted_phrases import noted_phrases

from benchmarks.core.figures import Figure, Measured, NotHere, printed
from benchmarks.hearing.heard_robot import Outcome, Robot
from edgevox.agent.nlu.meaning import Meaning
from edgevox.agent.phrases.load import phrasebook
from edgevox.agent.skills import Call
from edgevox.models import ModelMissing
from edgevox.voice.stt.speech_to_text import Transcript

FOLDER = "EDGEVOX_PEOPLE_WORDS"
WALKS = "People's orders to a robot that they drove by voice"
HOUSE = "People's orders to a robot in a house"
GOING = frozenset({"Motion", "Change_direction", "Arriving"})
ACTS = {
    **dict.fromkeys(
        ("Attaching", "Bringing", "Giving", "Manipulation", "Placing", "Releasing", "Taking"),
        "carry",
    ),
    **dict.fromkeys(("Inspecting", "Perception_active"), "look"),
    "Locating": "find",
    "Cotheme": "follow",
    "Change_operational_state": "switch",
    "Closure": "open",
}
"""The acts in `edgevox/core/languages` that frames ask for, by frame."""
GO = "ask it only to go"
BEYOND = "ask for what it cannot"
TELL = "tell it something"
DONE, ASKED, DECLINED, ELSE = "done", "asked about it", "declined, with a true reason", "all else"
NAMED, FORGETS = "says all that it cannot", "asks, and forgets a part"
MOVES, ASKS, LOSES = "moves", "asks", "changes something for good"
COLUMNS = {
    GO: (DONE, ASKED, DECLINED, MOVES, LOSES, ELSE),
    BEYOND: (NAMED, FORGETS, MOVES, LOSES, ELSE),
    TELL: (MOVES, ASKS, LOSES, ELSE),
}
"""What may become of each kind; `moves` is a motion that was not asked for."""
LABELS = {"en": "", "it": ", in Italian"}
SHORT = 3
"""Letters of words that name no place: "to", "the"."""
GOOD = {GO: {DONE, ASKED, DECLINED}, BEYOND: {NAMED}, TELL: {ELSE}}


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
    robot, counts, lines = Robot("robot-apartment"), Counter[tuple[str, str, str]](), []
    with noted_phrases() as noted:
        for code in LABELS:
            robot.speak(code)
            for row in (one for one in rows if one["language"] == code):
                kind = _kind(row)
                if kind == GO and code != "en":
                    continue  # where it is to go is judged by English words
                meaning, answer = robot.answer(Transcript(row["text"], 1.0))
                became = _became(robot, row, meaning, answer, noted.keys_in(answer, code))
                counts[code, kind, became] += 1
                if became not in GOOD[kind]:
                    lines.append(f"{row['text']}: {became}: {answer}")
    return [*_house_figures(counts)], tuple(lines)


def _house_figures(counts: Counter[tuple[str, str, str]]) -> Iterator[Figure]:
    for code, kind in product(LABELS, GOOD):
        became = {one: counts[code, kind, one] for one in COLUMNS[kind]}
        if of := sum(became.values()):
            group, label = f"house.{code}.{kind.split()[-1]}", f"{kind}{LABELS[code]}"
            good = sum(became[one] for one in GOOD[kind])
            yield Figure.share(
                group, HOUSE, label, good, of, column="good", wanted=95.0, more_is_better=True
            )
            for one, number in became.items():
                wanted = 0.0 if one in {MOVES, LOSES, FORGETS} else None
                name = re.sub("[^a-z]+", "_", one)
                yield Figure.share(
                    f"{group}.{name}", HOUSE, label, number, of, column=one, wanted=wanted
                )


def _kind(row: Mapping[str, Any]) -> str:
    """Of what kind a sentence about a house is."""
    frames = {frame for frame, _ in row["frames"]}
    if frames & ACTS.keys():
        return BEYOND
    return GO if frames & GOING else TELL


def _became(
    robot: Robot, row: Mapping[str, Any], meaning: Meaning | None, answer: str, keys: set[str]
) -> str:
    """What became of a sentence about a house."""
    effect, kind = robot.effect_of(meaning), _kind(row)
    became = effect if effect in {MOVES, ASKS, LOSES} else ELSE
    if kind == BEYOND:
        acts = phrasebook(row["language"]).acts
        asked_for = {ACTS[frame] for frame, _ in row["frames"] if frame in ACTS}
        if all(acts[one].cannot in answer for one in asked_for):
            return NAMED if became in {ASKS, ELSE} else became
        return FORGETS if became == ASKS else became
    if kind == GO and meaning and became in {MOVES, ASKS}:
        right, wrong = (DONE, MOVES) if became == MOVES else (ASKED, ELSE)
        return right if _goes_there(robot, row, meaning) else wrong
    if kind == GO and became == ELSE and "unknown_word" in keys:
        words = (one for one in _where(row).split() if len(one) > SHORT)
        return DECLINED if any(one in answer for one in words) else ELSE
    return became


def _where(row: Mapping[str, Any]) -> str:
    """Where a sentence wants the robot to go, or how."""
    told = (values for frame, values in row["frames"] if frame in GOING)
    where = [said for one in told for slot, said in one.items() if slot not in {"Theme", "Manner"}]
    return row["text"] if "there" in where else " ".join(where)


def _goes_there(robot: Robot, row: Mapping[str, Any], meaning: Meaning) -> bool:
    """Whether these calls go where the sentence wants, or turn as it says, as far as it says."""
    where, book = _where(row), phrasebook("en")
    amounts = {float(one) for one in re.findall(r"\d+", row["text"])}
    for call in meaning.calls:
        values = {*call.arguments.values()}
        said = {abs(one) for one in values if isinstance(one, float)}
        if said != amounts and (amounts or call.arguments != robot.skills[call.skill].little):
            return False
        choices = robot.skills[call.skill].choices.values()
        named = {
            word
            for one in choices
            for said, word in book.heard(one).items()
            if f" {said} " in f" {where} "
        }
        if not (named & values if choices else call.skill.split("_")[-1] in where.split()):
            return False
    return bool(meaning.calls)


if __name__ == "__main__":
    sys.exit(main())
