"""A client of the action `execute_skill`, where its interface is built."""

import threading
from collections.abc import Callable
from typing import Any

from rclpy.action import ActionClient
from rclpy.executors import Executor
from rclpy.node import Node

from edgevox.core.errors import EdgeVoxError
from edgevox.ros2.contract import ACTION

ANSWER_S = 10.0


class SkillClient:
    """Starts skills, and lets them run as long as it is there: a goal ends with its client."""

    def __init__(self, node: Node, executor: Executor) -> None:
        self._executor = executor
        self._kind: Any = None
        self._client: Any = None
        self._handles: list[Any] = []
        try:
            from edgevox_msgs.action import ExecuteSkill
        except ImportError:
            return
        self._kind = ExecuteSkill
        self._client = ActionClient(node, ExecuteSkill, ACTION[0])

    def close(self) -> None:
        """Leave the action."""
        if self._client is not None:
            self._on_executor(self._client.destroy)

    def there(self) -> bool:
        """Whether somebody serves it. Raises `EdgeVoxError` where its interface is not built."""
        if self._client is None:
            raise EdgeVoxError(f"{ACTION[0]}: edgevox_msgs is not built; make msgs")
        return bool(self._client.server_is_ready())

    def start(self, skill: str, arguments_json: str) -> bool:
        """Whether it was accepted. Raises `EdgeVoxError` where nobody answers."""
        self.there()
        goal = self._kind.Goal(skill_name=skill, arguments_json=arguments_json)

        async def ask() -> bool:
            handle = await self._client.send_goal_async(goal)
            self._handles.append((handle, handle.get_result_async() if handle.accepted else None))
            return bool(handle.accepted)

        return bool(self._on_executor(ask))

    def _on_executor(self, work: Callable[[], Any]) -> Any:
        """There, since rclpy misses an answer that is faster than its own bookkeeping."""
        done = threading.Event()
        task = self._executor.create_task(work)
        task.add_done_callback(lambda _: done.set())
        if not done.wait(ANSWER_S):
            raise EdgeVoxError(f"{ACTION[0]}: no answer within {ANSWER_S:g} s")
        return task.result()
