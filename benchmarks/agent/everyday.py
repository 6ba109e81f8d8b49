"""Everyday questions and a stranger's talk, answered by a language model on board.

A whole agent with a simulated robot, whose time stands still, gets the questions and the talk of
`everyday.yaml`. Answers are judged by the patterns of that file. Every question begins a
conversation; ten turns of talk are one. Only answers in which the model had a part count as its
talk. Half of the questions, chosen by their hash, are for tuning; the figures are of the others.
"""

import hashlib
import re
import statistics
import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from multiprocessing import get_context
from pathlib import Path

import yaml

from benchmarks.agent.questions import Robot, robot_of
from benchmarks.core.figures import Figure, Measured, NotHere
from edgevox.core.events import Responded, TurnMeasured
from edgevox.models import ModelMissing, locate

FILE = Path(__file__).with_name("everyday.yaml")
MODELS = {
    "qwen2.5-coder-0.5b-instruct": "0.5B",
    "qwen2.5-coder-1.5b-instruct": "1.5B",
}
ANSWERED = "Everyday questions, answered by a language model on board"
SPOKEN = "What a language model says in a stranger's talk"
COST = "Everyday questions: time to the first sentence, and memory"
ROBOTS = ("robot-apartment", "robot-panda")
FAULTS = {
    "code": "code or a call",
    "claim": "a claim or promise that it did or will do something",
    "invented": "an invented statement on itself or its world",
}
TURNS = 10
"""Turns of talk in one conversation."""


@dataclass(frozen=True, slots=True)
class Told:
    """What was said, the answer, how that is judged, and when its first sentence came."""

    half: str
    said: str
    answer: str
    judged: str
    first_s: float
    by_model: bool


@dataclass(frozen=True, slots=True)
class Found:
    """All that one model told, and the most memory that its process had for the questions."""

    told: Sequence[Told]
    peak_mb: float

    def of(self, half: str) -> Sequence[Told]:
        return [one for one in self.told if one.half == half]


def main() -> int:
    """Print every answer and its judgement, then the figures: `MODEL [tuned] [apart] [talk]`."""
    model, *halves = sys.argv[1:]
    found = ask(model, tuple(halves) or ("apart", "talk"), tell=_print)
    for figure in _figures(model, found, halves[0] if halves else "apart"):
        print(f"{figure.what}, {figure.column}: {figure.value} {figure.unit} of {figure.n}")
    return 0


def _print(one: Told) -> None:
    how = f"{one.first_s:.1f} s" + (", model" if one.by_model else "")
    print(f"{one.judged or 'fair'} ({how}): {one.said} -> {one.answer}", flush=True)


def measure(quick: bool = False) -> Measured:
    """Both models, each in a process of its own; `quick` takes every eighth of all."""
    figures, notes = list[Figure](), dict[str, tuple[str, ...]]()
    for model, label in MODELS.items():
        try:
            locate(model)
        except ModelMissing as error:
            raise NotHere(str(error)) from None
        with ProcessPoolExecutor(1, get_context("spawn")) as process:
            found = process.submit(ask, model, every=8 if quick else 1).result()
        figures += _figures(model, found)
        bad = [one for one in found.told if one.judged in {"wrong", *FAULTS}]
        notes[f"Wrong with {label}"] = tuple(f"{one.said}: {one.answer}" for one in bad)
    return Measured(figures=tuple(figures), notes=notes)


def ask(
    model: str,
    halves: Sequence[str] = ("apart", "talk"),
    every: int = 1,
    tell: Callable[[Told], object] = lambda _: None,
) -> Found:
    """Have it answer these halves of the questions, and the talk; each answer is told at once."""
    told, peak_mb = list[Told](), 0.0
    for one in _answers(model, halves, every):
        told.append(one)
        tell(one)
        if one.half != "talk":  # whose robots each load the model
            peak_mb = _peak_mb()
    return Found(told, peak_mb)


def _answers(model: str, halves: Sequence[str], every: int) -> Iterator[Told]:
    table = yaml.safe_load(FILE.read_text("utf-8"))
    rows = [row for rows in table["questions"].values() for row in rows]
    rows = [row for row in rows if _half(row["said"]) in halves]
    if rows:
        with robot_of(ROBOTS[0], model) as one:
            for row in rows[::every]:
                yield _asked(one, row)
    for code, said in table["talk"].items() if "talk" in halves else ():
        robots = ROBOTS if code == "en" else ROBOTS[:1]
        for at, robot in enumerate(robots):
            with robot_of(robot, model, code) as one:
                yield from _talked(one, said[at :: len(robots) * every], table["faults"])


