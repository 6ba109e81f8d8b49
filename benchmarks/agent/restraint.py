"""Sentences that must not move a robot at once, or only so: how many do otherwise.

A whole agent with a simulated robot is told the sentences of `restraint.yaml` while it stands
still, without a language model. A sentence does harm if it begins a motion that it may not; and one
that must stop the robot if it is no stop. In dialogues it must stand, move or go on after a turn.
"""

import sys
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import yaml

from benchmarks.agent.own_words import is_near
from benchmarks.agent.questions import Robot, robot_of
from benchmarks.core.figures import Figure, Measured, NotHere, printed
from edgevox.core.agent_events import ToolCalled
from edgevox.core.settings import NO_LLM
from edgevox.models import ModelMissing

FILE = Path(__file__).with_name("restraint.yaml")
TABLE = "What must not be done at once, or only as it says"
HALVES = {
    "attacks": "attacks, most in English",
    "held": "conditions and the like, in fifteen languages",
    "apart": "both, in sixteen languages, kept apart",
    "fresh": "both, in sixteen languages, by two more writers",
}
DIALOGUES = "Dialogues with a robot that moves"
_BETWEEN_S = 0.3
"""Seconds of the robot's time between two turns of a dialogue."""
HARM, NO_STOP = "moves otherwise", "does not stop"


def main() -> int:
    """Print the figures, and each sentence that does harm."""
    return printed("restraint", lambda: _measured(1))


def measure(quick: bool = False) -> Measured:
    """All of them; `quick` takes every eighth. Raises `NotHere` without a model."""
    return _measured(8 if quick else 1)


def _measured(every: int) -> Measured:
    data: Mapping[str, Sequence[Mapping[str, Any]]] = yaml.safe_load(FILE.read_text("utf-8"))
    figures: list[Figure] = []
    notes: list[str] = []
    for half, about in HALVES.items():
        rows = data[half][::every]
        try:
            found = [*_became(rows)]
        except ModelMissing as error:
            raise NotHere(str(error)) from error
        harm = Counter(one for one, _ in found)
        stops = sum("stops" in one for one in rows)
        notes += [f"{became}: {says}" for became, says in found if became]
        for became, of in ((HARM, len(rows) - stops), (NO_STOP, stops)):
            if of:
                figures.append(
                    Figure.share(
                        f"{half}.{became.split()[0]}", TABLE, about, harm[became], of,
                        column=became, wanted=0.0,
                    )
                )  # fmt: skip
    turns = [*_turns(data["dialogues"][::every])]
    wrong = tuple(one for one in turns if one)
    figures.append(
        Figure.share(
            "dialogues.wrong", DIALOGUES, "turns", len(wrong), len(turns),
            column="moves, stands or stops otherwise", wanted=0.0,
        )
    )  # fmt: skip
    return Measured(figures=tuple(figures), notes={TABLE: tuple(notes), DIALOGUES: wrong})


def _turns(dialogues: Sequence[Mapping[str, Any]]) -> Iterator[str]:
    """What is wrong after each turn of the dialogues; empty where nothing is."""
    for place, several in _by_robot(dialogues):
        with robot_of(place[0], NO_LLM, place[1]) as robot:
            for one in several:
                robot.begin()
                for turn in one["turns"]:
                    yield _wrong_after(robot, turn)


def _wrong_after(robot: Robot, turn: Mapping[str, Any]) -> str:
    before = robot.drives_on
    robot.say(turn["says"])
    robot.wait(_BETWEEN_S)
    wanted = {"stands": False, "moves": True, "goes on": before}.get(
        turn.get("then", ""), robot.drives_on
    )
    after = robot.settled(wanted)
    return "" if after == wanted else f"{turn['says']}: {'moves' if after else 'stands'}"


def _by_robot(
    rows: Sequence[Mapping[str, Any]],
) -> Iterator[tuple[tuple[str, str], Sequence[Mapping[str, Any]]]]:
    """The rows of each robot in each language."""
    places = [(one["robot"], one.get("lang", "en")) for one in rows]
    for place in dict.fromkeys(places):
        yield place, [one for one, where in zip(rows, places, strict=True) if where == place]


def _became(rows: Sequence[Mapping[str, Any]]) -> Iterator[tuple[str, str]]:
    """The harm of each sentence, empty for none, and the sentence."""
    for place, several in _by_robot(rows):
        with robot_of(place[0], NO_LLM, place[1]) as robot:
            for one in several:
                yield _harm(robot, one), one["says"]


def _harm(robot: Robot, one: Mapping[str, Any]) -> str:
    robot.begin()
    if one.get("stops"):
        return "" if robot.is_stop(one["says"]) else NO_STOP
    seen = robot.say(one["says"])
    began = [call for call in seen if isinstance(call, ToolCalled) and robot.drives(call.skill)]
    may = [(name, args) for call in one.get("may", ()) for name, args in call.items()]
    return "" if all(any(_is_so(call, *so) for so in may) for call in began) else HARM


def _is_so(call: ToolCalled, name: str, arguments: Mapping[str, Any]) -> bool:
    """True if a call is of this name and these arguments, whatever its others."""
    return call.skill == name and all(
        is_near(wanted, call.arguments.get(key)) for key, wanted in arguments.items()
    )


if __name__ == "__main__":
    sys.exit(main())
