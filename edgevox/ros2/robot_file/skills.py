"""The skills of a robot file, from the file to the graph."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from hassil.parse_expression import parse_sentence
from hassil.parser import ParseError
from rclpy.node import Node

from edgevox.agent.phrases.load import ENGLISH, phrasebook
from edgevox.agent.skills import GoalHandle, Result, Skill, SkillFailed, SkillPhrases
from edgevox.agent.text.reasons import because as agent_because
from edgevox.core.clock import Clock
from edgevox.core.files.validation import Place
from edgevox.core.files.yaml_file import YamlFile
from edgevox.core.languages import LANGUAGES
from edgevox.core.log import get_logger
from edgevox.core.reason import Reason
from edgevox.ros2.robot_file.arguments import (
    arguments_model,
    check_words,
    every_language,
    meanings,
    values_in,
)
from edgevox.ros2.robot_file.format import RobotFile, Sentences, SkillEntry
from edgevox.ros2.robot_file.live import LiveSkill, Watch, go_live, run_skill
from edgevox.ros2.robot_file.messages import InterfaceMissing, arguments_in
from edgevox.ros2.robot_file.plan import PlannedStep, Planner
from edgevox.ros2.robot_file.steps import Step

log = get_logger(__name__)


@dataclass(eq=False)
class DescribedSkill:
    """A file's entry with its checked steps; call `open` before it is run."""

    name: str
    entry: SkillEntry
    steps: list[PlannedStep]
    stop: PlannedStep | None
    watches: list[PlannedStep]
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
        english = words_of(self.name, entry, entry, ENGLISH)
        return Skill(
            name=self.name,
            description=entry.description,
            function=self.run,
            arguments_model=arguments_model(self.name, entry.arguments),
            templates=english.templates,
            says=entry.says,
            done=english.done[0],
            action=entry.asks,
            moves=entry.uses_the_body,
            confirm=entry.confirm,
            phrases={code: words_of(self.name, entry, said.get(code), code) for code in LANGUAGES},
        )

    def run(self, goal: GoalHandle, **arguments: Any) -> Result:
        """Do all steps, one after another. Raises `SkillFailed`, or `Cancelled`."""
        live = self._live
        if live is None:
            raise SkillFailed(agent_because("switched_off"))
        try:
            return run_skill(live, goal, meanings(self.entry.arguments, arguments))
        except SkillFailed as error:
            raise SkillFailed(self._reason(error.reason)) from error

    def _reason(self, found: Reason) -> Reason:
        """Return the failure in the file's words, if it has some, in its languages."""
        if not self.entry.failed:
            return found
        told = {code: one.failed for code, one in self.entry.languages.items() if one.failed}
        return Reason(
            self.entry.failed, found.code, found.values, {ENGLISH: self.entry.failed, **told}
        )


def words_of(name: str, entry: SkillEntry, said: Sentences | None, code: str) -> SkillPhrases:
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
        words=said.words,
    )


@dataclass(frozen=True, slots=True)
class SkillOff:
    """A skill that is off, and the missing type."""

    name: str
    reason: str


def described_skills(robot: RobotFile, file: YamlFile) -> list[DescribedSkill]:
    """Return a file's skills; one with a missing type is left out, and reported by name.

    Raises `InvalidValue` naming file, line and field.
    """
    found = []
    for one in planned_skills(robot, file):
        if isinstance(one, SkillOff):
            log.warning("skill_off", skill=one.name, reason=one.reason)
        else:
            found.append(one)
    return found


def planned_skills(robot: RobotFile, file: YamlFile) -> Iterator[DescribedSkill | SkillOff]:
    """Every skill of a file, or why it is off. Raises `InvalidValue` as `described_skills`."""
    for name, entry in robot.skills.items():
        place: Place = ("skills", name)
        _check_sentences(entry, file, place)
        try:
            yield _planned(name, entry, file, place)
        except InterfaceMissing as error:
            yield SkillOff(name, str(error))


def _planned(name: str, entry: SkillEntry, file: YamlFile, place: Place) -> DescribedSkill:
    planner = Planner(entry.arguments, file)
    steps = [
        planner.plan(step, (*place, "steps", index) if entry.steps else place)
        for index, step in enumerate(entry.every_step)
    ]
    _check_answers(entry, planner.results, file, place)
    check_words(entry, planner.results, file, place)
    # What is done at a stop cannot use results, which may not be known by then.
    stop = Planner(entry.arguments, file).plan(entry.stop, (*place, "stop")) if entry.stop else None
    watches = [
        Planner({}, file).plan_watch(one, (*place, "stops_on", index))
        for index, one in enumerate(entry.stops_on)
    ]
    used = frozenset().union(*map(_named_by, entry.every_step))
    if idle := entry.arguments.keys() - used:
        at = (*place, "arguments", min(idle))
        raise file.wrong(at, min(idle), "an argument that a request takes, as {" + min(idle) + "}")
    return DescribedSkill(name, entry, steps, stop, watches)


def _named_by(step: Step) -> frozenset[str]:
    """The arguments that a step's request and its conditions name."""
    return arguments_in([step.request, [one.equals for one in step.conditions]])


def _check_sentences(entry: SkillEntry, file: YamlFile, place: Place) -> None:
    for at, said in every_language(entry, place):
        for index, sentence in enumerate(said.sentences):
            try:
                parse_sentence(sentence)
            except (ParseError, ValueError) as error:
                raise file.wrong(
                    (*at, "sentences", index), sentence, f"a template ({error})"
                ) from None
            if unknown := arguments_in(sentence) - entry.arguments.keys():
                expected = "an argument: one of " + (", ".join(entry.arguments) or "none")
                raise file.wrong((*at, "sentences", index), min(unknown), expected)


def _check_answers(entry: SkillEntry, known: Mapping[str, str], file: YamlFile, at: Place) -> None:
    """Check that start sentences name only arguments, and end sentences also results."""
    for place, said in every_language(entry, at):
        for name, values in (
            ("says", entry.arguments.keys()),
            ("asks", entry.arguments.keys()),
            ("done", {*entry.arguments, *known}),
        ):
            text = getattr(said, name)
            try:
                unknown = values_in(text) - values
            except ValueError as error:
                expected = f"values in pairs of braces ({error})"
                raise file.wrong((*place, name), text, expected) from None
            if unknown:
                expected = "a value that is known then: " + (", ".join(sorted(values)) or "none")
                raise file.wrong((*place, name), min(unknown), expected)
