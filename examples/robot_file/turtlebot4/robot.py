"""A base like a TurtleBot 4's: Nav2's action drives it, Create 3's interfaces dock and show it."""

import math

from irobot_create_msgs.action import Dock, Undock
from irobot_create_msgs.msg import AudioNoteVector, DockStatus, LightringLeds
from nav2_msgs.action import NavigateToPose
from nav_msgs.msg import Odometry
from sensor_msgs.msg import BatteryState
from stand_in import PAUSE_S, StandIn, main

SPEED_M_S = 0.5


class Base(StandIn):
    """Obeys; when it lies it says that it is docked, and its dock's sensor says that it is not."""

    def __init__(self, namespace: str) -> None:
        super().__init__(namespace)
        self.x, self.y, self.docked = 0.0, 0.0, True
        self.percentage = 0.874
        self.odom = self.create_publisher(Odometry, "odom", 10)
        self.battery = self.create_publisher(BatteryState, "battery_state", 10)
        self.docks = self.create_publisher(DockStatus, "dock_status", 10)
        self.hears(LightringLeds, "cmd_lightring")
        self.hears(AudioNoteVector, "cmd_audio")
        self.acts(Dock, "dock", lambda _: self.move_dock(True), self.dock_result)
        self.acts(
            Undock, "undock", lambda _: self.move_dock(False),
            lambda: Undock.Result(is_docked=self.docked),
        )  # fmt: skip
        self.acts(NavigateToPose, "navigate_to_pose", self.drive, NavigateToPose.Result)

    def move_dock(self, on: bool) -> bool:
        self.docked = on and self.mode == "obey"
        return True

    def dock_result(self) -> Dock.Result:
        return Dock.Result(is_docked=self.docked or self.mode == "lie")

    def drive(self, goal) -> bool:
        to = goal.request.pose.pose.position
        while (left := math.hypot(to.x - self.x, to.y - self.y)) > 0.01:
            if goal.is_cancel_requested or not self.pause():
                return False
            step = min(1.0, SPEED_M_S * PAUSE_S / left)
            self.x += step * (to.x - self.x)
            self.y += step * (to.y - self.y)
            goal.publish_feedback(NavigateToPose.Feedback(distance_remaining=left))
        return True

    def say(self) -> None:
        stamp = self.get_clock().now().to_msg()
        odometry = Odometry(child_frame_id="base_link")
        odometry.header.frame_id, odometry.header.stamp = "odom", stamp
        odometry.pose.pose.position.x, odometry.pose.pose.position.y = self.x, self.y
        self.odom.publish(odometry)
        self.battery.publish(BatteryState(percentage=self.percentage))
        self.docks.publish(DockStatus(dock_visible=True, is_docked=self.docked))


if __name__ == "__main__":
    main(Base, __doc__)
