"""The harness that plays a scenario on a robot over its topics, in real time.

It calls skills by the action `execute_skill`, if that interface is built.
"""

import json
import threading
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from geometry_msgs.msg import Twist
from rclpy.action import ActionClient
from rclpy.executors import Executor
from rclpy.node import Node
from rclpy.qos import QoSProfile
from std_msgs.msg import String

from edgevox.core.agent_events import AgentEventKind
from edgevox.core.clock import Clock, SystemClock
from edgevox.core.errors import EdgeVoxError, InvalidValue
from edgevox.core.files.validation import read_json_object
from edgevox.core.log import get_logger, worth_a_line
from edgevox.ros2.contract import ACTION
from edgevox.ros2.contract_rows import Qos
from edgevox.ros2.messages import profile
from edgevox.ros2.node import RosNode
from edgevox.ros2.standard_topics import STANDARD
from edgevox.scenario import Scenario
from edgevox.scenario.format import DriveStep, RunStep
from edgevox.scenario.judge import Seen, Source

log = get_logger(__name__)


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
        """Return whether a server exists. Raises `EdgeVoxError` if the interface is not built."""
        if self._client is None:
            raise EdgeVoxError(f"{ACTION[0]}: edgevox_msgs is not built; make msgs")
        return bool(self._client.server_is_ready())

    def start(self, skill: str, arguments_json: str) -> bool:
        """Return whether the goal was accepted. Raises `EdgeVoxError` if no server answers."""
        self.there()
        goal = self._kind.Goal(skill_name=skill, arguments_json=arguments_json)

        async def ask() -> bool:
            handle = await self._client.send_goal_async(goal)
            self._handles.append((handle, handle.get_result_async() if handle.accepted else None))
            return bool(handle.accepted)

        return bool(self._on_executor(ask))

    def _on_executor(self, work: Callable[[], Any]) -> Any:
        """Run `work` on the executor.

        Rclpy misses an answer that is faster than its own bookkeeping.
        """
        done = threading.Event()
        task = self._executor.create_task(work)
        task.add_done_callback(lambda _: done.set())
        if not done.wait(ANSWER_S):
            raise EdgeVoxError(f"{ACTION[0]}: no answer within {ANSWER_S:g} s")
        return task.result()


DEPTH = 100
_RELIABLE = profile(Qos.RELIABLE, at_least=DEPTH)
_STATE = profile(Qos.STATE, at_least=DEPTH)
SETTLE_S = 0.15
"""A state this long after a stimulus shows the stimulus's effect."""
MOST_SETTLE_S = 2.0
MOST_GUESS_S = 0.25
"""Seconds by which the robot's time may be extrapolated from its last state."""
_BODY_S = 3.0
"""Seconds within which the first `robot_state` of a present robot comes."""


@dataclass(frozen=True, slots=True)
class _Moment:
    """The robot's time, and the machine's when that was heard."""

    robot_s: float
    heard_s: float


