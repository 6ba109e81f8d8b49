"""Conversations of strangers with three robots: how many turns are answered well.

A whole agent with a simulated robot, and without a language model, hears the conversations of
`strangers.yaml` turn by turn. An order that it asks about rightly is confirmed, and each motion
ends before the next turn. The file says what a turn `wants`:

- `do`: these calls. Others that move it, or a reason why it could not, are wrong.
- `refer`: what was done before, once more or changed. It is good to do or to ask anything.
- `program`: a program for later or several times. To move at once is wrong.
- `tell`: an answer by one of these skills. An answer to another question, or a motion, is wrong.
- `decline`, `talk`, `general`, `ask`: it says that it cannot, a few words, that it does not know,
  or what is missing. To move, to ask whether to, or to answer something else is wrong.

All else is poor, as is "I did not understand".
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
from edgevox.agent.skills import Skill
from edgevox.core.agent_events import (
    Confirmation,
    ConfirmationStatus,
    ProgramChanged,
    ToolCalled,
)
from edgevox.core.events import Outcome, Responded, TurnEnded
from edgevox.core.settings import NO_LLM
from edgevox.models import ModelMissing

FILE = Path(__file__).with_name("strangers.yaml")
TABLES = {"seen": "Turns of strangers, looked at", "apart": "Turns of strangers, kept apart"}
GOOD, POOR, WRONG = "good", "poor", "wrong"
WANTED = {GOOD: 95.0, WRONG: 0.0}
ABOUT = {
    "do": "want it to do something",
    "refer": "refer to what it did",
    "program": "want it later, or several times",
    "tell": "ask about itself and its world",
    "decline": "want what it cannot",
    "talk": "want nothing",
    "general": "ask about the world in general",
    "ask": "lack something",
}
ALL = "all"
_TURNS = {"turn_left", "turn_right"}
_HALF_TURN, _TURN = 180.0, 90.0
_NOT_SAID = (Outcome.NOT_UNDERSTOOD, Outcome.FAILED)


def main() -> int:
    """Print the figures, and each turn that is not answered well."""
    return printed(FILE.stem, lambda: _judged(1))


def measure(quick: bool = False) -> Measured:
    """All conversations; `quick` has every fourth. Raises `NotHere` without a model."""
    return Measured(figures=_judged(4 if quick else 1).figures)


def _judged(every: int) -> Measured:
    halves: Mapping[str, Sequence[Mapping[str, Any]]] = yaml.safe_load(FILE.read_text("utf-8"))
    figures: list[Figure] = []
    notes: dict[str, tuple[str, ...]] = {}
    try:
        for half, table in TABLES.items():
            found, lines = _counted(halves[half], every)
            figures += _figures(half, table, found)
            notes |= {table: tuple(lines)} if half == "seen" else {}
    except ModelMissing as error:
        raise NotHere(str(error)) from error
    return Measured(figures=tuple(figures), notes=notes)


def _counted(
    talks: Sequence[Mapping[str, Any]], every: int
) -> tuple[Counter[tuple[str, str]], list[str]]:
    """How many turns of each kind became what, and those that were not answered well."""
    found = Counter[tuple[str, str]]()
    lines: list[str] = []
    for name in dict.fromkeys(one["robot"] for one in talks):
        with robot_of(name, NO_LLM) as robot:
            for talk in [one for one in talks if one["robot"] == name][::every]:
                robot.begin()
                for turn in talk["turns"]:
                    became, answer = _said_to(robot, turn)
                    (kind,) = turn["wants"]
                    found[kind, became] += 1
                    if became != GOOD:
                        lines.append(f"{became}: {name}: {turn['says']} -> {answer}")
    return found, lines


def _said_to(robot: Robot, turn: Mapping[str, Any]) -> tuple[str, str]:
    """What became of a turn, and the robot's answer."""
    seen = [*robot.say(turn["says"]), *robot.arrive()]
    answer = " ".join(one.text for one in seen if isinstance(one, Responded))
    asked = [one for one in seen if isinstance(one, Confirmation)]
    ((kind, wants),) = turn["wants"].items()
    became = _became(robot, kind, wants, seen)
    waits = asked and asked[-1].status is ConfirmationStatus.ASKED
    if waits and became == GOOD:
        robot.say("yes")
        robot.arrive()
    return became, answer


