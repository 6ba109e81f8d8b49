"""A parameter shows what counts, also where a change fails after its check."""

from types import SimpleNamespace
from typing import Any

from rclpy.parameter import Parameter

from edgevox.core.bus import Bus
from edgevox.core.errors import InvalidValue
from edgevox.core.events import ControlChanged
from edgevox.ros2.bridge import Parameters


class Node:
    """Sets parameters as rclpy does: the check first, then what is to be told of it."""

    def __init__(self) -> None:
        self.values: dict[str, Any] = {"language": "en"}

    def add_on_set_parameters_callback(self, check: Any) -> None:
        self._check = check

    def add_post_set_parameters_callback(self, tell: Any) -> None:
        self._tell = tell

    def get_parameter(self, name: str) -> Any:
        return SimpleNamespace(value=self.values[name])

    def set_parameters(self, some: list[Parameter]) -> None:
        if self._check(some).successful:
            self.values |= {one.name: one.value for one in some}
            self._tell(some)


class Controls:
    language = "en"
    broken = False

    def check(self, wanted: dict[str, Any]) -> None:
        """Everything was well a moment ago."""

    def change(self, wanted: dict[str, Any]) -> None:
        if self.broken and wanted["language"] != self.language:
            raise InvalidValue("language", wanted["language"], "one that can be heard here")
        self.language = wanted["language"].partition("-")[0]


def rig() -> tuple[Node, Controls, Bus, list[Any]]:
    node, controls, bus, tasks = Node(), Controls(), Bus(), []
    executor: Any = SimpleNamespace(create_task=lambda act, *given: tasks.append((act, given)))
    Parameters(node, executor, controls, bus)  # type: ignore[arg-type]
    return node, controls, bus, tasks


def test_what_cannot_be_honoured_any_more_is_shown_as_it_is() -> None:
    node, controls, _, tasks = rig()
    controls.broken = True  # its model vanishes between the check and the change

    node.set_parameters([Parameter("language", value="de")])
    for act, given in tasks:
        act(*given)

    assert controls.language == node.values["language"] == "en"


def test_a_value_that_is_reworded_is_shown_as_it_counts() -> None:
    node, controls, _, tasks = rig()

    node.set_parameters([Parameter("language", value="de-DE")])
    while tasks:
        act, given = tasks.pop(0)
        act(*given)

    assert controls.language == node.values["language"] == "de"


def test_a_change_that_was_taken_back_meanwhile_is_not_shown_and_not_done_again() -> None:
    node, controls, bus, tasks = rig()

    for language in ("de", "en"):
        controls.language = language
        bus.publish(ControlChanged("language", language))
    for act, given in tasks:
        act(*given)

    assert controls.language == node.values["language"] == "en"
