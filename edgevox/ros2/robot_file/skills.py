"""The skills of a robot file, from the file to the graph."""

from collections.abc import Mapping, Sequence, Set
from dataclasses import dataclass, field
from pathlib import Path
from types import MappingProxyType
from typing import Any

from hassil.parse_expression import parse_sentence
from hassil.parser import ParseError
from rclpy.node import Node

from edgevox.agent.phrases.load import ENGLISH, phrasebook
from edgevox.agent.skills import GoalHandle, Result, Skill, SkillFailed, SkillPhrases
from edgevox.agent.text.reasons import because as agent_because
from edgevox.core.cancel import CancelToken
from edgevox.core.clock import Clock
from edgevox.core.errors import InvalidValue
from edgevox.core.files.validation import Place, Problems
from edgevox.core.files.yaml_file import YamlFile
from edgevox.core.languages import LANGUAGES
from edgevox.robots.names import check_thing
from edgevox.ros2.clients import interface_reason
from edgevox.ros2.robot_file.arguments import (
    REASON,
    arguments_model,
    by_value,
    check_words,
    every_language,
    every_language_at,
    failure_of,
    meanings,
    values_in,
)
from edgevox.ros2.robot_file.format import Sentences, SkillEntry
from edgevox.ros2.robot_file.live import LiveSkill, StepFailed, Watch, go_live, run_skill
from edgevox.ros2.robot_file.load import DescribedRobot, read_robot_file
from edgevox.ros2.robot_file.messages import InterfaceMissing, arguments_in
from edgevox.ros2.robot_file.plan import PlannedStep, Planner
from edgevox.ros2.robot_file.state import NO_STATES, RobotStates, planned_states, questions
from edgevox.ros2.robot_file.steps import Step


@dataclass(eq=False)
class DescribedSkill:
    """A file's entry with its checked steps; call `open` before it is run."""

    name: str
    entry: SkillEntry
    steps: list[PlannedStep]
    stop: PlannedStep | None
    watches: list[PlannedStep]
    constants: Mapping[str, Mapping[str, Any]] = field(default_factory=dict)
    """The constants by which the file may call the values of results, by the results' names."""
    states: RobotStates = NO_STATES
    _live: LiveSkill | None = None

    def open(self, node: Node, clock: Clock) -> None:
        """Join the graph with the interfaces of its steps."""
        self._live = LiveSkill(
            self.name,
            [go_live(one, node, clock) for one in self.steps],
            go_live(self.stop, node, clock) if self.stop else None,
            [Watch(one, node, clock) for one in self.watches],
            clock,
        )

    def close(self) -> None:
        """The node is gone; a run that still goes on ends by its token."""
        self._live = None

    def skill(self) -> Skill:
        """Return the skill in the agent's form."""
        entry = self.entry
        said = {ENGLISH: entry, **entry.languages}
        by_code = {
            code: words_of(self.name, entry, said.get(code), code, self.constants)
            for code in LANGUAGES
        }
        english = by_code[ENGLISH]
        return Skill(
            name=self.name,
            description=entry.description,
            function=self.run,
            ready=self.ready,
            arguments_model=arguments_model(self.name, entry.arguments),
            templates=english.templates,
            says=entry.says,
            done=english.done[0],
            action=entry.asks,
            moves=entry.uses_the_body,
            confirm=entry.confirm,
            undoable=entry.undoable,
            brief=entry.is_brief,
            phrases=by_code,
        )

    def ready(self, token: CancelToken, most_s: float, /, **arguments: Any) -> None:
        """Look whether it has what it needs, and whether its first step finds its interface."""
        live = self._switched_on()
        self.states.check(self.entry.needs, token, most_s)
        try:
            live.steps[0].until_there(token, most_s)
        except SkillFailed as error:
            found = failure_of(self.entry, error.reason, arguments, self.constants)
            raise SkillFailed(found) from error

    def _switched_on(self) -> LiveSkill:
        if self._live is None:
            raise SkillFailed(agent_because("switched_off"))
        return self._live

    def run(self, goal: GoalHandle, **arguments: Any) -> Result:
        """Do all steps, one after another. Raises `SkillFailed`, or `Cancelled`."""
        live = self._switched_on()
        self.states.check(self.entry.needs, goal.token)
        try:
            results = run_skill(live, goal, meanings(self.entry.arguments, arguments))
            self._check_said(results)
        except StepFailed as error:
            values = {**arguments, **error.values}
            found = failure_of(self.entry, error.reason, values, self.constants)
            raise SkillFailed(found) from error
        return results

    def _check_said(self, results: Mapping[str, Any]) -> None:
        """Raise `StepFailed` if a result that `done` says is missing, or an empty list."""
        said = set().union(*(values_in(one.done) for one in every_language(self.entry)))
        for step in self.steps:
            for name in step.step.values:
                if name in said and results.get(name) in (None, []):
                    reason = interface_reason("unheard", what=step.interface_name)
                    raise StepFailed(reason, results)


def words_of(
    name: str,
    entry: SkillEntry,
    said: Sentences | None,
    code: str,
    constants: Mapping[str, Mapping[str, Any]] = MappingProxyType({}),
) -> SkillPhrases:
    """Return the skill's phrases in a language: the file's, else made from its name."""
    said = said or Sentences()
    needed = [key for key, one in entry.arguments.items() if one.default is None]
    plain = " ".join([name.replace("_", " "), *("{" + key + "}" for key in needed)])
    made = (f"[please] {plain} [please]",) if code == ENGLISH else ()
    return SkillPhrases(
        can=said.can,
        actions=(said.asks,) if said.asks else (),
        templates=tuple(said.sentences) or made,
        says=(said.says,) if said.says else (),
        done=(said.done or phrasebook(code).say("program_done"),),
        arguments=said.argument_names,
        words=by_value(said.words, constants),
    )


