"""How fast the humanoid's world is: walking, resting, with its camera, against MuJoCo alone.

MuJoCo alone takes the very steps that our robot took: the same model, the same start, the same
targets of the servos.
"""

import time
from collections.abc import Callable
from typing import Any

import mujoco
import numpy as np

from edgevox.models import locate
from edgevox.robots.capabilities import Twist2D
from edgevox.robots.humanoid import HumanoidRobot, MujocoHumanoidEnvironment, OnnxWalkingPolicy
from edgevox.robots.humanoid.policy import Observation, Vector, WalkingPolicy

WALK_S = 20.0
ROUNDS = 3
CAMERA_S = 0.2
_STREAM_S = 0.4
AHEAD = Twist2D(0.5, 0.0)
STILL = Twist2D(0.0, 0.0)


class Recorder:
    """A policy that remembers what it answered, and can say it again without thinking."""

    name = "recorder"

    def __init__(self, policy: WalkingPolicy) -> None:
        self._policy, self.plan = policy, policy.plan
        self.replaying = False
        self.answers: list[Vector] = []

    def reset(self) -> None:
        self._policy.reset()
        self._told = iter(list(self.answers) if self.replaying else ())
        if not self.replaying:
            self.answers.clear()

    def act(self, seen: Observation) -> Vector:
        if self.replaying:
            return next(self._told)
        self.answers.append(self._policy.act(seen))
        return self.answers[-1]


def drive(robot: HumanoidRobot, twist: Twist2D, camera: bool = False) -> float:
    """Seconds that `WALK_S` of the robot's world take."""
    robot.reset()
    begin = time.perf_counter()
    chunk = CAMERA_S if camera else _STREAM_S
    for _ in range(round(WALK_S / chunk)):
        robot.set_velocity(twist)
        robot.advance(chunk)
        if camera:
            robot.camera()
    return time.perf_counter() - begin


def plain(environment: MujocoHumanoidEnvironment, start: Vector, answers: list[Vector]) -> float:
    """Seconds that MuJoCo alone takes for the same steps."""
    model, data = environment.model, mujoco.MjData(environment.model)
    data.qpos[:] = start
    substeps = round(environment.period_s / model.opt.timestep)
    begin = time.perf_counter()
    for answer in answers:
        data.ctrl[:] = answer
        mujoco.mj_step(model, data, substeps)
    return time.perf_counter() - begin


def best(work: Callable[[], float]) -> float:
    """The least disturbed of some rounds."""
    return min(work() for _ in range(ROUNDS))


def measure_physics() -> list[dict[str, Any]]:
    """The G1: all of it, our layer without what its policy thinks, MuJoCo alone."""
    policy = Recorder(OnnxWalkingPolicy(locate("g1-walking-policy")))
    environment = MujocoHumanoidEnvironment(locate("unitree-g1"), policy)
    rows = []
    with HumanoidRobot(environment, speed=None) as robot:
        robot.reset()
        start = np.array(environment.data.qpos)
        for what, twist in (("walking", AHEAD), ("resting", STILL)):
            rounds = []
            for _ in range(ROUNDS):
                policy.replaying = False
                thinking = drive(robot, twist)
                policy.replaying = True
                replayed = drive(robot, twist)
                rounds.append((thinking, replayed, plain(environment, start, policy.answers)))
            policy.replaying = False
            thinking, replayed, alone = (min(column) for column in zip(*rounds, strict=True))
            rows += [
                row("G1", what, thinking),
                row("G1", f"{what}, its policy's answers known before", replayed),
                row("G1", f"{what}, MuJoCo alone", alone),
            ]
        rows.append(row("G1", "walking, camera at 5 Hz", best(lambda: drive(robot, AHEAD, True))))
    return rows


def measure_kinematic() -> list[dict[str, Any]]:
    """The H1, which is moved without physics."""
    with HumanoidRobot(MujocoHumanoidEnvironment(locate("unitree-h1")), speed=None) as robot:
        return [
            row("H1", "walking, moved outright", best(lambda: drive(robot, AHEAD))),
            row("H1", "resting, moved outright", best(lambda: drive(robot, STILL))),
            row("H1", "walking, camera at 5 Hz", best(lambda: drive(robot, AHEAD, True))),
        ]


def row(kind: str, what: str, seconds: float) -> dict[str, Any]:
    """One figure."""
    return {
        "body": f"robot-humanoid, {kind}",
        "what": what,
        "real_time_factor": round(WALK_S / seconds, 1),
    }


def measure() -> list[dict[str, Any]]:
    """Rows of a body, what it does, and how many seconds of its world pass each second."""
    return measure_physics() + measure_kinematic()


def main() -> None:
    """Measure and print."""
    for one in measure():
        print(f"{one['body']:22} {one['what']:45} {one['real_time_factor']:8.1f}")


if __name__ == "__main__":
    main()
