"""The state of a robot by its file: values that it tells on topics, and what needs them.

A state is one value of a topic's newest message. `needs` of a skill, and of driving, are conditions
of such values: where one is not so, or is not known, nothing begins, and the robot says why. Those
of driving must hold until the drive ends.
"""

from collections.abc import Mapping, Sequence
from functools import partial
from math import inf, isfinite
from typing import Any

from hassil.parse_expression import parse_sentence
from hassil.parser import ParseError
from rclpy.node import Node
from sensor_msgs.msg import BatteryState

from edgevox.agent.known import VALUE, StateCondition
from edgevox.agent.phrases.load import ENGLISH, phrasebook
from edgevox.agent.skills import SkillFailed
from edgevox.agent.text.reasons import because
from edgevox.core.cancel import CancelToken
from edgevox.core.clock import Clock
from edgevox.core.files.validation import Place, Problems
from edgevox.core.files.yaml_file import YamlFile
from edgevox.core.reason import Reason
from edgevox.ros2.clients import THERE_S, TopicListener, interface_reason
from edgevox.ros2.robot_file.format import (
    BATTERY,
    Condition,
    Need,
    RobotFile,
    SkillEntry,
    StateEntry,
)
from edgevox.ros2.robot_file.live import compares, value_of
from edgevox.ros2.robot_file.messages import InterfaceMissing, arguments_in, constant
from edgevox.ros2.robot_file.plan import ANY, PlannedState, Planner, is_number
from edgevox.ros2.robot_file.steps import Step


class RobotStates:
    """What a robot tells of itself; call `open` before a value is asked for."""

    def __init__(self, planned: Mapping[str, PlannedState], driving: Sequence[Need] = ()) -> None:
        self._planned, self._driving = planned, driving
        self._heard: Mapping[str, TopicListener] = {}

    def open(self, node: Node, clock: Clock) -> None:
        """Listen on this node, which is not yet spun."""
        self._heard = {
            name: TopicListener(node, one.type, one.entry.topic, clock, latched=one.entry.latched)
            for name, one in self._planned.items()
        }

    def close(self) -> None:
        """The node is gone, and nothing is known."""
        self._heard = {}

    @property
    def has_battery(self) -> bool:
        """Whether one of them is the charge of the robot's battery."""
        return BATTERY in self._planned

    def conditions(self) -> dict[str, StateCondition]:
        """What orders can wait for, by state and number."""
        return {
            f"{name} {number}": StateCondition(
                {
                    code: [phrasebook(code).with_any_length(said) for said in some]
                    for code, some in {ENGLISH: one.sentences, **one.languages}.items()
                },
                partial(self._is_so, name, one),
            )
            for name, planned in self._planned.items()
            for number, one in enumerate((*planned.entry.when, *_usual_conditions(name, planned)))
        }

    def _is_so(self, name: str, condition: Condition, said: float | None) -> bool:
        """Whether the state is so now; false while it is not known."""
        message = self._heard[name].newest() if name in self._heard else None
        value = None if message is None else self._value(name, message)
        if value is None:
            return False
        return compares(
            value, condition.compared(said), constant(self._planned[name].owner, condition.equals)
        )

    def battery(self) -> float:
        """The charge, from 0 to 1. Raises `SkillFailed` while it is not known."""
        message = self._heard[BATTERY].newest() if BATTERY in self._heard else None
        value = None if message is None else self._value(BATTERY, message)
        if not isinstance(value, int | float) or not isfinite(value):
            if self._planned.get(BATTERY) is _USUAL_BATTERY and not self._ever_heard(BATTERY):
                raise SkillFailed(because("no_battery"))  # it may have none
            raise SkillFailed(interface_reason("unheard", what=BATTERY))
        charge = value / 100 if value > _MOST_CHARGE else value
        return min(1.0, max(0.0, float(charge)))

    def with_battery(self) -> "RobotStates":
        """These, for its skills have them, with a battery's usual topic, unless one is there."""
        if self is NO_STATES:
            return RobotStates({BATTERY: _USUAL_BATTERY})
        self._planned = {BATTERY: _USUAL_BATTERY, **self._planned}
        return self

    def check_driving(self, token: CancelToken, most_s: float = THERE_S) -> None:
        """Raise as `check` does for what driving needs."""
        self.check(self._driving, token, most_s)

    def check_driven(self) -> None:
        """Raise `SkillFailed` if what driving needs is known to be lost. Never blocks."""
        for need in self._driving:
            message = self._ever_heard(need.state)
            value = None if message is None else self._value(need.state, message)
            if value is not None:
                self._check(need, value)

    def check(self, needs: Sequence[Need], token: CancelToken, most_s: float = THERE_S) -> None:
        """Raise `SkillFailed` for the first of these that is not met, or not known within seconds.

        Raises `Cancelled`, too.
        """
        for need in needs:
            self._check(need, self._awaited(need.state, token, most_s))

    def _check(self, need: Need, value: Any) -> None:
        wanted = constant(self._planned[need.state].owner, need.equals)
        if not compares(value, need, wanted):
            told = {code: text for code, text in need.languages.items() if text}
            told["en"] = need.failed
            raise SkillFailed(Reason(need.failed, code="not_now", sentences=told, is_sentence=True))

    def _awaited(self, name: str, token: CancelToken, most_s: float) -> Any:
        """A value, as soon as one is heard: the robot may have been found just now."""
        unheard = SkillFailed(interface_reason("unheard", what=name))
        if name not in self._heard:
            raise unheard
        try:
            value = self._value(name, self._heard[name].latest(token, most_s))
        except SkillFailed:
            raise unheard from None
        if value is None:
            raise unheard
        return value

    def _ever_heard(self, name: str) -> Any:
        """The newest message, however old; None if there is none."""
        return self._heard[name].newest(inf) if name in self._heard else None

    def _value(self, name: str, message: Any) -> Any:
        return value_of(message, self._planned[name].entry.value)


