"""A UR5e that stands in for a real one: MoveIt's action, the driver's modes, a gripper's action."""

from control_msgs.action import GripperCommand
from moveit_msgs.action import MoveGroup
from moveit_msgs.msg import MoveItErrorCodes
from sensor_msgs.msg import JointState
from stand_in import LATCHED, StandIn, main, plain
from std_srvs.srv import Trigger
from ur_dashboard_msgs.msg import RobotMode, SafetyMode
from ur_msgs.srv import SetIO, SetSpeedSliderFraction

JOINTS = ["shoulder_pan", "shoulder_lift", "elbow", "wrist_1", "wrist_2", "wrist_3"]
STEPS = 4
THING_M = 0.012
"""What lies between the fingers, if something does."""
HOW = {"abort": MoveItErrorCodes.PLANNING_FAILED, "lie": MoveItErrorCodes.CONTROL_FAILED}
MODES = {"power_on": RobotMode.IDLE, "brake_release": RobotMode.RUNNING}


class Arm(StandIn):
    """Obeys; when it lies it succeeds and has not moved, as its own result says."""

    def __init__(self, namespace: str) -> None:
        super().__init__(namespace)
        self.joints = {f"{one}_joint": 0.0 for one in JOINTS}
        self.gap_m, self.thing = 0.04, False
        self.wanted_m = self.gap_m
        status = "io_and_status_controller"
        self.states = self.create_publisher(JointState, "joint_states", 10)
        self.modes = self.create_publisher(RobotMode, f"{status}/robot_mode", LATCHED)
        self.safeties = self.create_publisher(SafetyMode, f"{status}/safety_mode", LATCHED)
        self.acts(
            MoveGroup,
            "move_action",
            self.move,
            lambda: MoveGroup.Result(
                error_code=MoveItErrorCodes(val=HOW.get(self.mode, MoveItErrorCodes.SUCCESS))
            ),
        )
        self.acts(
            GripperCommand,
            "gripper_controller/gripper_cmd",
            self.grip,
            lambda: GripperCommand.Result(
                position=self.gap_m,
                stalled=self.gap_m > self.wanted_m,
                reached_goal=self.gap_m == self.wanted_m,
            ),
        )
        for name, mode in MODES.items():
            self.serves(Trigger, f"dashboard_client/{name}", lambda mode=mode: self.be(mode))
        self.serves(Trigger, "dashboard_client/unlock_protective_stop", self.be)
        self.serves(SetSpeedSliderFraction, f"{status}/set_speed_slider")
        self.serves(SetIO, f"{status}/set_io")
        self.be(RobotMode.RUNNING)

    def be(self, mode: int | None = None, safety: int = SafetyMode.NORMAL) -> None:
        """Tell its modes, which it keeps telling to whoever comes later."""
        if mode is not None:
            self.modes.publish(RobotMode(mode=mode))
        self.safeties.publish(SafetyMode(mode=safety))

    def serves(self, kind, name: str, then=lambda: None) -> None:
        """A service that works, unless the robot refuses."""

        def answer(request, response):
            self.tell(name, plain(request))
            response.success = self.mode != "refuse"
            if hasattr(response, "message"):
                response.message = "Done" if response.success else "it is in local control."
            if response.success:
                then()
            return response

        self.create_service(kind, name, answer, callback_group=self.group)

    def move(self, goal) -> bool:
        for _ in range(STEPS):
            goal.publish_feedback(MoveGroup.Feedback(state="MONITOR"))
            if goal.is_cancel_requested or not self.pause():
                return False
        if self.mode == "obey":
            for one in goal.request.request.goal_constraints[0].joint_constraints:
                self.joints[one.joint_name] = one.position
        return True

    def grip(self, goal) -> bool:
        self.wanted_m = goal.request.command.position
        if self.mode == "obey":
            self.gap_m = max(self.wanted_m, THING_M if self.thing else 0.0)
        return True

    def change(self, change: str) -> bool:
        self.thing = {"full": True, "empty": False}.get(change, self.thing)
        if change == "sleep":
            self.mode = "obey"
            self.be(RobotMode.POWER_OFF)
        elif change == "bump":
            self.be(safety=SafetyMode.PROTECTIVE_STOP)
        return change in ("full", "empty", "sleep", "bump")

    def say(self) -> None:
        stamp = self.get_clock().now().to_msg()
        state = JointState(name=[*self.joints], position=[*self.joints.values()])
        state.header.stamp = stamp
        self.states.publish(state)


if __name__ == "__main__":
    main(Arm, __doc__)