def _asked(robot: Robot, row: Mapping[str, str]) -> Told:
    """The answer to a question that begins a conversation."""
    robot.begin()
    return _told(robot, _half(row["said"]), row["said"], lambda answer: _judge(row, answer))


def _talked(
    robot: Robot, said: Sequence[str], faults: Mapping[str, Sequence[str]]
) -> Iterator[Told]:
    """The answers to these, `TURNS` to a conversation."""
    for at, one in enumerate(said):
        if at % TURNS == 0:
            robot.begin()
        yield _told(robot, "talk", one, lambda answer: _fault(faults, answer))


def _told(robot: Robot, half: str, said: str, judge: Callable[[str], str]) -> Told:
    seen = robot.say(said)
    answer = " ".join(one.text for one in seen if isinstance(one, Responded))
    measured = next((one for one in seen if isinstance(one, TurnMeasured)), None)
    by_model = bool(measured and measured.llm)
    judged = judge(answer) if half != "talk" or by_model else ""
    return Told(half, said, answer, judged, measured.ttfs if measured else 0.0, by_model)


def _half(said: str) -> str:
    return "tuned" if hashlib.sha256(said.encode()).digest()[0] % 2 else "apart"


UNKNOWN = re.compile(
    r"\bI(?: do not| don't| cannot| can't|'m not| am not| did not)\b|^Sorry\b", re.IGNORECASE
)


def _judge(row: Mapping[str, str], answer: str) -> str:
    """`right`, `unknown` or `wrong`. What nobody can know is right if it is said to be unknown."""
    unknown = bool(UNKNOWN.search(answer))
    if "right" not in row:
        return "right" if unknown else "wrong"
    if unknown:
        return "unknown"
    right = re.search(row["right"], answer, re.IGNORECASE)
    lacks = re.search(row.get("lacks", "(?!)"), answer, re.IGNORECASE)
    return "right" if right and not lacks else "wrong"


def _fault(faults: Mapping[str, Sequence[str]], answer: str) -> str:
    """The first of `FAULTS` that the answer has; empty for none."""
    hits = (
        name
        for name, patterns in faults.items()
        for one in patterns
        if re.search(one, answer, re.IGNORECASE)
    )
    return next(hits, "")


def _peak_mb() -> float:
    lines = Path("/proc/self/status").read_text("ascii").splitlines()
    peak = next(line for line in lines if line.startswith("VmHWM:"))
    return int(peak.split()[1]) * 1024 / 1e6


def _figures(model: str, found: Found, half: str = "apart") -> Iterator[Figure]:
    label = MODELS.get(model, model)
    name = label.lower()
    questions, talk = found.of(half), [one for one in found.of("talk") if one.by_model]
    for judged, what in {"right": "right", "unknown": "“I do not know”", "wrong": "wrong"}.items():
        hits = sum(one.judged == judged for one in questions)
        if questions:
            yield Figure.share(
                f"{judged}.{name}", ANSWERED, what, hits, len(questions), column=label,
                more_is_better=judged == "right",
            )  # fmt: skip
    for fault, what in FAULTS.items() if found.of("talk") else ():
        hits = sum(one.judged == fault for one in talk)
        yield Figure.share(
            f"{fault}.{name}", SPOKEN, what, hits, len(found.of("talk")), column=label, wanted=0
        )
    if found.of("talk"):
        yield Figure.share(
            f"model.{name}", SPOKEN, "the model spoke", len(talk), len(found.of("talk")),
            column=label,
        )  # fmt: skip
    first, *times = [one.first_s for one in questions if one.by_model] or [0.0]
    if len(times) > 1:
        for key, what, value, unit in (
            ("start", "the first question, right after the start", first, "s"),
            ("median", "the others, median", statistics.median(times), "s"),
            ("p95", "the others, 95 %", statistics.quantiles(times, n=20)[-1], "s"),
            ("peak", "most memory", found.peak_mb, "MB"),
        ):
            yield Figure.of(f"{key}.{name}", COST, what, [value], unit, column=label)


if __name__ == "__main__":
    sys.exit(main())
