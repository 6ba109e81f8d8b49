"""What the words on the wire of `execute_skill` mean; knows nothing of rclpy."""

import json
from collections.abc import Mapping
from typing import Any, Protocol

from edgevox.core.cancel import CancelToken
from edgevox.core.errors import InvalidValue
from edgevox.ros2.json_text import write

MAX_ARGUMENTS_BYTES = 64 * 1024
"""The longest `arguments_json` that is read."""


class RunningGoal(Protocol):
    """A goal that was started."""

    @property
    def token(self) -> CancelToken:
        """Ends it when cancelled."""


class StartsGoals(Protocol):
    """Who runs skills; the conversation does. Both raise `EdgeVoxError` with the reason."""

    def check_goal(self, name: str, arguments: Mapping[str, Any]) -> None:
        """Raise what `start_goal` would raise; nothing happens."""

    def start_goal(
        self, name: str, arguments: Mapping[str, Any], goal_id: str | None = None
    ) -> RunningGoal:
        """Run a skill. Does not block; the bus tells of it under this id from now on."""


def read_arguments(text: str) -> dict[str, Any]:
    """The arguments in `arguments_json`; empty means none. Raises `InvalidValue`."""
    size = len(text.encode("utf-8", "surrogatepass"))
    if size > MAX_ARGUMENTS_BYTES:
        raise InvalidValue(
            "arguments_json", f"{size} bytes", f"at most {MAX_ARGUMENTS_BYTES} bytes"
        )
    if not text.strip():
        return {}
    try:
        arguments = json.loads(text, parse_constant=_refuse)
        json.dumps(arguments, ensure_ascii=False).encode()  # half a character is not Unicode
    except (ValueError, RecursionError) as error:
        raise InvalidValue("arguments_json", text, f"a JSON object ({error})") from None
    if not isinstance(arguments, dict):
        raise InvalidValue("arguments_json", text, "a JSON object, keyword to value")
    return arguments


def mirror(kind: str, data: Mapping[str, Any]) -> str:
    """The feedback that mirrors an `agent_event`, with its ``progress`` on top where it has one."""
    progress = data.get("feedback", {}).get("progress")
    return write({"kind": kind, **data} | ({} if progress is None else {"progress": progress}))


def _refuse(constant: str) -> float:
    raise ValueError(f"{constant} is not JSON")
