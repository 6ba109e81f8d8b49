"""A step of the file with the types that it needs: checked before the robot is started."""

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from builtin_interfaces.msg import Time

from edgevox.core.errors import InvalidValue
from edgevox.core.files.validation import Place, Problems
from edgevox.core.files.yaml_file import YamlFile
from edgevox.ros2.clients import STEERING, type_name
from edgevox.ros2.robot_file.arguments import samples
from edgevox.ros2.robot_file.format import BATTERY, Argument, StateEntry
from edgevox.ros2.robot_file.messages import (
    Filling,
    Kind,
    arguments_in,
    constant,
    constants_of,
    interface,
    is_primitive,
    is_text,
    listed,
    with_arguments,
)
from edgevox.ros2.robot_file.paths import FieldType, field_at
from edgevox.ros2.robot_file.steps import (
    WAYS,
    ActionInterface,
    Comparison,
    FieldCondition,
    Request,
    ResultValue,
    Scalar,
    Step,
    Wait,
)

_KINDS: Mapping[str, Kind] = {
    "publish": "msg",
    "read": "msg",
    "wait": "msg",
    "call": "srv",
    "action": "action",
}


ANY = ""
"""The type of a result whose path is wrong: nothing more is said of it."""


@dataclass(frozen=True, slots=True)
class PlannedStep:
    """A step, its type, and the classes of what is sent and of what comes back, if there are."""

    step: Step
    way: str
    type: Any
    request: Any = None
    answer: Any = None

    @property
    def interface_name(self) -> str:
        """The interface's name as the file writes it."""
        return str(getattr(self.step, self.way).name)


@dataclass(frozen=True, slots=True)
class PlannedState:
    """A state, its message's class, the class that has its field, and its value's type."""

    entry: StateEntry
    type: Any
    owner: Any
    value_type: str


