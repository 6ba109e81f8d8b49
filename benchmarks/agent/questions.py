"""Questions to three robots about themselves and their world: how many are answered rightly.

A whole agent with a simulated robot is asked the questions of `questions.yaml` while its time
stands still, without a language model or with the one that an argument names. A right answer has
what the file says, begins and ends no motion, and asks nothing.
"""

import re
import sys
import time
from collections.abc import Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import yaml

from benchmarks.core.figures import Figure, Measured
from edgevox.agent.skills import SkillSet
from edgevox.apps.agent.build import build_parts, start_parts
from edgevox.apps.robots import build_body
from edgevox.core.agent_events import Confirmation, ProgramChanged, ToolCalled
from edgevox.core.commands import Reset, TextInput
from edgevox.core.events import Responded, TurnEnded, TurnMeasured
from edgevox.core.settings import NO_LLM, load_settings
from edgevox.robots.capabilities import Advances, Body, TellsMotions

FILE = Path(__file__).with_name("questions.yaml")
TABLE = "Questions to a robot about itself and its world, answered rightly"
KINDS = {"tuned": "that templates were written from", "apart": "kept apart"}
_NUMBER = re.compile(r"-?\d+(?:\.\d+)?")
_UNDER_WAY_S, _STEP_S, _MOST_S, _SETTLES_S = 2.0, 0.5, 240.0, 2.0
_ANSWER_S = 120.0
"""A language model on few cores may take long."""


@dataclass(frozen=True, slots=True)
class Asked:
    """A question, its answer, and the reason why that is wrong; empty if it is right."""

    robot: str
    kind: str
    said: str
    answer: str
    wrong: str
    seconds: float


def main() -> int:
    """Print each question that is answered wrongly, then the figures."""
    llm = sys.argv[1] if len(sys.argv) > 1 else NO_LLM
    asked = ask_all(llm)
    for one in asked:
        mark = "WRONG" if one.wrong else "right"
        print(f"{mark} {one.robot} {one.kind}: {one.said} -> {one.answer} {one.wrong}")
    for figure in _figures(asked):
        print(f"{figure.what}, {figure.column}: {figure.value} {figure.unit} of {figure.n}")
    return 0


def measure(quick: bool = False) -> Measured:
    """All of them without a language model; `quick` asks every fourth."""
    asked = ask_all(NO_LLM, every=4 if quick else 1)
    wrong = [f"{one.robot}: {one.said}: {one.answer}" for one in asked if one.wrong]
    return Measured(figures=tuple(_figures(asked)), notes={"Answered wrongly": tuple(wrong)})


def ask_all(llm: str, *, every: int = 1) -> list[Asked]:
    """Ask all questions of the file."""
    table: Mapping[str, Mapping[str, Any]] = yaml.safe_load(FILE.read_text("utf-8"))
    asked: list[Asked] = []
    for robot, kinds in table.items():
        with robot_of(robot, llm) as one:
            rows = [(kind, row) for kind, rows in kinds.items() for row in rows]
            asked += [one.ask(kind, row) for kind, row in rows[::every]]
    return asked


