"""The skills that a robot file describes, from the file to the graph."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from hassil.parse_expression import parse_sentence
from hassil.parser import ParseError

from edgevox.core.log import get_logger
from edgevox.core.validation import Place
from edgevox.core.yaml_file import YamlFile
from edgevox.ros2.robot_file.described_skill import DescribedSkill
from edgevox.ros2.robot_file.filling import arguments_in
from edgevox.ros2.robot_file.interfaces import InterfaceMissing
from edgevox.ros2.robot_file.plan import Planner
from edgevox.ros2.robot_file.robot_file_format import RobotFile, SkillEntry
from edgevox.ros2.robot_file.said_values import check_words, every_language, values_in
from edgevox.ros2.robot_file.step_format import Step

log = get_logger(__name__)


@dataclass(frozen=True, slots=True)
class SkillOff:
    """A skill whose types are not there, and which."""

    name: str
    reason: str


def described_skills(robot: RobotFile, file: YamlFile) -> list[DescribedSkill]:
    """The skills of a file; one whose types are not there is left out, and told by name.

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
    """What is said at the start knows the arguments, what is said at the end the results, too."""
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
