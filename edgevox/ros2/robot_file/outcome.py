"""What came of a step: the values that the file asks for, and whether it is what was expected."""

from collections.abc import Sequence
from typing import Any

from edgevox.agent.skills import SkillFailed
from edgevox.core.log import get_logger
from edgevox.ros2.clients.interface_reasons import interface_reason
from edgevox.ros2.robot_file.field_paths import read_path
from edgevox.ros2.robot_file.plan import PlannedStep
from edgevox.ros2.robot_file.step_format import FieldCondition

log = get_logger(__name__)

LONGEST_WORDS = 200
DECIMALS = 3


def holds(message: Any, conditions: Sequence[FieldCondition]) -> bool:
    """Whether all of these hold for a message."""
    return all(_one_holds(read_path(message, one.field), one) for one in conditions)


def _one_holds(value: Any, condition: FieldCondition) -> bool:
    if condition.equals is not None:
        return bool(value == condition.equals)
    if isinstance(value, bool) or not isinstance(value, int | float):
        return False
    above = condition.above is None or value > condition.above
    return above and (condition.below is None or value < condition.below)


def values_of(planned: PlannedStep, message: Any) -> dict[str, Any]:
    """The results of a step, as JSON has them.

    Raises `SkillFailed` where what came back says that it was not done.
    """
    what = planned.interface_name
    said_no = planned.way == "call" and getattr(message, "success", True) is False
    if said_no or not holds(message, planned.step.expect):
        log.warning("interface_refused", interface=what, answer=str(message)[:LONGEST_WORDS])
        raise SkillFailed(interface_reason("refused", what=what))
    return {name: _said(read_path(message, path)) for name, path in planned.step.result.items()}


def _said(value: Any) -> Any:
    if isinstance(value, float):
        return round(value, DECIMALS)
    return value[:LONGEST_WORDS] if isinstance(value, str) else value
