"""The node that a robot is driven from, with all that it hears and says."""

import sys
from collections.abc import Callable, Sequence
from contextlib import AbstractContextManager
from dataclasses import replace

from rclpy.clock import Clock as RosClock
from rclpy.clock_type import ClockType
from std_msgs.msg import Header

from edgevox.agent.skills import SkillFailed
from edgevox.agent.text.reasons import because
from edgevox.core.cancel import CancelToken
from edgevox.core.clock import Clock
from edgevox.core.log import get_logger
from edgevox.core.reason import Reason
from edgevox.core.transforms import BASE
from edgevox.ros2.agent_node_handle import AgentNodeHandle
from edgevox.ros2.contract import EXTERNAL_NODE
from edgevox.ros2.external.inputs import SensorInputs
from edgevox.ros2.external.motion import (
    GoalTopicBackend,
    MotionBackend,
    OwnSteering,
    VelocityPublisher,
)
from edgevox.ros2.external.nav2 import LOST_S, Nav2Cancel, nav2_action
from edgevox.ros2.external.navigation import ControlLoop
from edgevox.ros2.external.odometry import SILENT_S
from edgevox.ros2.external.settings import (
    SPEED_M_S,
    SPEED_RAD_S,
    ExternalSettings,
    Speeds,
    SteeringLimits,
)
from edgevox.ros2.external.topic_types import TopicTypes
from edgevox.ros2.messages import header
from edgevox.ros2.node import RosNode
from edgevox.ros2.robot_file.skills import DescribedSkill
from edgevox.ros2.robot_file.state import RobotStates
from edgevox.ros2.stamps import NS_PER_S, to_msg

log = get_logger(__name__)

TICK_S = 0.05
_LOOK_AGAIN_S = 0.05
LOOK_S = 0.5
"""Seconds between two looks at the types of the robot's topics."""