class Robot:
    """A whole agent with a simulated body, asked one question after another from the start."""

    def __init__(self, name: str, body: Body, parts: Any) -> None:
        self._name, self._body, self._parts = name, body, parts
        self._seen: list[Any] = []
        seen = Responded | TurnMeasured | TurnEnded | ToolCalled | Confirmation | ProgramChanged
        parts.bus.subscribe(seen, self._seen.append)

    def ask(self, kind: str, row: Mapping[str, Any]) -> Asked:
        """Ask the question of this row, and judge its answer."""
        self.begin()
        for said in row.get("after", ()):
            self.say(said)
            self.arrive()
        if under_way := row.get("during"):
            self.say(under_way)
            self.settled(True)
            self._pass(_UNDER_WAY_S)
        moving, began_s = self._moving, time.monotonic()
        seen = self.say(row["said"])
        took_s = time.monotonic() - began_s
        answer = " ".join(one.written for one in seen if isinstance(one, Responded))
        wrong = _judge(row, answer) or self._harm(seen, moving=moving)
        return Asked(self._name, kind, row["said"], answer, wrong, took_s)

    def begin(self) -> None:
        """Begin a conversation, with the body where it starts."""
        self._parts.conversation.submit(Reset())
        self._parts.conversation.wait_idle(_ANSWER_S)
        self._body.reset()
        self._pass(_STEP_S)

    def say(self, text: str) -> Sequence[Any]:
        """Say it; the events until the turn has ended."""
        before, turns = len(self._seen), self._count()
        self._parts.conversation.submit(TextInput(text))
        deadline_s = time.monotonic() + _ANSWER_S
        while self._count() == turns and time.monotonic() < deadline_s:
            time.sleep(0.002)
        return self._seen[before:]

    @property
    def drives_on(self) -> bool:
        """True if a goal moves it, or waits to."""
        return bool(self._parts.conversation.moving)

    def settled(self, wanted: bool) -> bool:
        """Whether it `drives_on`, once that is as wanted, or after a while."""
        deadline_s = time.monotonic() + _SETTLES_S
        while self.drives_on != wanted and time.monotonic() < deadline_s:
            time.sleep(0.01)
        return self.drives_on

    def wait(self, seconds: float) -> None:
        """Let its time pass."""
        self._pass(seconds)

    def is_stop(self, text: str) -> bool:
        """True if these words stop it."""
        return bool(self._parts.conversation.is_stop(text))

    @property
    def skills(self) -> SkillSet:
        """All skills of it, those of a dialogue among them."""
        skills: SkillSet = self._parts.conversation.interpreter.active.every_skill
        return skills

    def phrase(self, name: str) -> str:
        """A sentence that it says, by its key."""
        return str(self._parts.conversation.interpreter.phrases.say(name))

    def drives(self, skill: str) -> bool:
        """True if this skill of it moves it."""
        return skill in self.skills and self.skills[skill].drives

    def _harm(self, seen: Sequence[Any], *, moving: bool) -> str:
        if any(isinstance(one, Confirmation) for one in seen):
            return "it asked"
        if moving != self._moving:
            return "a motion began or ended"
        return ""

    @property
    def _moving(self) -> bool:
        return isinstance(self._body, TellsMotions) and self._body.in_motion

    def _count(self) -> int:
        return sum(isinstance(one, TurnEnded) for one in self._seen)

    def arrive(self) -> Sequence[Any]:
        """Let time pass until what was begun has ended; the events until then."""
        before, left_s = len(self._seen), _MOST_S
        time.sleep(0.05)
        while self._parts.conversation.busy and left_s > 0:
            self._pass(_STEP_S)
            left_s -= _STEP_S
            if not self._parts.conversation.wait_idle(0.02):
                continue
        self._parts.conversation.wait_idle(1.0)
        return self._seen[before:]

    def _pass(self, seconds: float) -> None:
        if isinstance(self._body, Advances):
            time.sleep(0.02)
            self._body.advance(seconds)


@contextmanager
def robot_of(name: str, llm: str, language: str = "en") -> Iterator[Robot]:
    """The robot, with an agent around it."""
    settings = load_settings({"text_mode": True, "llm": llm, "ros2": False, "language": language})
    with ExitStack() as stack:
        body = build_body(name, settings, 0.0)
        parts = build_parts(stack, settings, body)
        start_parts(stack, parts)
        yield Robot(name, body, parts)


def _judge(row: Mapping[str, Any], answer: str) -> str:
    low, high = row.get("number", (None, None))
    numbers = [float(one) for one in _NUMBER.findall(answer)]
    if low is not None and not any(low <= one <= high for one in numbers):
        return f"no number from {low} to {high}"
    missing = [one for one in row.get("holds", ()) if not re.search(one, answer, re.IGNORECASE)]
    if missing:
        return f"lacks {', '.join(missing)}"
    found = [one for one in row.get("lacks", ()) if re.search(one, answer, re.IGNORECASE)]
    unknown = re.search(r"did not understand|Sorry, I do not know|Shall I", answer)
    return f"holds {', '.join(found)}" if found else "no answer" if unknown else ""


def _figures(asked: Sequence[Asked]) -> Iterator[Figure]:
    for kind, about in KINDS.items():
        for robot in dict.fromkeys(one.robot for one in asked):
            mine = [one for one in asked if one.kind == kind and one.robot == robot]
            if mine:
                right = sum(not one.wrong for one in mine)
                name = robot.removeprefix("robot-")
                yield Figure.share(
                    f"{kind}.{name}", TABLE, about, right, len(mine), column=name,
                    more_is_better=True,
                )  # fmt: skip


if __name__ == "__main__":
    sys.exit(main())