@dataclass(frozen=True, slots=True)
class LoadedFile:
    """A robot file with what its interfaces' types make of it."""

    described: DescribedRobot
    skills: Sequence[DescribedSkill] = ()
    states: RobotStates = NO_STATES
    off: Mapping[str, str] = field(default_factory=dict)
    """The skills and states whose types are missing, each with the reason."""


def load_described(path: Path) -> LoadedFile:
    """Read and check a file, its skills and its states.

    Raises `InvalidValue` with all that is wrong, each with file, line and field.
    """
    described, problems = read_robot_file(path)
    robot, file = described.robot, described.file
    planned, off_states = planned_states(robot, file, problems)
    states = RobotStates(planned, robot.needs)
    off = {("state", name): reason for name, reason in off_states.items()}
    skills = []
    for name, entry in robot.skills.items():
        place: Place = ("skills", name)
        _check_names(name, entry, file, place, problems)
        _check_sentences(entry, file, place, problems)
        try:
            skills.append(_planned(name, entry, file, place, problems))
        except InterfaceMissing as error:
            off["skills", name] = str(error)
    for name, entry in questions(robot, planned).items():
        place = ("state", name)
        _check_names(name, entry, file, place, problems)
        _check_sentences(entry, file, place, problems)
        skills.append(_planned(name, entry, file, place, problems))
    if problems.found:
        problems.found += [
            file.wrong(at, at[-1], f"types that are there: {reason}") for at, reason in off.items()
        ]
    problems.tell()
    for one in skills:
        one.states = states
    return LoadedFile(described, skills, states, {at[-1]: one for at, one in off.items()})


def _planned(
    name: str, entry: SkillEntry, file: YamlFile, place: Place, problems: Problems
) -> DescribedSkill:
    planner = Planner(entry.arguments, file, problems)
    steps = [
        planner.plan(step, (*place, "steps", index) if entry.steps else place)
        for index, step in enumerate(entry.every_step)
    ]
    _check_answers(entry, planner.results, file, place, problems)
    check_words(entry, planner, file, place, problems)
    # What is done at a stop cannot use results, which may not be known by then.
    alone = Planner(entry.arguments, file, problems)
    stop = alone.plan(entry.stop, (*place, "stop")) if entry.stop else None
    watches = [
        Planner({}, file, problems).plan_watch(one, (*place, "stops_on", index))
        for index, one in enumerate(entry.stops_on)
    ]
    used = frozenset().union(*map(_named_by, entry.every_step))
    for idle in sorted(entry.arguments.keys() - used):
        expected = "an argument that a request takes, as {" + idle + "}"
        problems.found.append(file.wrong((*place, "arguments", idle), idle, expected))
    return DescribedSkill(name, entry, steps, stop, watches, planner.constants)


def _check_names(
    name: str, entry: SkillEntry, file: YamlFile, place: Place, problems: Problems
) -> None:
    """Find names of skills and words that people need for something else, as a stop."""
    named: list[tuple[Place, str]] = [(place, name)]
    for argument, one in entry.arguments.items():
        at = (*place, "arguments", argument)
        named += [((*at, "values"), word) for word in one.meanings]
        named += [((*at, "aliases", word), word) for word in one.aliases]
    for where, word in named:
        try:
            check_thing("", word)
        except InvalidValue as error:
            problems.found.append(file.wrong(where, word, error.expected))


def _named_by(step: Step) -> frozenset[str]:
    """The arguments that a step's request, its conditions and its paths name."""
    paths = [one.field for one in step.conditions] + [one.field for one in step.values.values()]
    return arguments_in([step.request, paths, [one.equals for one in step.conditions]])


def _check_sentences(entry: SkillEntry, file: YamlFile, place: Place, problems: Problems) -> None:
    for at, said in every_language_at(entry, place):
        for index, sentence in enumerate(said.sentences):
            with problems.collect():
                _check_sentence(entry, sentence, file, (*at, "sentences", index))


def _check_sentence(entry: SkillEntry, sentence: str, file: YamlFile, at: Place) -> None:
    try:
        parse_sentence(sentence)
    except (ParseError, ValueError) as error:
        raise file.wrong(at, sentence, f"a template ({error})") from None
    if unknown := arguments_in(sentence) - entry.arguments.keys():
        expected = "an argument: one of " + (", ".join(entry.arguments) or "none")
        raise file.wrong(at, min(unknown), expected)


def _check_answers(
    entry: SkillEntry, known: Mapping[str, str], file: YamlFile, at: Place, problems: Problems
) -> None:
    """Check that start sentences name only arguments, and end sentences also results."""
    ended = {*entry.arguments, *known}
    for place, said in every_language_at(entry, at):
        for name, values in (
            ("says", entry.arguments.keys()),
            ("asks", entry.arguments.keys()),
            ("done", ended),
            ("failed", ended | {REASON}),
        ):
            with problems.collect():
                _check_values(getattr(said, name), values, file, (*place, name))


def _check_values(text: str, values: Set[str], file: YamlFile, at: Place) -> None:
    try:
        unknown = values_in(text) - values
    except ValueError as error:
        expected = f"values in pairs of braces ({error})"
        raise file.wrong(at, text, expected) from None
    if unknown:
        expected = "a value that is known then: " + (", ".join(sorted(values)) or "none")
        raise file.wrong(at, min(unknown), expected)