def _became(robot: Robot, kind: str, wants: Any, seen: Sequence[Any]) -> str:
    skills = robot.skills
    called = [one for one in seen if isinstance(one, ToolCalled)]
    moved = [one for one in called if skills[one.skill].moves or skills[one.skill].lasting]
    told = [one.skill for one in called if one not in moved]
    asks = [
        one
        for one in seen
        if isinstance(one, Confirmation) and one.status is ConfirmationStatus.ASKED
    ]
    outcome = next((one.outcome for one in seen if isinstance(one, TurnEnded)), None)
    answered = outcome is Outcome.ANSWERED and not called
    says = " ".join(one.text for one in seen if isinstance(one, Responded))
    match kind:
        case "do":
            proposed = [(one.skill, one.arguments) for one in (moved or [*_calls_of(asks)])]
            if proposed and _are_alike(skills, wants, proposed):
                return GOOD
            return WRONG if moved or told or outcome is Outcome.REFUSED else POOR
        case "refer":
            return GOOD if moved or asks else WRONG if told else POOR
        case "program":
            planned = any(isinstance(one, ProgramChanged) for one in seen)
            return GOOD if planned or asks else WRONG if called else POOR
        case "tell":
            rightly = bool(told) and not moved and not set(told).isdisjoint(wants)
            return GOOD if rightly else WRONG if called or asks else POOR
        case _ if called or asks:
            return GOOD if kind == "ask" and asks and not called else WRONG
        case "decline" | "ask":
            declined = outcome is Outcome.REFUSED or says.startswith(robot.phrase("no_ability"))
            return GOOD if declined else WRONG if answered else POOR
        case "general" if says == robot.phrase("not_known"):
            return GOOD
        case _:
            return GOOD if answered else POOR if outcome in _NOT_SAID else WRONG


def _calls_of(asks: Sequence[Confirmation]) -> Iterator[Any]:
    return (call for one in asks[-1:] for call in one.calls)


def _are_alike(
    skills: Mapping[str, Skill],
    wants: Sequence[Mapping[str, Mapping[str, Any]]],
    calls: Sequence[tuple[str, Mapping[str, Any]]],
) -> bool:
    wanted = [pair for one in wants for pair in one.items()]
    return len(wanted) == len(calls) and all(
        _is_alike(skills[found], name, arguments or {}, found, said)
        for (name, arguments), (found, said) in zip(wanted, calls, strict=True)
    )


def _is_alike(
    one: Skill, name: str, wanted: Mapping[str, Any], found: str, said: Mapping[str, Any]
) -> bool:
    """Whether a call is the wanted one. "It" is any object; "a bit" is what the skill takes."""
    if name == "turn_around" and found in _TURNS:
        return said.get("degrees") == _HALF_TURN
    if found == name and name in _TURNS and not wanted:
        return said.get("degrees", _TURN) in (_TURN, *(one.little or {}).values())
    given = {key: value for key, value in wanted.items() if value != "it" and key != "name"}
    more = said.keys() - wanted.keys()
    little = one.little or {}
    bare = not one.relative or all(said[key] == little.get(key) for key in more)
    near = all(key in said and is_near(value, said[key]) for key, value in given.items())
    return found == name and near and bare


def _figures(half: str, table: str, found: Counter[tuple[str, str]]) -> Iterator[Figure]:
    kinds = [one for one in ABOUT if any(kind == one for kind, _ in found)]
    for kind in (*kinds, ALL):
        some = kinds if kind == ALL else [kind]
        tries = sum(found[one, became] for one in some for became in (GOOD, POOR, WRONG))
        for became in (GOOD, POOR, WRONG):
            yield Figure.share(
                f"{half}.{kind}.{became}", table, ABOUT.get(kind, ALL),
                sum(found[one, became] for one in some), tries, column=became,
                wanted=WANTED.get(became) if kind == ALL else None, more_is_better=became == GOOD,
            )  # fmt: skip


if __name__ == "__main__":
    sys.exit(main())
