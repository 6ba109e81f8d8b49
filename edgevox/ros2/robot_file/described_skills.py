"""The skills that a robot file describes, from the file to the graph."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

from hassil.parse_expression import parse_sentence
from hassil.parser import ParseError
from rclpy.node import Node

from edgevox.agent.phrase_file import ENGLISH, phrasebook
from edgevox.agent.reasons import because as agent_because
from edgevox.agent.skills import GoalHandle, Result, Skill, SkillFailed, SkillPhrases
from edgevox.core.cancel import Cancelled, CancelToken
from edgevox.core.clock import Clock
from edgevox.core.languages import LANGUAGES
from edgevox.core.log import get_logger
from edgevox.core.reason import Reason
from edgevox.core.validation import Place
from edgevox.core.yaml_file import YamlFile
from edgevox.ros2.robot_file.argument_models import arguments_model, meanings
from edgevox.ros2.robot_file.filling import arguments_in
from edgevox.ros2.robot_file.interfaces import InterfaceMissing
from edgevox.ros2.robot_file.live import LiveStep, StepRun, go_live
from edgevox.ros2.robot_file.plan import PlannedStep, Planner
from edgevox.ros2.robot_file.robot_file_format import RobotFile, Sentences, SkillEntry, Step

log = get_logger(__name__)


@dataclass(eq=False)
class DescribedSkill:
    """One entry of the file with its checked steps; `open` it on a node before it is run."""

    name: str
    entry: SkillEntry
    steps: list[PlannedStep]
    stop: PlannedStep | None
    _live: list[LiveStep] = field(default_factory=list)
    _live_stop: LiveStep | None = None
    _clock: Clock | None = None

    def open(self, node: Node, clock: Clock) -> None:
        """Join the graph with what it needs."""
        self._clock = clock
        self._live = [go_live(one, node, clock) for one in self.steps]
        self._live_stop = go_live(self.stop, node, clock) if self.stop else None

    def close(self) -> None:
        """The node is gone; a run that still goes on ends by its token."""
        self._live, self._live_stop = [], None

    def skill(self) -> Skill:
        """As the agent takes it."""
        entry = self.entry
        english = _words(self.name, entry, entry, ENGLISH)
        return Skill(
            name=self.name,
            description=entry.description,
            function=self.run,
            arguments_model=arguments_model(self.name, entry.arguments),
            templates=english.templates,
            says=entry.says,
            done=english.done[0],
            moves=entry.uses_the_body,
            phrases={
                code: _words(self.name, entry, entry.languages.get(code), code)
                for code in LANGUAGES
            },
        )

    def run(self, goal: GoalHandle, **arguments: Any) -> Result:
        """Do all steps, one after another. Raises `SkillFailed`, or `Cancelled`."""
        live, clock = self._live, self._clock
        if not live or clock is None:
            raise SkillFailed(agent_because("switched_off"))
        results: dict[str, Any] = {}
        values = meanings(self.entry.arguments, arguments)
        asked_s: float | None = None
        try:
            for step in live:
                goal.token.check()
                run = StepRun({**values, **results}, goal.token, goal.report, asked_s)
                asked_s = clock.now()
                results |= step.run(run)
        except Cancelled:
            self._stop({**values, **results})
            raise
        except SkillFailed as error:
            raise SkillFailed(self._reason(error.reason)) from error
        return results

    def _stop(self, values: Mapping[str, Any]) -> None:
        if self._live_stop is None:
            return
        try:
            self._live_stop.run(StepRun(values, CancelToken(), lambda **_: None))
        except SkillFailed as error:
            log.error("stop_step_failed", skill=self.name, reason=str(error))  # noqa: TRY400

    def _reason(self, found: Reason) -> Reason:
        """What the file says of a failure, in the languages that it speaks."""
        if not self.entry.failed:
            return found
        told = {code: one.failed for code, one in self.entry.languages.items() if one.failed}
        return Reason(
            self.entry.failed, found.code, found.values, {ENGLISH: self.entry.failed, **told}
        )


def described_skills(robot: RobotFile, file: YamlFile) -> list[DescribedSkill]:
    """The skills of a file; one whose types are not there is left out, and told by name.

    Raises `InvalidValue` naming file, line and field.
    """
    found = []
    for name, entry in robot.skills.items():
        place: Place = ("skills", name)
        _check_sentences(entry, file, place)
        try:
            found.append(_planned(name, entry, file, place))
        except InterfaceMissing as error:
            log.warning("skill_off", skill=name, reason=str(error))
    return found


def _planned(name: str, entry: SkillEntry, file: YamlFile, place: Place) -> DescribedSkill:
    planner = Planner(entry.arguments, file)
    steps = [
        planner.plan(step, (*place, "steps", index) if entry.steps else place)
        for index, step in enumerate(entry.every_step)
    ]
    _check_answers(entry, planner.results, file, place)
    stop = planner.plan(entry.stop, (*place, "stop")) if entry.stop else None
    used = frozenset().union(*map(_named_by, entry.every_step))
    if idle := entry.arguments.keys() - used:
        at = (*place, "arguments", min(idle))
        raise file.wrong(at, min(idle), "an argument that a request takes, as {" + min(idle) + "}")
    return DescribedSkill(name, entry, steps, stop)


def _named_by(step: Step) -> frozenset[str]:
    """The arguments that a step's request and its conditions name."""
    return arguments_in([step.request, [one.equals for one in step.conditions]])


def _every_language(entry: SkillEntry, at: Place) -> Iterator[tuple[Place, Sentences]]:
    """What is said of a skill that stands `at` this place, English first, each with its place."""
    yield at, entry
    for code, said in entry.languages.items():
        yield (*at, "languages", code), said


def _check_sentences(entry: SkillEntry, file: YamlFile, place: Place) -> None:
    for at, said in _every_language(entry, place):
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
    """What is said at the start knows the arguments, what is said at the end the results, too."""
    for place, said in _every_language(entry, at):
        for name, values in (
            ("says", entry.arguments.keys()),
            ("done", {*entry.arguments, *known}),
        ):
            if unknown := arguments_in(getattr(said, name)) - values:
                expected = "a value that is known then: " + (", ".join(sorted(values)) or "none")
                raise file.wrong((*place, name), min(unknown), expected)


def _words(name: str, entry: SkillEntry, said: Sentences | None, code: str) -> SkillPhrases:
    """What is said of it in a language: what the file says, or what is made of its name."""
    said = said or Sentences()
    needed = [key for key, one in entry.arguments.items() if one.default is None]
    plain = " ".join([name.replace("_", " "), *("{" + key + "}" for key in needed)])
    made = (f"[please] {plain} [please]",) if code == ENGLISH else ()
    return SkillPhrases(
        can=said.can,
        templates=tuple(said.sentences) or made,
        says=(said.says,) if said.says else (),
        done=(said.done or phrasebook(code).say("program_done"),),
    )
