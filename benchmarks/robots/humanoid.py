"""How fast the humanoid's world is: walking, resting, with its camera, against MuJoCo alone.

MuJoCo alone takes the very steps that our robot took: the same model, the same start, the same
targets of the servos.
"""

import mujoco
import numpy as np

from benchmarks.core.stopwatch import Stopwatch
from benchmarks.robots.worlds import Row, Run, compare
from edgevox.models import locate
from edgevox.robots.capabilities import Twist2D
from edgevox.robots.humanoid import HumanoidRobot, MujocoHumanoidEnvironment, OnnxWalkingPolicy
from edgevox.robots.humanoid.walking_policy import Observation, Vector, WalkingPolicy

BODY = "robot-humanoid"
WORLD = f"{BODY} world"
WALK_S = 6.0
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


def drive(robot: HumanoidRobot, twist: Twist2D, camera: bool = False) -> Run:
    """`WALK_S` of the robot's world, under a stream of velocities."""
    robot.reset()
    chunk = CAMERA_S if camera else _STREAM_S
    with Stopwatch(WORLD) as watch:
        for _ in range(round(WALK_S / chunk)):
            robot.set_velocity(twist)
            robot.advance(chunk)
            if camera:
                robot.camera()
    return Run(WALK_S, watch.spent)


def plain(environment: MujocoHumanoidEnvironment, start: Vector, answers: list[Vector]) -> Run:
    """MuJoCo alone, in the same steps."""
    model, data = environment.model, mujoco.MjData(environment.model)
    data.qpos[:] = start
    substeps = round(environment.period_s / model.opt.timestep)
    with Stopwatch() as watch:
        for answer in answers:
            data.ctrl[:] = answer
            mujoco.mj_step(model, data, substeps)
    return Run(len(answers) * environment.period_s, watch.spent)


def measure_physics(rounds: int) -> list[Row]:
    """The G1: all of it, our layer without what its policy thinks, MuJoCo alone."""
    policy = Recorder(OnnxWalkingPolicy(locate("g1-walking-policy")))
    environment = MujocoHumanoidEnvironment(locate("unitree-g1"), policy)
    body = f"{BODY}, G1"

    def driven(twist: Twist2D, *, replaying: bool) -> Run:
        policy.replaying = replaying
        return drive(robot, twist)

    with HumanoidRobot(environment, speed=0.0) as robot:
        robot.reset()
        start = np.array(environment.data.qpos)
        rows = [
            compare(
                body,
                what,
                lambda twist=twist: driven(twist, replaying=False),
                lambda: plain(environment, start, policy.answers),
                lambda twist=twist: driven(twist, replaying=True),
                rounds=rounds,
            )
            for what, twist in (("walking", AHEAD), ("resting", STILL))
        ]
        policy.replaying = False
        watched = drive(robot, AHEAD, camera=True)
        return [*rows, Row(body, "walking, camera at 5 Hz", 1 / watched.cost)]


def measure_kinematic() -> list[Row]:
    """The H1, which is moved without physics."""
    body = f"{BODY}, H1"
    with HumanoidRobot(MujocoHumanoidEnvironment(locate("unitree-h1")), speed=0.0) as robot:
        return [
            Row(body, "walking, moved outright", 1 / drive(robot, AHEAD).cost),
            Row(body, "walking, camera at 5 Hz", 1 / drive(robot, AHEAD, camera=True).cost),
        ]


def measure(rounds: int) -> list[Row]:
    """Both robots."""
    return measure_physics(rounds) + measure_kinematic()