class RobotNode:
    """The node that drives a robot: in the robot's namespace, with its own context and thread.

    `lock` guards what the robot is asked for; the tick holds it, and never blocks under it.
    """

    def __init__(
        self,
        namespace: str,
        settings: ExternalSettings,
        clock: Clock,
        lock: AbstractContextManager[object],
        *,
        described: Sequence[DescribedSkill | RobotStates] = (),
        handle: AgentNodeHandle | None = None,
        check_driven: Callable[[], None] = lambda: None,
    ) -> None:
        self._settings, self._clock, self._lock = settings, clock, lock
        ros_args = [*sys.argv, *settings.remappings] if settings.remappings else ()
        self._ros = RosNode(namespace, ros_args, name=EXTERNAL_NODE, own_name=True)
        node = self._ros.node
        self.types = TopicTypes(node)
        steering = settings.steering
        self.senses = SensorInputs(
            node, clock, _speeds(steering), self.types, half_width_m=steering.half_width_m
        )
        wheels = VelocityPublisher(self._ros, self.types, self._header)
        self._wheels_topic = node.resolve_topic_name("cmd_vel")
        self._cancel = Nav2Cancel(node, clock)
        goals = GoalTopicBackend(node, self._cancel.cancel_all, settings.goal_patience, self.types)
        nav2 = nav2_action(node, self._cancel.cancel_all, settings.goal_patience)
        self._takers: list[MotionBackend] = [nav2, goals] if nav2 else [goals]
        self.control = ControlLoop(
            lock,
            self.senses,
            wheels,
            goals,
            clock=clock,
            obey_s=settings.obey_s,
            speed_up_m_s2=settings.steering.max_linear_m_s2,
            check_driven=check_driven,
        )
        self._steering = OwnSteering(
            self.control.steer,
            self.senses.trusted_scan,
            settings.steering,
            settings.steering_patience,
        )
        self._described = described
        for one in described:
            one.open(node, clock)
        self._handle = handle
        if handle:
            handle.open(node)
        self._silent = False
        self._look_s = clock.now()
        # Real time: a /clock that stands still or jumps must not leave a robot driving.
        steady = RosClock(clock_type=ClockType.STEADY_TIME)
        node.create_timer(TICK_S, self._tick, clock=steady)

    def start(self) -> None:
        self._ros.start()
        self._discovered_s = self._clock.now() + self._settings.discovery_s

    def close(self) -> None:
        for one in self._described:
            one.close()
        if self._handle:
            self._handle.close()
        self._ros.close()
        self.types.close()

    @property
    def stalled_s(self) -> float:
        """Seconds for which a callback has held up all others."""
        return self._ros.stalled_s

    def choose(self, token: CancelToken) -> MotionBackend:
        """Choose how to drive now: by goals, or by steering if no node takes goals.

        The graph decides. Just after the start, the robot may not be discovered yet; this waits
        until it is, or until discovery has taken long enough. A robot that is silent may also just
        be heard late: it has `SILENT_S` more. Raises `Cancelled`.
        """
        self._wait(token, lambda: not self._cancel.pending, self._clock.now() + LOST_S)
        self._wait(
            token,
            lambda: self._takers[0].available() and self.senses.estimate() is not None,
            self._discovered_s,
        )
        if self.senses.odometry_history.newest():
            until_s = self._clock.now() + SILENT_S
            self._wait(token, lambda: self.senses.estimate() is not None, until_s)
        return next((one for one in self._takers if one.available()), self._steering)

    @property
    def takes_goals(self) -> bool:
        """Whether a node takes goals now, as far as the graph is known."""
        return any(one.available() for one in self._takers)

    def until_heard(self, token: CancelToken, most_s: float, *, turns: bool) -> None:
        """Wait until the robot can be driven, as long as `choose` would, and so many seconds.

        `turns`: it is not enough that it takes goals. Raises `Cancelled`.
        """
        now_s = self._clock.now()
        late_s = now_s + SILENT_S if self.senses.odometry_history.newest() else now_s
        until_s = min(now_s + most_s, max(self._discovered_s, late_s))
        self._wait(token, lambda: self.senses.estimate() is not None, until_s)
        until_s = min(until_s, self._discovered_s)
        self._wait(
            token,
            lambda: self.types.is_there("cmd_vel") or (self.takes_goals and not turns),
            until_s,
        )

    def check_wheels(self) -> None:
        """Raise `SkillFailed` if no velocity can reach the robot."""
        if unfit := self.types.unfit("cmd_vel"):
            unfit.check()
        if not self.types.is_there("cmd_vel"):
            reason = because("velocities_unheard", topic=self._wheels_topic)
            raise SkillFailed(replace(reason, text=reason.text + self._hint("cmd_vel")))

    @property
    def odometry_missing(self) -> Reason:
        """The reason why nothing was ever heard of the odometry."""
        if unfit := self.types.unfit("odom"):
            return unfit.reason
        reason = because("robot_unheard", topic=self.senses.odom_topic)
        return replace(reason, text=reason.text + self._hint("odom"))

    @property
    def odometry_fault(self) -> str:
        """The same in a few words."""
        if unfit := self.types.unfit("odom"):
            return str(unfit)
        return f"nothing is heard on {self.senses.odom_topic}{self._hint('odom')}"

    def _hint(self, topic: str) -> str:
        """Why nothing comes through, or other topics that the robot may mean, in brackets."""
        if barrier := self.types.barrier(topic):
            return f" ({barrier})"
        there = self.types.elsewhere(topic)
        return f" (there is {', '.join(there)}: name it in a robot file's topics)" if there else ""

    def recall(self) -> None:
        """Make what takes goals forget them, whoever sent them."""
        self._cancel.cancel_all()

    def _wait(self, token: CancelToken, condition: Callable[[], bool], until_s: float) -> None:
        token.check()
        while not condition() and self._clock.now() < until_s:
            token.wait(_LOOK_AGAIN_S)
            token.check()

    def _header(self) -> Header:
        """The header of a velocity: the robot's base, at the robot's time."""
        seen = self.senses.odometry_history.newest()
        if seen is None or not seen.stamp_ns:
            return Header(frame_id=BASE, stamp=self._ros.node.get_clock().now().to_msg())
        age_ns = int(self.senses.odometry_history.age_s(seen) * NS_PER_S)
        return header(seen.child_frame, to_msg(seen.stamp_ns + age_ns))

    def _tick(self) -> None:
        with self._lock:
            if self._clock.now() >= self._look_s:
                self._look_s = self._clock.now() + LOOK_S
                self.types.look()
            try:
                self.control.tick()
            except Exception as error:
                self.control.mux.halt(error)
                raise
        self._notice_silence()

    def _notice_silence(self) -> None:
        heard = self.senses.odometry_history.newest() is not None
        silent = heard and self.senses.odometry_history.fresh() is None
        if silent and not self._silent:
            log.warning("odometry_silent", topic=self.senses.odom_topic, silent_s=SILENT_S)
        elif self._silent and not silent:
            log.warning("odometry_back", topic=self.senses.odom_topic)
        self._silent = silent


def _speeds(limits: SteeringLimits) -> Speeds:
    """Return speeds that no robot with these limits exceeds.

    Generous, since others may drive it.
    """
    return Speeds(
        max(SPEED_M_S, 2 * limits.max_linear_m_s), max(SPEED_RAD_S, 2 * limits.max_angular_rad_s)
    )
