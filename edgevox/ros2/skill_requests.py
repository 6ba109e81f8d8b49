"""The request and answer texts of `execute_skill`, without rclpy."""

from collections.abc import Mapping
from typing import Any, Protocol

from edgevox.agent.skills import STOP
from edgevox.core.agent_events import AgentEvent, as_json
from edgevox.core.cancel import CancelToken
from edgevox.core.files.json_reader import read_json_object
from edgevox.core.ways import Way
from edgevox.ros2.messages import write

MAX_ARGUMENTS_BYTES = 64 * 1024
"""The longest `arguments_json` that is read."""


class RunningGoal(Protocol):
    """A goal that was started."""

    @property
    def token(self) -> CancelToken:
        """Ends it when cancelled."""


class StartsGoals(Protocol):
    """Runs skills, as the conversation does. Both methods raise `EdgeVoxError` with the reason."""

    def check_goal(
        self,
        name: str,
        arguments: Mapping[str, Any],
        way: Way = Way.ACTION,
        mark: int | None = None,
    ) -> None:
        """Raise what `start_goal` would raise; but that a refusal is told, nothing happens."""

    def start_goal(
        self,
        name: str,
        arguments: Mapping[str, Any],
        goal_id: str | None = None,
        way: Way = Way.ACTION,
        mark: int | None = None,
    ) -> RunningGoal:
        """Run a skill. Does not block; the bus tells of it under this id from now on.

        `mark` is the interlock's when it was received, now by default.
        """


def read_arguments(text: str, skill: str = "") -> dict[str, Any]:
    """The arguments in `arguments_json`; empty means none. Raises `InvalidValue`.

    Of the `skill` that stops nothing is read: a stop with wrong arguments is still a stop.
    """
    if skill == STOP:
        return {}
    if len(text) <= MAX_ARGUMENTS_BYTES and not text.strip():
        return {}
    return read_json_object(text, "arguments_json", largest_bytes=MAX_ARGUMENTS_BYTES)


def mirror(event: AgentEvent) -> str:
    """The feedback that mirrors an `agent_event`, with its ``progress`` on top where it has one."""
    data = as_json(event)
    progress = data.get("feedback", {}).get("progress")
    return write(data | ({} if progress is None else {"progress": progress}))