class TopicHarness:
    """Gives stimuli on topics and collects the reactions, until `close`.

    The robot's time is that of `robot_state`; a node without a body uses the machine's.
    """

    def __init__(self, ros: RosNode, *, clock: Clock | None = None) -> None:
        self._clock = clock or SystemClock()
        self._node = ros.node
        self._changed = threading.Condition()
        self._seen: list[Seen] = []
        self._heard: dict[str, int] = {}
        self._began_s = self._clock.now()
        self._robot: _Moment | None = None
        self._touched = False
        self._name = ""
        self._broken = 0
        self._text = self._node.create_publisher(String, "text_input", _RELIABLE)
        self._stop = self._node.create_publisher(String, "interrupt", _RELIABLE)
        self._velocity = self._node.create_publisher(
            Twist, "cmd_vel", profile(STANDARD["cmd_vel"].qos)
        )
        self._skills = SkillClient(self._node, ros.executor)
        self._listen("transcription", self._count)
        self._listen("metrics", self._count)
        self._listen("state", self._count, _STATE)
        self._listen("response", self._on_answer)
        self._listen("agent_event", self._on_event)
        self._listen("robot_state", self._on_state, _STATE)

    def close(self) -> None:
        """A robot that was given a stimulus is left standing."""
        if self._touched:
            self.interrupt(MOST_SETTLE_S)
        self._skills.close()

    def wait_for_robot(self, scenario: Scenario, timeout_s: float) -> None:
        """Block until all that the scenario needs is there. Raises `EdgeVoxError` if it is not."""
        answers = self._at("response")
        needed: dict[str, Callable[[], bool]] = {
            "publisher of state": lambda: "state" in self._heard,
            # Two nodes of one name would both answer; one that was killed fades in 20 s.
            "single publisher of response": lambda: self._node.count_publishers(answers) == 1,
            "subscriber of text_input": lambda: self._text.get_subscription_count() > 0,
            "subscriber of interrupt": lambda: self._stop.get_subscription_count() > 0,
        }
        if any(isinstance(step, RunStep) for step in scenario.steps):
            needed["action execute_skill"] = self._skills.there
        if any(isinstance(step, DriveStep) for step in scenario.steps):
            needed["subscriber of cmd_vel"] = lambda: self._velocity.get_subscription_count() > 0
        if not self._wait(lambda: all(there() for there in needed.values()), timeout_s):
            missing = ", ".join(what for what, there in needed.items() if not there())
            raise EdgeVoxError(f"{self._node.get_namespace()}: no {missing} after {timeout_s:g} s")
        self._wait(lambda: self._robot is not None, _BODY_S)
        if scenario.agent and self._name not in scenario.agent:
            raise InvalidValue("agent", self._name, "one of " + ", ".join(scenario.agent))

    @property
    def name(self) -> str:
        """The robot's own name, else the node's namespace."""
        return self._name or self._node.get_namespace()

    @property
    def time_s(self) -> float:
        now_s = self._clock.now()
        if (last := self._robot) is None:
            return now_s - self._began_s
        return last.robot_s + min(now_s - last.heard_s, MOST_GUESS_S)

    def say(self, text: str, timeout_s: float) -> None:
        """Say it, and wait until its turn is over, or until a stop word has stopped the robot."""
        self._touched = True
        before = dict(self._heard)
        self._text.publish(String(data=text))

        def answered() -> bool:
            new = {name: count - before.get(name, 0) for name, count in self._heard.items()}
            stopped = new.get(AgentEventKind.SAFETY_PREEMPT, 0) and new.get("response", 0)
            return bool(new.get("transcription", 0) and (new.get("metrics", 0) or stopped))

        self._wait(answered, timeout_s)
        self._settle()

    def interrupt(self, timeout_s: float) -> None:  # noqa: ARG002 - it is over when it is done
        self._stop.publish(String(data="scenario"))
        self._settle()

    def run(self, skill: str, arguments: Mapping[str, Any]) -> None:
        """Start a skill as the action does. Raises `InvalidValue` if it is refused."""
        self._touched = True
        accepted = self._skills.start(skill, json.dumps(dict(arguments)))
        self._settle()
        if not accepted:
            with self._changed:
                told = [one.data.get("error") for one in self._seen if one.source is Source.EVENT]
            raise EdgeVoxError(str(told[-1]) if told and told[-1] else f"{skill} was refused")

    def steer(self, linear_m_s: float, angular_rad_s: float) -> None:
        self._touched = True
        twist = Twist()
        twist.linear.x, twist.angular.z = linear_m_s, angular_rad_s
        self._velocity.publish(twist)

    def let_pass(self, seconds: float) -> Sequence[Seen]:
        self._wait(lambda: bool(self._seen), seconds)
        return self.look()

    def look(self) -> Sequence[Seen]:
        with self._changed:
            seen, self._seen = self._seen, []
        return seen

    def _settle(self) -> None:
        """Wait for a state that shows what was done."""
        since_s = self._clock.now() + SETTLE_S
        if self._robot is None:
            self._wait(lambda: False, SETTLE_S)
        else:
            self._wait(lambda: self._heard_s >= since_s, MOST_SETTLE_S)

    @property
    def _heard_s(self) -> float:
        """Arrival time of the last state."""
        return self._robot.heard_s if self._robot else 0.0

    def _wait(self, condition: Callable[[], bool], timeout_s: float) -> bool:
        """Look whenever something is heard, and now and then: the graph tells nobody."""
        deadline_s = self._clock.now() + timeout_s
        with self._changed:
            while not condition():
                left_s = deadline_s - self._clock.now()
                if left_s <= 0.0:
                    return False
                self._changed.wait(min(left_s, 0.05))
        return True

    def _listen(
        self, topic: str, take: Callable[[str, str], None], qos: QoSProfile = _RELIABLE
    ) -> None:
        def hear(message: String) -> None:
            with self._changed:
                take(topic, message.data)
                self._heard[topic] = self._heard.get(topic, 0) + 1
                self._changed.notify_all()

        self._node.create_subscription(String, topic, hear, qos)

    def _count(self, _topic: str, _text: str) -> None:
        """Do nothing more: the arrival alone counts."""

    def _on_answer(self, _topic: str, text: str) -> None:
        self._seen.append(Seen(self.time_s, Source.ANSWER, text))

    def _on_event(self, _topic: str, text: str) -> None:
        data = self._read(text)
        kind = str(data.get("kind"))
        self._heard[kind] = self._heard.get(kind, 0) + 1
        self._seen.append(Seen(self.time_s, Source.EVENT, data))

    def _on_state(self, _topic: str, text: str) -> None:
        data = self._read(text)
        now_s, time_s = self._clock.now(), data.get("time")
        self._robot = _Moment(float(time_s) if isinstance(time_s, int | float) else now_s, now_s)
        self._name = str(data.get("name", ""))
        self._seen.append(Seen(self._robot.robot_s, Source.STATE, data))

    def _read(self, text: str) -> dict[str, Any]:
        try:
            return read_json_object(text, "message")
        except InvalidValue:
            self._broken += 1
            if worth_a_line(self._broken):
                log.warning("messages_not_json", broken=self._broken)
            return {}

    def _at(self, topic: str) -> str:
        return f"{self._node.get_namespace().rstrip('/')}/{topic}"
