"""`robot-external` for a robot that does not drive, such as an arm or a lift."""

from collections.abc import Mapping, Sequence
from typing import Any

from edgevox.agent.skills import GoalHandle, Result, Skill, skill
from edgevox.core.clock import Clock, SystemClock
from edgevox.robots.capabilities import HasBattery
from edgevox.robots.facts import battery_skill
from edgevox.ros2.agent_node_handle import AgentNodeHandle
from edgevox.ros2.contract import EXTERNAL_NODE
from edgevox.ros2.external.settings import DescribedRobot
from edgevox.ros2.node import RosNode
from edgevox.ros2.robot_file.skills import DescribedSkill
from edgevox.ros2.robot_file.state import NO_STATES, RobotStates
from edgevox.ros2.stamps import NS_PER_S


class StationaryRobot(DescribedRobot):
    """A body without pose or velocity, such as an arm, and so without topics of the contract.

    Its node has only the interfaces of its skills. It moves only by goals, which every stop ends.
    """

    def __init__(
        self,
        namespace: str,
        described: Sequence[DescribedSkill],
        clock: Clock | None = None,
        *,
        states: RobotStates = NO_STATES,
    ) -> None:
        self._namespace = namespace
        self._described: Sequence[DescribedSkill | RobotStates] = (*described, states)
        self.conditions = states.conditions()
        """What its states let orders wait for."""
        if states.has_battery:
            self.battery = states.battery
        self._clock = clock or SystemClock()
        self._node: RosNode | None = None
        self.ros = AgentNodeHandle(self._clock)
        """Access to its node, for skills."""
        asked = (battery_skill(self),) if isinstance(self, HasBattery) else ()
        self._skills = (_stop(), *(one.skill() for one in described), *asked)

    @property
    def skills(self) -> tuple[Skill, ...]:
        return self._skills

    @property
    def time_s(self) -> float:
        """The time of its node, which is the robot's if it follows /clock; 0 while it is off."""
        node = self._node
        return node.node.get_clock().now().nanoseconds / NS_PER_S if node else 0.0

    @property
    def stalled_s(self) -> float:
        """Seconds for which it has taken in no messages."""
        node = self._node
        return node.stalled_s if node else 0.0

    def start(self) -> None:
        """Join the graph. Raises `RosBridgeFailed` where that cannot be done."""
        self._node = RosNode(self._namespace, name=EXTERNAL_NODE, own_name=True)
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
        """Return its name and its time; it has no pose."""
        return {"name": self.name, "time": round(self.time_s, 3)}

    def halt(self, reason: str) -> bool:  # noqa: ARG002 - every body is told why
        """Return False: it moves only by its skills, whose goals end by themselves."""
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
