"""What moves a robot that is driven over ROS 2, whatever its motion back ends do."""

import threading
from types import SimpleNamespace

import pytest
from support.clock import HeldClock

from edgevox.core.cancel import Cancelled
from edgevox.core.transforms import Pose2D
from edgevox.robots.capabilities import Twist2D
from edgevox.robots.command_mux import STILL
from edgevox.ros2.external.motion import PoseEstimate, Target
from edgevox.ros2.external.navigation import ControlLoop, ExternalNavigation
from edgevox.ros2.external.settings import Patience

HERE = PoseEstimate(Pose2D(0.0, 0.0, 0.0), STILL, "odom", 0)


class FakeBackend:
    """Takes every target, or raises `error` when it is to begin, or to drop the old one."""

    waiting = False
    patience = Patience(unmoved_s=5.0, no_nearer_s=10.0)

    def __init__(self, name: str) -> None:
        self.name = name
        self.begun: list[Target] = []
        self.cancelled = 0
        self.error: Exception | None = None

    def begin(self, target: Target, estimate: PoseEstimate) -> None:
        self.begun.append(target)
        if self.error:
            raise self.error

    def cancel(self, estimate: PoseEstimate | None) -> None:
        self.cancelled += 1


class Robot:
    """A control loop with wheels that note what they are told, and a robot that stands."""

    def __init__(self) -> None:
        self.told: list[Twist2D] = []
        senses = SimpleNamespace(
            estimate=lambda: HERE,
            odometry_history=SimpleNamespace(still=lambda: True),
            odom_topic="/odom",
        )
        wheels = SimpleNamespace(turn=self.told.append)
        goals = SimpleNamespace(recall=lambda _: None)
        self.control = ControlLoop(
            threading.RLock(), senses, wheels, goals, clock=HeldClock(), obey_s=3.0
        )

    def drive(self, backend: FakeBackend) -> ExternalNavigation:
        trust = SimpleNamespace(check=lambda _: None)
        return ExternalNavigation(Target(1.0, 0.0), backend, HERE, trust, 0.0)


@pytest.fixture
def robot() -> Robot:
    return Robot()


def test_a_driver_that_cannot_begin_leaves_no_drive_and_a_robot_that_is_held(robot) -> None:
    backend = FakeBackend("nav2")
    backend.error = RuntimeError("the action's type is another one")
    drive = robot.drive(backend)

    with pytest.raises(RuntimeError, match="another one"):
        robot.control.start(drive, HERE)

    assert robot.control.mux.motion is None
    assert drive.error is backend.error
    assert backend.cancelled == 1
    assert robot.told == [STILL]
    assert not robot.control.hold.done


def test_the_drive_before_it_is_over_too_and_the_next_one_drives(robot) -> None:
    old, new = FakeBackend("goal_pose"), FakeBackend("nav2")
    before = robot.drive(old)
    robot.control.start(before, HERE)
    new.error = RuntimeError("no")
    with pytest.raises(RuntimeError):
        robot.control.start(robot.drive(new), HERE)
    assert isinstance(before.error, Cancelled)
    assert old.cancelled == 1

    new.error = None
    after = robot.drive(new)
    robot.control.start(after, HERE)

    assert robot.control.mux.motion is after
    assert robot.control.hold.done
