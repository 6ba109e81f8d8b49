"""A simulated robot on two wheels, as a process: plain rclpy, nothing of edgevox imported.

    python wheeled_robot.py --namespace /robot1 --takes-goals

It listens to cmd_vel with a watchdog of its own and publishes odom 20 times a second. With
--takes-goals it drives to what comes on goal_pose by itself. A string on ``do`` changes it while it
runs: silent, heard, stuck, free, runaway, obedient, spinning, wall with the metres to it, or a lie:
claim or length (an x, or a quaternion's length, that is not so; truth ends both), jump or correct
(so many metres in its odometry, or in map -> odom), blind (scans of no angle) or sighted; or anew,
which ends all that and puts it back to its start. What was changed is said on ``done``.
"""

import argparse
import contextlib
import math

import rclpy
from geometry_msgs.msg import PoseStamped, TransformStamped, Twist
from nav_msgs.msg import Odometry
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from sensor_msgs.msg import LaserScan
from std_msgs.msg import String

from tf2_msgs.msg import TFMessage

STEP_S = 0.05
WATCHDOG_S = 0.5
MAX_LINEAR_M_S2, MAX_ANGULAR_RAD_S2 = 1.5, 6.0
FAST = 0.6
BEAMS = 181


class WheeledRobot(Node):
    def __init__(self, options: argparse.Namespace) -> None:
        super().__init__("wheels", namespace=options.namespace)
        self.options = options
        self.now = 0.0
        reliability = getattr(ReliabilityPolicy, options.reliability.upper())
        quality = QoSProfile(depth=5, reliability=reliability)
        self.odom = self.create_publisher(Odometry, "odom", quality)
        self.scan = self.create_publisher(LaserScan, "scan", quality) if options.scan else None
        self.create_subscription(Twist, "cmd_vel", self.take, 10)
        self.create_subscription(String, "do", self.change, 10)
        if options.takes_goals:
            self.create_subscription(PoseStamped, "goal_pose", self.head_for, 10)
        if options.map_to_odom:
            latched = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
            self.transforms = self.create_publisher(TFMessage, "/tf_static", latched)
        self.done = self.create_publisher(String, "done", 10)
        self.begin()
        self.create_timer(STEP_S, self.step)

    def begin(self) -> None:
        """Be as at the start."""
        self.x, self.y, self.yaw = self.options.start
        self.linear = self.angular = 0.0
        self.asked, self.asked_at = (0.0, 0.0), -1.0
        self.goal: tuple[float, float, float] | None = None
        self.silent = self.stuck = self.runaway = self.spinning = self.blind = False
        self.claim: float | None = None
        self.length, self.jumped = 1.0, 0.0
        self.wall: float | None = None
        if self.options.map_to_odom:
            self.say_transform(*self.options.map_to_odom)

    def take(self, message: Twist) -> None:
        self.asked, self.asked_at = (message.linear.x, message.angular.z), self.now

    def change(self, message: String) -> None:
        word, _, number = message.data.partition(" ")
        self.silent = {"silent": True, "heard": False}.get(word, self.silent)
        self.stuck = {"stuck": True, "free": False}.get(word, self.stuck)
        self.runaway = {"runaway": True, "obedient": False}.get(word, self.runaway)
        self.spinning = {"spinning": True, "obedient": False}.get(word, self.spinning)
        self.blind = {"blind": True, "sighted": False}.get(word, self.blind)
        value = float(number) if number else None
        if word == "anew":
            self.begin()
        elif word == "wall":
            self.wall = value
        elif word in ("claim", "truth"):
            self.claim, self.length = value, 1.0
        elif word == "length":
            self.length = value
        elif word == "jump":
            self.jumped += value
        elif word == "correct":
            x, y, yaw = self.options.map_to_odom
            self.say_transform(x + value, y, yaw)
        self.done.publish(message)

    def head_for(self, message: PoseStamped) -> None:
        at, rotation = message.pose.position, message.pose.orientation
        pose = (at.x, at.y, 2 * math.atan2(rotation.z, rotation.w))
        in_map = message.header.frame_id.endswith("map")
        self.goal = pose if in_map else compose(self.options.map_to_odom, pose)

    def step(self) -> None:
        self.now += STEP_S
        linear, angular = self.wanted()
        self.linear += clamp(linear - self.linear, MAX_LINEAR_M_S2 * STEP_S)
        self.angular += clamp(angular - self.angular, MAX_ANGULAR_RAD_S2 * STEP_S)
        if self.stuck:
            self.linear = self.angular = 0.0
        self.yaw = math.remainder(self.yaw + self.angular * STEP_S, math.tau)
        self.x += self.linear * math.cos(self.yaw) * STEP_S
        self.y += self.linear * math.sin(self.yaw) * STEP_S
        if not self.silent:
            self.say_odometry()
        if self.scan:
            self.say_scan()

    def wanted(self) -> tuple[float, float]:
        if self.runaway:
            return 0.3, 0.0
        if self.now - self.asked_at < WATCHDOG_S:
            return (0.0, 0.8) if self.spinning and self.asked != (0.0, 0.0) else self.asked
        return self.towards_goal() if self.goal else (0.0, 0.0)

    def towards_goal(self) -> tuple[float, float]:
        x, y, yaw = self.goal
        left = math.hypot(x - self.x, y - self.y)
        if left < 0.05:
            off = math.remainder(yaw - self.yaw, math.tau)
            if abs(off) < 0.05:
                self.goal = None
            return 0.0, clamp(2 * off, 1.0)
        off = math.remainder(math.atan2(y - self.y, x - self.x) - self.yaw, math.tau)
        return (min(FAST, left) if abs(off) < 0.3 else 0.0), clamp(2 * off, 1.0)

    def say_odometry(self) -> None:
        prefix = self.options.frame_prefix
        message = Odometry()
        message.header.stamp = self.get_clock().now().to_msg()
        message.header.frame_id = f"{prefix}odom"
        message.child_frame_id = f"{prefix}base_link"
        x, y, yaw = compose(invert(self.options.map_to_odom), (self.x, self.y, self.yaw))
        message.pose.pose.position.x = x + self.jumped if self.claim is None else self.claim
        message.pose.pose.position.y = y
        message.pose.pose.orientation.z = self.length * math.sin(yaw / 2)
        message.pose.pose.orientation.w = self.length * math.cos(yaw / 2)
        message.twist.twist.linear.x = self.linear
        message.twist.twist.angular.z = self.angular
        self.odom.publish(message)

    def say_scan(self) -> None:
        message = LaserScan()
        message.header.stamp = self.get_clock().now().to_msg()
        message.header.frame_id = f"{self.options.frame_prefix}laser"
        message.angle_min, message.angle_max = -math.pi / 2, math.pi / 2
        message.angle_increment = math.nan if self.blind else math.pi / (BEAMS - 1)
        message.range_min, message.range_max = 0.05, 10.0
        far = [math.inf] * BEAMS
        if self.wall is not None:
            for beam in range(BEAMS // 2 - 15, BEAMS // 2 + 16):
                far[beam] = self.wall
        message.ranges = far
        self.scan.publish(message)

    def say_transform(self, x: float, y: float, yaw: float) -> None:
        message = TransformStamped()
        message.header.frame_id = "map"
        message.child_frame_id = f"{self.options.frame_prefix}odom"
        message.transform.translation.x, message.transform.translation.y = x, y
        message.transform.rotation.z = math.sin(yaw / 2)
        message.transform.rotation.w = math.cos(yaw / 2)
        self.transforms.publish(TFMessage(transforms=[message]))


def compose(one, other):
    x, y, yaw = one or (0.0, 0.0, 0.0)
    cos, sin = math.cos(yaw), math.sin(yaw)
    ox, oy, oyaw = other
    return x + cos * ox - sin * oy, y + sin * ox + cos * oy, math.remainder(yaw + oyaw, math.tau)


def invert(one):
    x, y, yaw = one or (0.0, 0.0, 0.0)
    cos, sin = math.cos(yaw), math.sin(yaw)
    return -(cos * x + sin * y), sin * x - cos * y, -yaw


def clamp(value: float, most: float) -> float:
    return min(max(value, -most), most)


def pose(text: str) -> tuple[float, ...]:
    return tuple(float(part) for part in text.split(","))


def main() -> None:
    parser = argparse.ArgumentParser()
    parser.add_argument("--namespace", default="/")
    parser.add_argument("--frame-prefix", default="")
    parser.add_argument("--start", type=pose, default=(0.0, 0.0, 0.0))
    parser.add_argument("--map-to-odom", type=pose, default=None)
    parser.add_argument("--reliability", choices=("reliable", "best_effort"), default="best_effort")
    parser.add_argument("--takes-goals", action="store_true")
    parser.add_argument("--scan", action="store_true")
    options = parser.parse_args()
    rclpy.init()
    with contextlib.suppress(KeyboardInterrupt, ExternalShutdownException):
        rclpy.spin(WheeledRobot(options))


if __name__ == "__main__":
    main()
