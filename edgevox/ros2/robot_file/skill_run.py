"""A run of a robot file's skill: its steps in order, its end conditions, and its stop step."""

import threading
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from rclpy.node import Node

from edgevox.agent.skills import GoalHandle, SkillFailed
from edgevox.core.cancel import Cancelled, CancelToken
from edgevox.core.clock import Clock
from edgevox.core.log import get_logger
from edgevox.ros2.clients.clients import READ_S, interface_reason
from edgevox.ros2.clients.waiting import Newest
from edgevox.ros2.qos import interface_profile
from edgevox.ros2.robot_file.live import LiveStep, StepRun, holds
from edgevox.ros2.robot_file.plan import PlannedStep
from edgevox.ros2.robot_file.steps import Wait

log = get_logger(__name__)


class Watch:
    """A message that ends a skill, such as that of a bumper."""

    def __init__(self, planned: PlannedStep, node: Node, clock: Clock) -> None:
        self.name = planned.interface_name
        self._how: Wait = getattr(planned.step, planned.way)
        self._newest = Newest(clock)
        self._lock = threading.Lock()
        self._runs: tuple[Callable[[Watch], None], ...] = ()
        qos = interface_profile(latched=self._how.latched, heard=True)
        node.create_subscription(planned.type, self.name, self._take, qos)

    @property
    def so_now(self) -> bool:
        """Whether the last recent message would end the skill."""
        newest = self._newest.young(float("inf") if self._how.latched else READ_S)
        return newest is not None and holds(newest, self._how.until, {})

    def tell(self, run: Callable[["Watch"], None]) -> Callable[[], None]:
        """Tell this of each such message from now on, on the node's thread; what ends that."""
        with self._lock:
            self._runs = (*self._runs, run)
        return lambda: self._forget(run)

    def _forget(self, run: Callable[["Watch"], None]) -> None:
        with self._lock:
            self._runs = tuple(one for one in self._runs if one != run)

    def _take(self, message: Any) -> None:
        self._newest.take(message)
        runs = self._runs
        if runs and holds(message, self._how.until, {}):
            for run in runs:
                run(self)


@dataclass(frozen=True)
class LiveSkill:
    """The steps of a skill on a node, its end conditions, and its stop step."""

    name: str
    steps: Sequence[LiveStep]
    stop: LiveStep | None
    watches: Sequence[Watch]
    clock: Clock


def run_skill(skill: LiveSkill, goal: GoalHandle, values: Mapping[str, Any]) -> dict[str, Any]:
    """Do all steps; their results. Raises `SkillFailed`, or `Cancelled`."""
    run = _SkillRun(skill, goal, values)
    try:
        return run.steps()
    except Cancelled as cancelled:
        run.stop()
        if run.ended_by and not goal.token.cancelled:
            log.warning("skill_ended_by", skill=skill.name, interface=run.ended_by)
            reason = interface_reason("ended_by", what=run.ended_by)
            raise SkillFailed(reason) from cancelled
        raise
    finally:
        run.close()


class _SkillRun:
    """`ended_by` is the interface that ended it; empty if none did."""

    def __init__(self, skill: LiveSkill, goal: GoalHandle, values: Mapping[str, Any]) -> None:
        self._skill, self._goal, self._values = skill, goal, values
        self._token = goal.token.child()
        self._forgets: list[Callable[[], None]] = []
        self._begun = False
        self._stopped = False
        self.ended_by = ""

    def steps(self) -> dict[str, Any]:
        for watch in self._skill.watches:
            self._forgets.append(watch.tell(self._end))
            if watch.so_now:
                self._end(watch)
        results: dict[str, Any] = {}
        asked_s: float | None = None
        only_asked = False
        for step in self._skill.steps:
            self._token.check()
            self._begun = True
            values = {**self._values, **results}
            run = StepRun(values, self._token, self._goal.report, self.stop, asked_s, only_asked)
            asked_s, only_asked = self._skill.clock.now(), step.only_asks
            results |= step.run(run)
        return results

    def stop(self) -> None:
        """Do the file's stop step, for an early end: once, and only after the skill has begun."""
        if self._skill.stop is None or self._stopped or not self._begun:
            return
        self._stopped = True
        try:
            self._skill.stop.run(StepRun(self._values, CancelToken(), lambda **_: None))
        except SkillFailed as error:
            log.error("stop_step_failed", skill=self._skill.name, reason=str(error))  # noqa: TRY400

    def close(self) -> None:
        for forget in self._forgets:
            forget()
        self._token.detach()

    def _end(self, watch: Watch) -> None:
        self.ended_by = self.ended_by or watch.name
        self._token.cancel()