_MOST_CHARGE = 1.5
"""A greater number is a percentage, which some drivers publish instead of a part."""
_USUAL_BATTERY = PlannedState(
    StateEntry(topic="battery_state", type="sensor_msgs/msg/BatteryState", field="percentage"),
    BatteryState,
    BatteryState,
    "float",
)
NO_STATES = RobotStates({})


def planned_states(
    robot: RobotFile, file: YamlFile, problems: Problems
) -> tuple[dict[str, PlannedState], dict[str, str]]:
    """The states of a file, and why others are off; what is wrong goes to `problems`."""
    planned: dict[str, PlannedState] = {}
    off: dict[str, str] = {}
    for name, entry in robot.state.items():
        try:
            planned[name] = Planner({}, file, problems).plan_state(entry, ("state", name))
        except InterfaceMissing as error:
            off[name] = str(error)
        for number, condition in enumerate(entry.when):
            where = ("state", name, "when", number)
            _check_condition(condition, file, where, problems)
            if name in planned:
                how = condition.compared(0.0)
                with problems.collect():
                    Planner({}, file, problems).check_compared(how, name, planned[name], where)
    named: list[tuple[Place, Sequence[Need]]] = [(("needs",), robot.needs)]
    named += [(("skills", name, "needs"), one.needs) for name, one in robot.skills.items()]
    for place, needs in named:
        for number, one in enumerate(needs):
            at = (*place, number)
            with problems.collect():
                if one.state not in robot.state:
                    expected = "a state: one of " + (", ".join(robot.state) or "none")
                    raise file.wrong((*at, "state"), one.state, expected)
                if one.state in planned:
                    Planner({}, file, problems).check_compared(
                        one, one.state, planned[one.state], at
                    )
    return planned, off


def _check_condition(one: Condition, file: YamlFile, at: Place, problems: Problems) -> None:
    """Find sentences that are no templates."""
    for code, some in {ENGLISH: one.sentences, **one.languages}.items():
        place = (*at, "sentences") if code == ENGLISH else (*at, "languages", code)
        for index, sentence in enumerate(some):
            with problems.collect():
                try:
                    parse_sentence(sentence)
                except (ParseError, ValueError) as error:
                    raise file.wrong((*place, index), sentence, f"a template ({error})") from None
                if arguments_in(sentence) - {VALUE}:
                    raise file.wrong((*place, index), sentence, "no slot but {value}")


_MORE, _LESS = "(above|over|more than|higher than)", "(below|under|less than|lower than)"


def _usual_conditions(name: str, planned: PlannedState) -> list[Condition]:
    """The conditions of a number, in English, unless it stands for something that has words.

    EdgeVox has those of the battery by itself.
    """
    entry = planned.entry
    if name == BATTERY or entry.words or entry.when or not is_number(planned.value_type):
        return []
    called = f"[the|your|my] {name.replace('_', ' ')} (is|gets|goes|rises|falls|drops)"
    unit = f" [{entry.unit}]" if entry.unit else ""
    return [
        Condition(above="{value}", sentences=[f"{called} {_MORE} {{value}}{unit}"]),
        Condition(below="{value}", sentences=[f"{called} {_LESS} {{value}}{unit}"]),
    ]


def questions(robot: RobotFile, planned: Mapping[str, PlannedState]) -> dict[str, SkillEntry]:
    """The skills that say the states, by their names; EdgeVox asks for the battery by itself."""
    return {
        name: _question(name, robot.state[name])
        for name, one in planned.items()
        if name != BATTERY
        and one.value_type != ANY
        and (robot.state[name].done or one.value_type != "boolean")
    }


def _question(name: str, entry: StateEntry) -> SkillEntry:
    called = name.replace("_", " ")
    unit = f" {entry.unit}" if entry.unit else ""
    read = Step(read=entry.read, result={name: entry.value})
    told = f"Tell a state of the robot: {called}." if entry.words else f"Say what the {called} is."
    usual = {
        "description": told,
        "sentences": [f"what (is|are) [(the|your)] {called}", f"what's [(the|your)] {called}"],
        "done": f"The {called} is {{{name}}}{unit}.",
    }
    given = {key: getattr(entry, key) for key in entry.model_fields_set & entry.said}
    return SkillEntry.model_validate({**read.model_dump(exclude_unset=True), **usual, **given})


__all__ = ["NO_STATES", "RobotStates", "planned_states", "questions"]
