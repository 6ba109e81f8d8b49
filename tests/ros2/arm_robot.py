"""An arm behind a trajectory controller and a gripper controller, as ros2_control serves them."""

from control_msgs.action import FollowJointTrajectory, GripperCommand
from sensor_msgs.msg import JointState
from stand_in import StandIn, main

JOINTS = [f"joint{number}" for number in range(1, 8)]
STEPS = 4
GOAL_TOLERANCE_VIOLATED = -5
THING_M = 0.012
"""What lies between the fingers, if something does."""


class Arm(StandIn):
    """Obeys; when it lies it succeeds and has not moved, as its own result says."""

    def __init__(self, namespace: str) -> None:
        super().__init__(namespace)
        self.joints = [0.0] * len(JOINTS)
        self.gap_m, self.thing = 0.04, False
        self.wanted_m = self.gap_m
        self.states = self.create_publisher(JointState, "joint_states", 10)
        self.acts(
            FollowJointTrajectory,
            "arm_controller/follow_joint_trajectory",
            self.follow,
            lambda: FollowJointTrajectory.Result(
                error_code=GOAL_TOLERANCE_VIOLATED if self.mode == "lie" else 0
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

    def follow(self, goal) -> bool:
        for _ in range(STEPS):
            if goal.is_cancel_requested or not self.pause():
                return False
        if self.mode == "obey":
            self.joints = list(goal.request.trajectory.points[-1].positions)
        return True

    def grip(self, goal) -> bool:
        self.wanted_m = goal.request.command.position
        if self.mode == "obey":
            self.gap_m = max(self.wanted_m, THING_M if self.thing else 0.0)
        return True

    def change(self, change: str) -> bool:
        self.thing = {"full": True, "empty": False}.get(change, self.thing)
        return change in ("full", "empty")

    def say(self) -> None:
        stamp = self.get_clock().now().to_msg()
        state = JointState(name=JOINTS, position=self.joints)
        state.header.stamp = stamp
        self.states.publish(state)


if __name__ == "__main__":
    main(Arm, __doc__)
