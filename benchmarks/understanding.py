"""How much of what people say is understood, by templates and by models.

    python benchmarks/understanding.py [--models ID ...] [--backends NAME ...] [--output FILE]

Runs every command of `tests/models/commands.yaml`: those that the templates promise through the
templates, all others through each model; and what is said freely to the arm and to the humanoid,
from `commands_bodies.yaml`. Writes tables in Markdown.
"""

import argparse
import statistics
import time
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import yaml
from machine import machine

from edgevox.agent.intents import Recogniser, Understood
from edgevox.agent.llm.base import LanguageModel, Message, ModelFailed
from edgevox.agent.llm.factory import load_model
from edgevox.agent.mind import ANSWER_TOKENS
from edgevox.agent.skills import Call, SkillSet
from edgevox.agent.toolcalls import Protocol
from edgevox.apps.robots import INSTRUCTIONS, ROBOTS
from edgevox.core.cancel import CancelToken
from edgevox.core.errors import InvalidValue
from edgevox.models import ModelMissing, locate
from edgevox.robots.apartment import ApartmentRobot
from edgevox.robots.humanoid.skills import walking_skills
from edgevox.robots.panda.skills import manipulation_skills

ROOT = Path(__file__).parents[1]
COMMANDS = ROOT / "tests" / "models" / "commands.yaml"
COMMANDS_OF_BODIES = COMMANDS.with_name("commands_bodies.yaml")
MODELS = ("qwen2.5-coder-0.5b-instruct", "qwen2.5-coder-1.5b-instruct", "smollm2-135m-instruct")

LISTED_FROM = 0.5
"""Of a model that gets less than this right, the misses are not worth listing."""


@dataclass(frozen=True, slots=True)
class Command:
    """One line of the data: an utterance and what it should do."""

    category: str
    says: str
    by: str
    calls: tuple[Call, ...]


@dataclass(frozen=True, slots=True)
class Outcome:
    """What became of a command. `pieces` are about as many as tokens."""

    command: Command
    calls: tuple[Call, ...]
    words: str
    seconds: float
    pieces: int
    invalid: str = ""

    @property
    def right(self) -> bool:
        return not self.invalid and self.calls == self.command.calls


def read_commands(file: Path = COMMANDS) -> list[Command]:
    """The data, in its order."""
    data = yaml.safe_load(file.read_text(encoding="utf-8"))
    return [
        Command(category, one["says"], one["by"], tuple(_calls(one["calls"])))
        for category, several in data.items()
        for one in several
    ]


def apartment_skills() -> SkillSet:
    """What the robot of the apartment can do."""
    return SkillSet(ApartmentRobot().skills)


class Nobody:
    """Stands where a body would: its skills are spoken of and never run."""


def skills_of_bodies() -> Mapping[str, SkillSet]:
    """What the arm and the humanoid can do, by the names of their robots."""
    nobody: Any = Nobody()
    return {
        "robot-panda": SkillSet(manipulation_skills(nobody)),
        "robot-humanoid": SkillSet(walking_skills(nobody)),
    }


def through_templates(skills: SkillSet, commands: Iterable[Command]) -> list[Outcome]:
    """What the templates make of these commands."""
    recogniser = Recogniser(skills)
    outcomes = []
    for command in commands:
        started = time.perf_counter()
        found = recogniser.recognise(command.says)
        taken = time.perf_counter() - started
        calls = found.calls if isinstance(found, Understood) else ()
        outcomes.append(_judge(skills, command, calls, seconds=taken))
    return outcomes


def through_model(
    skills: SkillSet,
    model: LanguageModel,
    commands: Iterable[Command],
    instructions: str = INSTRUCTIONS,
) -> list[Outcome]:
    """What a model makes of these commands, each in a chat of its own."""
    protocol = Protocol(instructions, skills)
    model.prime(protocol.opening, CancelToken())
    outcomes = []
    for command in commands:
        parser = protocol.parser()
        said, pieces = "", 0
        chat = [*protocol.opening, Message("user", protocol.prepare(command.says))]
        started = time.perf_counter()
        for piece in model.generate(
            chat, grammar=protocol.grammar, max_tokens=ANSWER_TOKENS, token=CancelToken()
        ):
            said += parser.feed(piece)
            pieces += 1
        taken = time.perf_counter() - started
        outcomes.append(
            _judge(skills, command, parser.finish(), said, seconds=taken, pieces=pieces)
        )
    return outcomes


def bodies_through_model(model: LanguageModel) -> list[Outcome]:
    """What a model makes of what is said freely to the arm and to the humanoid."""
    commands = read_commands(COMMANDS_OF_BODIES)
    return [
        outcome
        for robot, skills in skills_of_bodies().items()
        for outcome in through_model(
            skills,
            model,
            [c for c in commands if c.category == robot],
            ROBOTS[robot].instructions,
        )
    ]


def share_right(outcomes: Sequence[Outcome]) -> float:
    """0 to 1."""
    return sum(one.right for one in outcomes) / len(outcomes)


