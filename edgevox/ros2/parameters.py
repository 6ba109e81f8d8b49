"""The node's parameters: the settings of the topic commands, seen and changed as parameters."""

from collections.abc import Mapping, Sequence

from rcl_interfaces.msg import ParameterDescriptor, SetParametersResult
from rclpy.exceptions import InvalidParameterTypeException
from rclpy.executors import Executor
from rclpy.node import Node
from rclpy.parameter import Parameter as RosParameter

from edgevox.core.bus import Bus
from edgevox.core.controls import Controls, Value
from edgevox.core.errors import InvalidValue
from edgevox.core.events import ControlChanged
from edgevox.ros2.contract import PARAMETERS


def declare(node: Node, values: Mapping[str, Value]) -> dict[str, Value]:
    """Declare the contract's parameters; `values` are their defaults.

    The result is what they are: launch files, parameter files and ``-p`` overrule the defaults.
    Raises `InvalidValue` for one of another type.
    """
    for row in PARAMETERS:
        descriptor = ParameterDescriptor(
            description=row.about,
            additional_constraints=row.constraints,
            read_only=row.read_only,
        )
        try:
            node.declare_parameter(row.name, values[row.name], descriptor)
        except InvalidParameterTypeException as error:
            raise InvalidValue(row.name, str(error), row.constraints) from None
    return {row.name: node.get_parameter(row.name).value for row in PARAMETERS}


class Parameters:
    """Keeps parameters and controls the same, whichever side changes.

    A value that cannot be honoured is refused by the result of the set call, with the reason.
    """

    def __init__(self, node: Node, executor: Executor, controls: Controls, bus: Bus) -> None:
        self._node = node
        self._executor = executor
        self._controls = controls
        node.add_on_set_parameters_callback(self._check)
        node.add_post_set_parameters_callback(self._apply)
        self._forget = bus.subscribe(ControlChanged, self._follow)

    def close(self) -> None:
        """Follow no more changes."""
        self._forget()

    def _check(self, wanted: Sequence[RosParameter]) -> SetParametersResult:
        try:
            self._controls.check(_controls_of(wanted))
        except InvalidValue as error:
            return SetParametersResult(successful=False, reason=str(error))
        return SetParametersResult(successful=True)

    def _apply(self, changed: Sequence[RosParameter]) -> None:
        self._controls.change(_controls_of(changed))

    def _follow(self, event: ControlChanged) -> None:
        """Show a change that came another way; on the node's own thread, as rclpy wants it."""
        self._executor.create_task(self._show, event)

    def _show(self, event: ControlChanged) -> None:
        if self._node.get_parameter(event.name).value != event.value:
            self._node.set_parameters([RosParameter(event.name, value=event.value)])


def _controls_of(parameters: Sequence[RosParameter]) -> dict[str, Value]:
    ours = {"language", "voice", "muted", "confirm"}
    return {one.name: one.value for one in parameters if one.name in ours}
