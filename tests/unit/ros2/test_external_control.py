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

    def tick(self, now_s: float, estimate: PoseEstimate) -> bool:
        self.ticked_s = now_s
        return False

    def left_m(self, estimate: PoseEstimate) -> float:
        return 1.0


class Robot:
    """A control loop with wheels that note what they are told, and a robot that stands."""

    def __init__(self) -> None:
        self.told: list[Twist2D] = []
        self.clock = HeldClock()
        self.heard: PoseEstimate | None = HERE
        self.senses = SimpleNamespace(
            estimate=lambda: self.heard,
            odometry_history=SimpleNamespace(still=lambda: True, stands=lambda _: False),
            odom_topic="/odom",
        )
        wheels = SimpleNamespace(turn=self.told.append)
        goals = SimpleNamespace(recall=lambda _: None)
        self.control = ControlLoop(
            threading.RLock(), self.senses, wheels, goals, clock=self.clock, obey_s=3.0
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


def _tick_after(robot: Robot, seconds: float) -> None:
    robot.clock.advance(seconds)
    robot.control.tick()


def test_a_robot_is_not_silent_because_edgevox_did_not_listen(robot) -> None:
    backend = FakeBackend("cmd_vel")
    drive = robot.drive(backend)
    robot.control.start(drive, HERE)
    _tick_after(robot, 0.05)

    robot.heard = None  # what it said stands in the queue
    _tick_after(robot, 2.0)
    assert not drive.done
    assert backend.ticked_s == pytest.approx(0.05)

    robot.heard = HERE
    _tick_after(robot, 0.05)
    assert not drive.done
    assert backend.ticked_s == pytest.approx(2.1)


@pytest.mark.parametrize("again_s", [0.05, 2.0])
def test_a_robot_that_is_silent_at_the_next_tick_too_is_stopped(robot, again_s) -> None:
    drive = robot.drive(FakeBackend("cmd_vel"))
    robot.control.start(drive, HERE)
    robot.heard = None
    _tick_after(robot, 2.0)
    assert robot.told == []

    _tick_after(robot, again_s)

    assert drive.error.reason.code == "robot_silent"
    assert robot.told == [STILL]


def test_a_hold_goes_on_in_a_late_tick_too(robot) -> None:
    robot.control.mux.halt(Cancelled("a test"))
    told = len(robot.told)

    _tick_after(robot, 2.0)

    assert robot.told[told:] == [STILL]


def test_a_robot_speeds_up_by_its_acceleration_and_slows_down_at_once(robot) -> None:
    robot.control = ControlLoop(
        threading.RLock(),
        robot.senses,
        SimpleNamespace(turn=robot.told.append),
        SimpleNamespace(recall=lambda _: None),
        clock=robot.clock,
        obey_s=3.0,
        speed_up_m_s2=0.5,
    )
    for wanted in (Twist2D(0.06, 0.07), Twist2D(0.06, 0.07), Twist2D(0.01, 0.0), Twist2D(-0.3, -1)):
        robot.clock.advance(0.05)
        robot.control.steer(wanted)
    robot.control.mux.halt(Cancelled("stop"))
    robot.clock.advance(60.0)
    robot.control.steer(Twist2D(1.0, 0.0))
    linear = [round(one.linear_m_s, 3) for one in robot.told]
    assert linear == [0.025, 0.05, 0.01, -0.025, 0.0, 0.05]
    assert [round(one.angular_rad_s, 3) for one in robot.told] == [0.05, 0.07, 0.0, -0.05, 0.0, 0.0]
