"""A robot in a process of its own, a body that drives it, and goals for that body."""

import contextlib
import os
import subprocess
import sys
import threading
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from geometry_msgs.msg import Twist
from peer import Peer
from waiting import wait_until

from edgevox.core.cancel import CancelToken
from edgevox.ros2.external.robot import ExternalRobot

HERE = Path(__file__).parent
EXAMPLES = HERE.parents[1] / "examples" / "robot_file"
LEAVES_S = 20.0
"""For a stand-in to leave by itself, so that others need not find out that it is gone."""


def wheels(*arguments: str, domain: int, namespace: str = "/"):
    """The process of a robot on wheels."""
    return robot_process("wheeled_robot.py", *arguments, domain=domain, namespace=namespace)


@contextlib.contextmanager
def robot_process(script: str, *arguments: str, domain: int, namespace: str):
    """A robot in a process of its own: a script of this folder, or of the robot files' examples."""
    path = HERE / script
    environment = {
        **os.environ,
        "PYTHONPATH": os.pathsep.join([str(EXAMPLES), os.environ.get("PYTHONPATH", "")]),
        "ROS_DOMAIN_ID": str(domain),
        "ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST",
    }
    process = subprocess.Popen(
        [
            sys.executable,
            str(path if path.is_file() else EXAMPLES / script),
            "--namespace",
            namespace,
            *arguments,
        ],
        env=environment,
        stdin=subprocess.PIPE,
        text=True,
    )
    try:
        yield process
    finally:
        process.terminate()
        with contextlib.suppress(subprocess.TimeoutExpired):  # how it ends is not what is tested
            process.wait(LEAVES_S)
        process.kill()  # or else it haunts the tests that follow
        process.wait()


class Velocities:
    """What was asked on a robot's cmd_vel, as (linear, angular)."""

    def __init__(self, peer: Peer, topic: str) -> None:
        self.heard: list[tuple[float, float]] = []
        subscription = peer.node.create_subscription(Twist, topic, self._hear, 100)
        wait_until(lambda: subscription.get_publisher_count() > 0, topic)

    def _hear(self, message: Twist) -> None:
        self.heard.append((message.linear.x, message.angular.z))

    @property
    def moving(self) -> list[tuple[float, float]]:
        return [one for one in self.heard if one != (0.0, 0.0)]


class Drive:
    """A `drive_to` on a thread of its own."""

    def __init__(self, run: Callable[[CancelToken, Callable[..., None]], None]) -> None:
        self.token = CancelToken()
        self.reports: list[dict[str, object]] = []
        self._pool = ThreadPoolExecutor(1)
        self._future = self._pool.submit(run, self.token, self._report)

    def _report(self, **feedback: object) -> None:
        self.reports.append(feedback)

    def result(self, timeout_s: float = 60.0) -> None:
        """Wait for its end; raises what it raised."""
        try:
            self._future.result(timeout_s)
        finally:
            self._pool.shutdown(wait=False)


def drive(robot: ExternalRobot, x_m: float, y_m: float) -> Drive:
    return Drive(lambda token, report: robot.drive_to(x_m, y_m, token=token, report=report))


def drive_to_place(robot: ExternalRobot, place: str) -> Drive:
    return Drive(lambda token, report: robot.drive_to_place(place, token=token, report=report))


def heard(robot: ExternalRobot) -> None:
    wait_until(lambda: robot.state()["pose"] is not None, "odometry")


def moving(robot: ExternalRobot, timeout_s: float = 60.0) -> None:
    wait_until(lambda: speed(robot) > 0.05, "motion", timeout_s)


def standing(robot: ExternalRobot, timeout_s: float = 60.0) -> None:
    wait_until(lambda: speed(robot) < 0.01, "stillness", timeout_s)


def speed(robot: ExternalRobot) -> float:
    velocity = robot.state()["velocity"]
    return abs(velocity["linear"]) + abs(velocity["angular"]) if velocity else 0.0


class Goal:
    """A goal handle for calling a skill."""

    def __init__(self) -> None:
        self.token = CancelToken()
        self.reports: list[dict[str, object]] = []
        self.reported = threading.Event()

    def report(self, **feedback: object) -> None:
        self.reports.append(feedback)
        self.reported.set()
