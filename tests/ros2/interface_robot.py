"""A robot of interfaces only, as a process: plain rclpy, nothing of edgevox imported.

    python interface_robot.py --namespace /robot1

It serves ``honk`` (SetBool), ``fold`` (Trigger) and the action ``dock`` (ExecuteSkill's type stands
in for a docking action's), says its ``temperature`` and whether the ``door`` is open, and listens
to ``lamp``. What it was asked stands on ``asked``. A string on ``do`` changes it while it runs:
refuse, hang, abort, lie or obey, open or shut (the door) silent (no temperature) or heard. With
``--changed`` its horn, lamp and thermometer have other types, as after an update.
"""

import argparse
import contextlib
import json
import threading

import rclpy
from rclpy.action import ActionServer, CancelResponse, GoalResponse
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import ExternalShutdownException, MultiThreadedExecutor
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile
from sensor_msgs.msg import Temperature
from std_msgs.msg import Bool, Int32, String
from std_srvs.srv import SetBool, Trigger

from edgevox_msgs.action import ExecuteSkill

PERIOD_S = 0.1
PAUSE_S = 0.05


class InterfaceRobot(Node):
    def __init__(self, namespace: str, *, changed: bool = False) -> None:
        super().__init__("interfaces", namespace=namespace)
        self.mode, self.silent, self.open = "obey", False, False
        self.over = threading.Event()
        kept = QoSProfile(depth=100, durability=DurabilityPolicy.TRANSIENT_LOCAL)
        self.asked = self.create_publisher(String, "asked", kept)
        group = ReentrantCallbackGroup()
        horn = (Trigger, self.fold) if changed else (SetBool, self.honk)
        self.create_service(horn[0], "honk", horn[1], callback_group=group)
        self.create_service(Trigger, "fold", self.fold, callback_group=group)
        ActionServer(
            self,
            ExecuteSkill,
            "dock",
            self.dock,
            goal_callback=lambda _: (
                GoalResponse.REJECT if self.mode == "refuse" else GoalResponse.ACCEPT
            ),
            cancel_callback=lambda _: CancelResponse.ACCEPT,
            callback_group=group,
        )
        self.create_subscription(String, "do", self.change, 10)
        lamp = String if changed else Int32
        self.create_subscription(lamp, "lamp", lambda m: self.tell("lamp", m.data), 10)
        self.heat = Bool() if changed else Temperature(temperature=41.26)
        self.temperature = self.create_publisher(type(self.heat), "temperature", 10)
        self.door = self.create_publisher(Bool, "door", 10)
        self.create_timer(PERIOD_S, self.say)

    def tell(self, what: str, value: object) -> None:
        self.asked.publish(String(data=json.dumps([what, value])))

    def change(self, message: String) -> None:
        match message.data:
            case "open" | "shut":
                self.open = message.data == "open"
            case "silent" | "heard":
                self.silent = message.data == "silent"
            case mode:
                self.mode = mode
        self.tell("do", message.data)

    def say(self) -> None:
        self.door.publish(Bool(data=self.open))
        if not self.silent:
            self.temperature.publish(self.heat)

    def honk(self, request: SetBool.Request, response: SetBool.Response) -> SetBool.Response:
        self.tell("honk", request.data)
        while self.mode == "hang" and not self.over.wait(PAUSE_S):
            pass
        response.success = self.mode != "refuse"
        response.message = "Traceback: no horn"
        return response

    def fold(self, _: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
        self.tell("fold", None)
        response.success = True
        response.message = "seven"
        return response

    def dock(self, goal) -> ExecuteSkill.Result:
        self.tell("dock", [goal.request.skill_name, goal.request.arguments_json])
        goal.publish_feedback(ExecuteSkill.Feedback(feedback_json='{"progress": 0.5}'))
        while self.mode == "hang" and not self.over.wait(PAUSE_S):
            if goal.is_cancel_requested:
                self.tell("cancelled", goal.request.skill_name)
                goal.canceled()
                return ExecuteSkill.Result()
        if self.mode == "abort":
            goal.abort()
        else:
            goal.succeed()
        return ExecuteSkill.Result(ok=self.mode != "lie", result_json="slot 3")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--namespace", default="/")
    parser.add_argument("--changed", action="store_true")
    options = parser.parse_args()
    rclpy.init(args=[])
    robot = InterfaceRobot(options.namespace, changed=options.changed)
    executor = MultiThreadedExecutor(4)
    executor.add_node(robot)
    try:
        with contextlib.suppress(ExternalShutdownException, KeyboardInterrupt):
            while rclpy.ok():
                executor.spin_once(timeout_sec=1.0)  # a wake-up may be lost
    finally:  # whatever a shutdown in the middle raises: who hangs is waited for at the exit
        robot.over.set()


if __name__ == "__main__":
    main()
