"""A robot whose driver uses other types than EdgeVox's usual ones: plain rclpy, nothing of edgevox.

    python typed_robot.py --namespace /robot1 --cmd-vel TwistStamped --scan PointCloud2

It integrates the velocities that it takes, with a watchdog of 0.5 s, and publishes odom 20 times a
second. `--odom` is the topic of its odometry, a type's name for one that is none, or empty for a
node that only takes velocities. Velocities
whose stamp is older than 0.5 s are refused, as ros2_control's diff_drive_controller does. Its clock
is `--ahead` seconds ahead. Each line on standard input is a type that `cmd_vel` has from then on,
as after a restart of its driver.
"""

import argparse
import contextlib
import io
import math
import struct
import sys
import threading

import rclpy
from geometry_msgs.msg import PoseStamped, TransformStamped, Twist, TwistStamped
from nav_msgs.msg import Odometry
from PIL import Image as Pillow
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile, qos_profile_sensor_data
from rclpy.time import Time
from rclpy.utilities import remove_ros_args
from sensor_msgs.msg import CompressedImage, PointCloud2, PointField
from std_msgs.msg import Float32, String

from tf2_msgs.msg import TFMessage

STEP_S = 0.05
OLD_S = 0.5
TYPES = {"Twist": Twist, "TwistStamped": TwistStamped, "Float32": Float32}


class TypedRobot(Node):
    def __init__(self, options: argparse.Namespace) -> None:
        super().__init__("typed", namespace=options.namespace)
        self.options = options
        self.now = self.asked_at = 0.0
        self.x = self.yaw = 0.0
        self.y = 0.0
        self.asked = (0.0, 0.0)
        self.zeros = 0
        kind = PoseStamped if options.odom == "PoseStamped" else Odometry
        topic = "odom" if options.odom == "PoseStamped" else options.odom
        if topic:
            self.odom = self.create_publisher(kind, topic, qos_profile_sensor_data)
        self.taken = self.create_publisher(String, "taken", 10)
        self.wheels = None
        self.take_as(options.cmd_vel)
        if options.scan:
            self.cloud = self.create_publisher(PointCloud2, "scan", qos_profile_sensor_data)
            latched = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
            self.transforms = self.create_publisher(TFMessage, "/tf_static", latched)
            self.say_mount()
        if options.camera:
            self.camera = self.create_publisher(
                CompressedImage, "camera/image_raw", qos_profile_sensor_data
            )
        self.create_timer(STEP_S, self.step)
        self.next: list[str] = []

    def take_as(self, name: str) -> None:
        if self.wheels:
            self.destroy_subscription(self.wheels)
        kept = (
            DurabilityPolicy.TRANSIENT_LOCAL if self.options.latched else DurabilityPolicy.VOLATILE
        )
        quality = QoSProfile(depth=10, durability=kept)
        self.wheels = self.create_subscription(TYPES[name], "cmd_vel", self.take, quality)

    def stamp(self, past_s: float = 0.0) -> Time:
        return self.get_clock().now() + rclpy.duration.Duration(seconds=self.options.ahead - past_s)

    def take(self, message) -> None:
        if isinstance(message, Float32):
            return
        stamped = isinstance(message, TwistStamped)
        if stamped:
            age_s = (self.stamp() - Time.from_msg(message.header.stamp)).nanoseconds / 1e9
            if abs(age_s) > OLD_S:
                return
        twist = message.twist if stamped else message
        self.asked, self.asked_at = (twist.linear.x, twist.angular.z), self.now
        kind = type(message).__name__
        frame = message.header.frame_id if stamped else ""
        self.taken.publish(String(data=f"{kind} {self.asked[0]:.2f} {self.asked[1]:.2f} {frame}"))

    def step(self) -> None:
        while self.next:
            self.take_as(self.next.pop(0))
        self.now += STEP_S
        linear, angular = self.asked if self.now - self.asked_at < OLD_S else (0.0, 0.0)
        self.yaw += angular * STEP_S
        self.x += linear * math.cos(self.yaw) * STEP_S
        self.y += linear * math.sin(self.yaw) * STEP_S
        if not self.options.odom:
            return
        if self.options.odom == "PoseStamped":
            self.odom.publish(PoseStamped())
        else:
            self.say_odometry(linear, angular)
        if self.options.scan:
            self.say_cloud(self.options.scan)
        if self.options.camera:
            self.say_picture()

    def say_odometry(self, linear: float, angular: float) -> None:
        message = Odometry()
        message.header.stamp = self.stamp().to_msg()
        message.header.frame_id, message.child_frame_id = "odom", "base_link"
        message.pose.pose.position.x, message.pose.pose.position.y = self.x, self.y
        message.pose.pose.orientation.z = math.sin(self.yaw / 2)
        message.pose.pose.orientation.w = math.cos(self.yaw / 2)
        message.twist.twist.linear.x, message.twist.twist.angular.z = linear, angular
        self.odom.publish(message)

    def say_mount(self) -> None:
        """A depth camera half a metre up, as optical frames look: z ahead, x right, y down."""
        message = TransformStamped()
        message.header.frame_id, message.child_frame_id = "base_link", "depth_optical"
        message.transform.translation.z = 0.5
        turn = message.transform.rotation
        turn.x, turn.y, turn.z, turn.w = -0.5, 0.5, -0.5, 0.5
        self.transforms.publish(TFMessage(transforms=[message]))

    def say_cloud(self, wall_m: float) -> None:
        """A wall ahead of it, and the floor before that."""
        message = PointCloud2()
        message.header.stamp = self.stamp().to_msg()
        message.header.frame_id = "depth_optical"
        wall = [(-aside / 20, up / 20, wall_m) for aside in range(-20, 21) for up in range(-8, 8)]
        floor = [(-aside / 20, 0.5, 0.4) for aside in range(-20, 21)]
        points = wall + floor
        message.fields = [
            PointField(name=name, offset=4 * at, datatype=PointField.FLOAT32, count=1)
            for at, name in enumerate(("x", "y", "z", "rgb"))
        ]
        message.point_step, message.height, message.width = 16, 1, len(points)
        message.row_step = 16 * len(points)
        message.data = b"".join(struct.pack("<4f", *point, 0.0) for point in points)
        self.cloud.publish(message)

    def say_picture(self) -> None:
        file = io.BytesIO()
        Pillow.new("RGB", (32, 16), (200, 10, 20)).save(file, "PNG")
        self.camera.publish(CompressedImage(format="rgb8; png compressed", data=file.getvalue()))


def main() -> None:
    parser = argparse.ArgumentParser()
    parser.add_argument("--namespace", default="/")
    parser.add_argument("--cmd-vel", choices=TYPES, default="Twist")
    parser.add_argument("--odom", default="odom")
    parser.add_argument("--scan", type=float, help="metres to the wall of a point cloud")
    parser.add_argument("--latched", action="store_true", help="asks for kept velocities")
    parser.add_argument("--camera", action="store_true")
    parser.add_argument("--ahead", type=float, default=0.0)
    options = parser.parse_args(remove_ros_args(sys.argv)[1:])
    rclpy.init()
    robot = TypedRobot(options)

    def listen() -> None:
        for line in sys.stdin:
            robot.next.append(line.strip())

    threading.Thread(target=listen, daemon=True).start()
    with contextlib.suppress(KeyboardInterrupt, ExternalShutdownException):
        rclpy.spin(robot)


if __name__ == "__main__":
    main()