class Planner:
    """Checks the steps of one skill in order: a later one may use earlier results.

    `arguments` are the skill's. What is wrong goes to `problems`, with file, line and field.
    """

    def __init__(
        self, arguments: Mapping[str, Argument], file: YamlFile, problems: Problems
    ) -> None:
        self._arguments, self._file, self._problems = arguments, file, problems
        self.results: dict[str, str] = {}
        """The types of the results so far, by their names."""
        self.constants: dict[str, Mapping[str, Any]] = {}
        """The constants by which the values of a result may be called, by the result's name."""

    def plan(self, step: Step, at: Place) -> PlannedStep:
        """A step that stands `at` this place. Raises `InterfaceMissing` for a type, too."""
        way = next(one for one in WAYS if getattr(step, one) is not None)
        kind = interface(getattr(step, way).type, _KINDS[way])
        planned = PlannedStep(step, way, kind, *_sides(way, kind))
        with self._problems.collect():
            self._check_steering(planned, at)
        with self._problems.collect():
            self._check_request(planned.request, step.request, (*at, "request"))
        if step.publish and step.publish.at_end:
            with self._problems.collect():
                end = (*at, "publish", "at_end")
                self._check_request(planned.request, step.publish.at_end, end)
        self._check_answer(planned, at)
        if step.action:
            with self._problems.collect():
                self._check_feedback(kind.Feedback, step.action, (*at, "action"))
        return planned

    def plan_watch(self, watch: Wait, at: Place) -> PlannedStep:
        """Plan a condition that ends a skill, as a step that waits for it. Raises like `plan`."""
        kind = interface(watch.type, "msg")
        for number, one in enumerate(watch.until):
            with self._problems.collect():
                self._check_condition(kind, one, (*at, "until", number))
        return PlannedStep(Step(wait=watch), "wait", kind, answer=kind)

    def plan_state(self, entry: StateEntry, at: Place) -> PlannedState:
        """A state that stands `at` this place. Raises `InterfaceMissing` for a type."""
        kind = interface(entry.type, "msg")
        owner, value_type = None, ANY
        with self._problems.collect():
            found = self._field_at(kind, entry.field, (*at, "field"))
            owner, value_type = found.owner, self._type_of(found.type, entry.value, (*at, "field"))
            if at[-1] == BATTERY and not is_number(value_type):
                expected = "a number, the charge from 0 to 1"
                raise self._file.wrong((*at, "field"), entry.field, expected)
        return PlannedState(entry, kind, owner, value_type)

    def check_compared(self, how: Comparison, name: str, state: PlannedState, at: Place) -> None:
        """Raise `InvalidValue` for a comparison that the state of this name can never meet."""
        if state.value_type == ANY:
            return
        compared = how.above is not None or how.below is not None
        if compared and not is_number(state.value_type):
            raise self._file.wrong(at, name, "a number, to be above or below something")
        if how.equals is not None:
            value = constant(state.owner, how.equals)
            if other := _unlike(state.value_type, value):
                expected = f"{other} ({state.value_type})"
                raise self._file.wrong((*at, "equals"), how.equals, expected)

    def _check_steering(self, planned: PlannedStep, at: Place) -> None:
        name = type_name(planned.type)
        if planned.way == "publish" and name in STEERING:
            expected = "no velocity: a robot is driven by navigate_to and its like, and limited"
            raise self._file.wrong((*at, "publish", "type"), name, expected)

    def _check_request(self, request: Any, template: Request, at: Place) -> None:
        self._check_named(template, at)
        if request is None and template:
            raise self._file.wrong(at, template, "nothing: what only hears has no request")
        if request is None or ANY in {self.results.get(one) for one in arguments_in(template)}:
            return
        for tried, values in self._samples():
            try:
                Filling(Time).fill(request(), template, values)
            except InvalidValue as error:
                hint = f"; so bound the argument {tried!r}" if tried else ""
                place = (*at, *_place_of(error.field))
                raise self._file.wrong(place, error.value, error.expected + hint) from None

    def _check_named(self, template: Any, at: Place) -> None:
        if unknown := arguments_in(template) - self._arguments.keys() - self.results.keys():
            expected = "an argument: one of " + ", ".join([*self._arguments, *self.results])
            raise self._file.wrong(at, "{" + min(unknown) + "}", expected)

    def _samples(self) -> Iterator[tuple[str, Mapping[str, Any]]]:
        earlier = {name: _sample_of(type_name) for name, type_name in self.results.items()}
        for tried, values in samples(self._arguments):
            yield tried, {**earlier, **values}

    def _check_answer(self, planned: PlannedStep, at: Place) -> None:
        step = planned.step
        for name, value in step.values.items():
            self.results[name] = ANY
            with self._problems.collect():
                self._check_result(planned.answer, name, value, (*at, "result", name))
        for number, one in enumerate(step.expect):
            with self._problems.collect():
                self._check_condition(planned.answer, one, (*at, "expect", number))
        for number, one in enumerate(step.wait.until if step.wait else ()):
            with self._problems.collect():
                self._check_condition(planned.answer, one, (*at, "wait", "until", number))

    def _check_feedback(self, feedback: Any, action: ActionInterface, at: Place) -> None:
        part = action.part_done
        paths = [part.field, *([part.of] if isinstance(part.of, str) else ())] if part else []
        for path in paths:
            if not is_number(self._type_at(feedback, path, (*at, "progress"))):
                expected = "a number, which says how much is done"
                raise self._file.wrong((*at, "progress"), path, expected)
        if action.tells and not is_text(self._type_at(feedback, action.tells, (*at, "tells"))):
            raise self._file.wrong((*at, "tells"), action.tells, "a text, which the robot says")

    def _check_condition(self, answer: Any, condition: FieldCondition, at: Place) -> None:
        found = self._field_at(answer, condition.field, (*at, "field"))
        type_name = found.type
        compared = condition.above is not None or condition.below is not None
        if compared and not is_number(type_name):
            expected = "a number, to be above or below something"
            raise self._file.wrong((*at, "field"), condition.field, expected)
        if condition.equals is None:
            return
        self._check_named(condition.equals, (*at, "equals"))
        if ANY in {self.results.get(one) for one in arguments_in(condition.equals)}:
            return
        for _, values in self._samples():
            value = with_arguments(condition.equals, values)
            if not is_text(type_name):
                value = constant(found.owner, value)
            if other := _unlike(type_name, value):
                names = ", ".join(constants_of(found.owner)) if isinstance(value, str) else ""
                expected = f"{other} ({type_name})" + (f", or a constant: {names}" if names else "")
                raise self._file.wrong((*at, "equals"), condition.equals, expected)

    def _check_result(self, answer: Any, name: str, value: ResultValue, at: Place) -> None:
        found = self._field_at(answer, value.field, at)
        self.constants[name] = constants_of(found.owner)
        self.results[name] = self._type_of(found.type, value, at)

    def _type_of(self, type_name: str, value: ResultValue, at: Place) -> str:
        if value.count:
            if not listed(type_name):
                raise self._file.wrong(at, value.field, "a list, to be counted")
            return "uint64"
        if not value.converts:
            return type_name
        if not is_number(type_name):
            raise self._file.wrong(at, value.field, "a number, to be multiplied")
        return "double" if value.decimals else "int64"

    def _type_at(self, answer: Any, path: str, at: Place) -> str:
        return self._field_at(answer, path, at).type

    def _field_at(self, answer: Any, path: str, at: Place) -> FieldType:
        if answer is None:
            raise self._file.wrong(at, path, "nothing: what is only published has no answer")
        self._check_named(path, at)
        try:
            return field_at(answer, path, "")
        except InvalidValue as error:
            raise self._file.wrong(at, path, error.expected) from None


def _sides(way: str, kind: Any) -> tuple[Any, Any]:
    match way:
        case "publish":
            return kind, None
        case "call":
            return kind.Request, kind.Response
        case "action":
            return kind.Goal, kind.Result
    return None, kind


def _unlike(type_name: str, value: Scalar) -> str:
    """Return what a field of this type must equal instead; empty if it can equal this value."""
    if not is_primitive(type_name):
        return "nothing: only a number, a truth or a text is compared"
    if is_text(type_name):
        return "" if isinstance(value, str) else "a text"
    if type_name == "boolean":
        return "" if isinstance(value, bool) else "true or false"
    return "a number" if isinstance(value, bool | str) else ""


def _place_of(path: str) -> Place:
    """The place of a field in a template, from how `Filling` names it."""
    return tuple(int(one) if one.isdigit() else one for one in re.findall(r"\w+", path))


def is_number(type_name: str) -> bool:
    """Whether values of this type are numbers."""
    return is_primitive(type_name) and type_name != "boolean" and not is_text(type_name)


def _sample_of(type_name: str) -> Any:
    if listed(type_name):
        return []
    if is_text(type_name):
        return "text"
    if type_name == "boolean":
        return True
    return 0.5 if type_name in ("float", "double") else 1