def _judge(
    skills: SkillSet,
    command: Command,
    calls: Iterable[Call],
    words: str = "",
    *,
    seconds: float,
    pieces: int = 0,
) -> Outcome:
    made = tuple(calls)
    try:
        checked = tuple(Call(c.skill, skills[c.skill].validate(c.arguments)) for c in made)
    except InvalidValue as error:
        return Outcome(command, made, words, seconds, pieces, str(error))
    invalid = "" if made or words or pieces == 0 else "neither words nor calls"
    return Outcome(command, checked, words, seconds, pieces, invalid)


def _calls(data: Iterable[Mapping[str, Mapping[str, Any]]]) -> Iterable[Call]:
    return (Call(name, dict(arguments)) for one in data for name, arguments in one.items())


def _table(columns: Mapping[str, Sequence[Outcome]]) -> str:
    """Rows are categories, columns are who understood; cells are right of all."""
    categories = list(dict.fromkeys(o.command.category for c in columns.values() for o in c))
    rows = [["category", *columns], ["---", *("---:" for _ in columns)]]
    for category in [*categories, "**all**"]:
        cells = []
        for outcomes in columns.values():
            chosen = [o for o in outcomes if category in ("**all**", o.command.category)]
            cells.append(f"{sum(o.right for o in chosen)} of {len(chosen)}" if chosen else "")
        rows.append([category, *cells])
    every = columns.values()
    rows.append(["share right", *(f"{share_right(c):.0%}" for c in every)])
    rows.append(["invalid calls", *(str(sum(bool(o.invalid) for o in c)) for c in every)])
    rows.append(["median", *(_duration(statistics.median(o.seconds for o in c)) for c in every)])
    rows.append(["tokens/s, with reading the utterance", *(_speed(c) for c in every)])
    return "\n".join(f"| {' | '.join(row)} |" for row in rows)


def _duration(seconds: float) -> str:
    return f"{1000 * seconds:.1f} ms" if seconds < 0.1 else f"{seconds:.2f} s"


def _speed(outcomes: Sequence[Outcome]) -> str:
    pieces = sum(o.pieces for o in outcomes)
    return f"{pieces / sum(o.seconds for o in outcomes):.0f}" if pieces else ""


def _misses(columns: Mapping[str, Sequence[Outcome]]) -> str:
    lines = []
    for name, outcomes in columns.items():
        if share_right(outcomes) < LISTED_FROM:
            lines += [f"\n{name}: most of it."]
            continue
        lines += [f"\n{name}:\n"]
        for one in outcomes:
            if not one.right:
                did = "; ".join(f"{c.skill}({dict(c.arguments)})" for c in one.calls)
                lines.append(f'- "{one.command.says}": {did or one.words or "nothing"}')
    return "\n".join(lines)


Columns = dict[str, list[Outcome]]


def _measure(models: Sequence[str], backends: Sequence[str]) -> tuple[Columns, Columns]:
    """In the apartment, and of the other bodies; by who understood."""
    skills, commands = apartment_skills(), read_commands()
    promised = [c for c in commands if c.by == "template"]
    others = [c for c in commands if c.by == "model"]
    columns: Columns = {"templates": through_templates(skills, promised)}
    bodies: Columns = {}
    for identifier in models:
        for backend in backends:
            try:
                model = load_model(locate(identifier), backend)  # type: ignore[arg-type]
            except (ModelFailed, ModelMissing) as error:
                print(f"{identifier} on {backend}: left out: {error}")
                continue
            print(f"{identifier} on {backend} ...", flush=True)
            columns[f"{identifier}, {backend}"] = through_model(skills, model, others)
            bodies[f"{identifier}, {backend}"] = bodies_through_model(model)
            model.close()
    return columns, bodies


def main() -> None:
    """Measure and write."""
    arguments = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    arguments.add_argument("--models", nargs="*", default=MODELS)
    arguments.add_argument("--backends", nargs="*", default=["xllamacpp", "llama-cpp-python"])
    arguments.add_argument("--output", type=Path, default=ROOT / "benchmarks" / "understanding.md")
    given = arguments.parse_args()
    columns, bodies = _measure(given.models, given.backends)
    given.output.write_text(
        "# What is understood\n\n"
        "Written by `benchmarks/understanding.py`. A command is right when exactly the right calls "
        'come out with the right arguments, or none where none is due. "held out" was never '
        "looked at while the prompt was being worded.\n\n"
        f"Measured on {machine()}.\n\n{_table(columns)}\n\n"
        f"## What went wrong\n{_misses(columns)}\n\n"
        "## Other bodies\n\nFree and indirect sentences to the arm and to the humanoid, from "
        "`tests/models/commands_bodies.yaml`, all of them held out.\n\n"
        f"{_table(bodies)}\n{_misses(bodies)}\n",
        encoding="utf-8",
    )
    print(_table(columns), _table(bodies), sep="\n\n")


if __name__ == "__main__":
    main()
