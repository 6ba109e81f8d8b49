"""How much of what people say is understood, by templates and by models.

Runs every command of `tests/models/commands.yaml`: those that the templates promise through the
templates, all others through each model; and what is said freely to the arm and to the humanoid,
from `commands_bodies.yaml`. A command is right when exactly the right calls come out with the right
arguments, or none where none is due. "held out" was never looked at while the prompt was being
worded.
"""

import sys
import time
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import yaml
from figures import Figure, Measured, NotHere

from edgevox.agent.arguments import check_arguments
from edgevox.agent.intents import Recogniser, Understood
from edgevox.agent.llm.base import LanguageModel, Message, ModelFailed
from edgevox.agent.llm.factory import load_model
from edgevox.agent.mind import ANSWER_TOKENS
from edgevox.agent.skills import Call, SkillSet
from edgevox.agent.toolcalls import Protocol
from edgevox.apps.robots import ROBOTS
from edgevox.core.cancel import CancelToken
from edgevox.core.errors import InvalidValue
from edgevox.models import ModelMissing, locate
from edgevox.robots.apartment import ApartmentRobot
from edgevox.robots.humanoid.skills import walking_skills
from edgevox.robots.panda.skills import manipulation_skills
from edgevox.robots.plugin import INSTRUCTIONS

ROOT = Path(__file__).parents[1]
COMMANDS = ROOT / "tests" / "models" / "commands.yaml"
COMMANDS_OF_BODIES = COMMANDS.with_name("commands_bodies.yaml")
THINKERS = {
    "qwen-0.5b": ("qwen2.5-coder-0.5b-instruct", "xllamacpp"),
    "qwen-0.5b-llama-cpp-python": ("qwen2.5-coder-0.5b-instruct", "llama-cpp-python"),
    "qwen-1.5b": ("qwen2.5-coder-1.5b-instruct", "xllamacpp"),
    "smollm2-135m": ("smollm2-135m-instruct", "xllamacpp"),
}
"""Each with the engine that runs it: one of them on the other, to see that they agree."""
APARTMENT = "What is understood in the apartment"
BODIES = "What is understood by the arm and the humanoid"
ALL = "all"

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
        # Whether a point lies in the world is no matter of understanding.
        checked = tuple(
            Call(c.skill, check_arguments(c.skill, skills[c.skill].arguments_model, c.arguments))
            for c in made
        )
    except InvalidValue as error:
        return Outcome(command, made, words, seconds, pieces, str(error))
    invalid = "" if made or words or pieces == 0 else "neither words nor calls"
    return Outcome(command, checked, words, seconds, pieces, invalid)


def _calls(data: Iterable[Mapping[str, Mapping[str, Any]]]) -> Iterable[Call]:
    return (Call(name, dict(arguments)) for one in data for name, arguments in one.items())


def measure(quick: bool = False) -> Measured:
    """The templates, then one model after the other."""
    skills, commands = apartment_skills(), read_commands()
    promised = [c for c in commands if c.by == "template"]
    others = [c for c in commands if c.by == "model"]
    found = through_templates(skills, promised)
    figures = list(_figures("templates", APARTMENT, "templates", found))
    notes = _misses("templates", found)
    for name, (identifier, backend) in THINKERS.items():
        try:
            model = load_model(locate(identifier), backend)  # type: ignore[arg-type]
        except (ModelFailed, ModelMissing) as error:
            raise NotHere(f"{identifier} on {backend}: {error}") from error
        print(f"  {identifier} on {backend} ...", flush=True)
        column = f"{identifier}, {backend}"
        found = through_model(skills, model, others[::8] if quick else others)
        figures += _figures(name, APARTMENT, column, found)
        notes |= _misses(column, found)
        if not quick:
            found = bodies_through_model(model)
            figures += _figures(f"{name}.bodies", BODIES, column, found)
            notes |= _misses(f"{column}, other bodies", found)
        model.close()
    return Measured(figures=tuple(figures), notes=notes)


def _figures(name: str, table: str, column: str, outcomes: Sequence[Outcome]) -> Iterator[Figure]:
    """How many of each category are right, and how long one took."""
    categories = dict.fromkeys(one.command.category for one in outcomes)
    for category in (*categories, ALL):
        chosen = [one for one in outcomes if category in (ALL, one.command.category)]
        yield Figure(
            id=f"{name}.{category.replace(' ', '_')}",
            table=table,
            what=category,
            column=column,
            unit="right",
            value=sum(one.right for one in chosen),
            n=len(chosen),
            more_is_better=True,
        )
    invalid = sum(bool(one.invalid) for one in outcomes)
    yield Figure(
        id=f"{name}.invalid", table=table, what="invalid calls", column=column, value=invalid,
        wanted=0,
    )  # fmt: skip
    samples = [one.seconds for one in outcomes]
    yield Figure.of(f"{name}.time", table, "time to decide", samples, "s", column=column)
    pieces = sum(one.pieces for one in outcomes)
    if pieces:
        yield Figure.of(
            f"{name}.rate", table, "speed, with reading the utterance", [pieces / sum(samples)],
            "tokens/s", column=column, more_is_better=True,
        )  # fmt: skip


def _misses(column: str, outcomes: Sequence[Outcome]) -> dict[str, tuple[str, ...]]:
    """What went wrong, if that is worth listing."""
    wrong = [one for one in outcomes if not one.right]
    if not wrong:
        return {}
    if share_right(outcomes) < LISTED_FROM:
        return {f"What went wrong with {column}": ("most of it",)}
    return {
        f"What went wrong with {column}": tuple(
            f'"{one.command.says}": {_deed(one)}' for one in wrong
        )
    }


def _deed(outcome: Outcome) -> str:
    calls = "; ".join(f"`{c.skill}({dict(c.arguments)})`" for c in outcome.calls)
    return calls or outcome.words.strip() or "nothing"


def main() -> int:
    """Say how much a model of one's own understands: its id or its GGUF file."""
    try:
        (given,) = sys.argv[1:]
        path = Path(given) if given.endswith(".gguf") else locate(given)
        model = load_model(path)
    except (ValueError, ModelFailed, ModelMissing) as error:
        print(f"usage: understanding.py MODEL: {error}", file=sys.stderr)
        return 2
    others = [command for command in read_commands() if command.by == "model"]
    found = [*through_model(apartment_skills(), model, others), *bodies_through_model(model)]
    model.close()
    print(f"{sum(one.right for one in found)} of {len(found)} right; not:")
    for lines in _misses(path.stem, found).values():
        print(*lines, sep="\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
