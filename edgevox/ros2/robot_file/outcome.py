"""What came of a step: the values that the file asks for, and whether it is what was expected."""

from collections.abc import Mapping, Sequence
from typing import Any

from edgevox.agent.skills import SkillFailed
from edgevox.core.log import get_logger
from edgevox.ros2.clients.interface_reasons import interface_reason
from edgevox.ros2.robot_file.field_paths import LONGEST_TEXT, brief, read_path
from edgevox.ros2.robot_file.filling import with_arguments
from edgevox.ros2.robot_file.plan import PlannedStep
from edgevox.ros2.robot_file.step_format import FieldCondition, ResultValue

log = get_logger(__name__)


def holds(message: Any, conditions: Sequence[FieldCondition], arguments: Mapping[str, Any]) -> bool:
    """Whether all of these hold for a message, with these values for what they name."""
    return all(_one_holds(read_path(message, one.field), one, arguments) for one in conditions)


def _one_holds(value: Any, condition: FieldCondition, arguments: Mapping[str, Any]) -> bool:
    if condition.equals is not None:
        return bool(value == with_arguments(condition.equals, arguments))
    if isinstance(value, bool) or not isinstance(value, int | float):
        return False
    above = condition.above is None or value > condition.above
    return above and (condition.below is None or value < condition.below)


def values_of(planned: PlannedStep, message: Any, arguments: Mapping[str, Any]) -> dict[str, Any]:
    """The results of a step, as JSON has them; `arguments` are what its conditions may name.

    Raises `SkillFailed` where what came back says that it was not done.
    """
    what = planned.interface_name
    said_no = planned.way == "call" and getattr(message, "success", True) is False
    if said_no or not holds(message, planned.step.expect, arguments):
        log.warning("interface_refused", interface=what, answer=str(brief(message))[:LONGEST_TEXT])
        raise SkillFailed(interface_reason("refused", what=what))
    return {name: value_of(message, one) for name, one in planned.step.values.items()}


def value_of(message: Any, how: ResultValue) -> Any:
    """A value of what came, as JSON has it, not longer than `brief`.

    None where a list is shorter, and for a number that is none, as of a sensor that sees nothing.
    """
    value = read_path(message, how.field)
    if how.times is not None and isinstance(value, int | float):
        value = value * how.times
    value = brief(value)
    if isinstance(value, float):
        return round(value, how.decimals) if how.decimals else round(value)
    return value
