"""A robot on ROS 2 that does not drive, such as an arm or a lift: it can what its file says."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from edgevox.agent.policy import Policy
from edgevox.agent.skills import GoalHandle, Result, Skill, skill
from edgevox.core.clock import Clock, SystemClock
from edgevox.ros2.clients.agent_node_handle import AgentNodeHandle
from edgevox.ros2.contract import EXTERNAL_NODE
from edgevox.ros2.node import RosNode
from edgevox.ros2.robot_file.skills import DescribedSkill
from edgevox.ros2.stamps import NS_PER_S


class StationaryRobot:
    """A body that has neither pose nor velocity, and so no topic of the contract.

    Its node has only what its skills need. All that moves it is a goal, which every stop ends.
    """

    name = "robot-external"
    about = ""
    """What it is called and what it is for, if its file says so."""
    own_policy: Path | Policy | None = None
    """The policy that its file names or holds, for where no setting names one."""

    def __init__(
        self, namespace: str, described: Sequence[DescribedSkill], clock: Clock | None = None
    ) -> None:
        self._namespace, self._described = namespace, described
        self._clock = clock or SystemClock()
        self._node: RosNode | None = None
        self.ros = AgentNodeHandle(self._clock)
        """Its node, for skills."""
        self._skills = (_stop(), *(one.skill() for one in described))

    @property
    def skills(self) -> tuple[Skill, ...]:
        return self._skills

    @property
    def time_s(self) -> float:
        """That of its node, which is the robot's where it follows /clock; 0 while it is off."""
        node = self._node
        return node.node.get_clock().now().nanoseconds / NS_PER_S if node else 0.0

    @property
    def stalled_s(self) -> float:
        """For how long nothing that it hears is taken in."""
        node = self._node
        return node.stalled_s if node else 0.0

    def start(self) -> None:
        """Join the graph. Raises `RosBridgeFailed` where that cannot be done."""
        self._node = RosNode(self._namespace, name=EXTERNAL_NODE)
        for one in self._described:
            one.open(self._node.node, self._clock)
        self.ros.open(self._node.node)
        self._node.start()

    def close(self) -> None:
        """Leave the graph."""
        node, self._node = self._node, None
        if node is None:
            return
        for one in self._described:
            one.close()
        self.ros.close()
        node.close()

    def state(self) -> Mapping[str, Any]:
        """Its name and its time: it is nowhere, and goes nowhere."""
        return {"name": self.name, "time": round(self.time_s, 3)}

    def halt(self, reason: str) -> bool:  # noqa: ARG002 - every body is told why
        """Nothing moves but by its skills, whose goals end by themselves."""
        return False

    def reset(self) -> None:
        """A real robot cannot be put back."""


def _stop() -> Skill:
    @skill()
    def stop(goal: GoalHandle) -> Result:
        """Stop at once what it does."""
        goal.token.check()  # as a goal that moves it has ended the one before
        return {}

    return stop
