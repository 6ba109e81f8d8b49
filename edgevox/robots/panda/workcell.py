"""The arm at its table as a worker sees it: look, move, grip, one task at a time."""

from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray

from edgevox.agent.skills import SkillFailed
from edgevox.agent.text.reasons import because, called_off
from edgevox.core.cancel import Cancelled, CancelToken
from edgevox.core.clock import Clock
from edgevox.core.transforms import Pose2D, lift
from edgevox.robots.capabilities import Report
from edgevox.robots.command_mux import CommandMux
from edgevox.robots.mujoco.engine import MujocoEngine
from edgevox.robots.panda import table
from edgevox.robots.panda.arm import Arm
from edgevox.robots.panda.kinematics import HandPose, Joints
from edgevox.robots.panda.motion import ArmMotion, Pace, Task
from edgevox.robots.panda.planner import NOTHING, ArmPlanner, ArmSegment, Touch
from edgevox.robots.panda.scene import LEAD_S, TCP, build
from edgevox.robots.panda.table import Placed, Things
from edgevox.robots.sim_loop import BROKE

PERIOD_S = 0.02
_THINKING_S = 60.0
"""A task that has not begun its next motion by then hangs: the world goes on without it."""


class Workcell:
    """Owns the world and the arm in it. The motions block; they raise what ended the task.

    Args:
        model_path: The robot's MJCF.
        seed: 0 puts the cubes at their standard places; any other seed at its own random ones.
        speed: Seconds of its world per second: 1 is real time. None, for tests, is as fast as
            possible while the arm moves, and otherwise only as far as `advance` asks.
        clock: The time; the system's by default.
        name: The robot's name, for its threads.
    """

    def __init__(
        self,
        model_path: Path,
        *,
        seed: int = 0,
        speed: float | None = 1.0,
        clock: Clock | None = None,
        name: str = "robot-panda",
    ) -> None:
        model = build(model_path)
        self.engine = MujocoEngine(model, period_s=PERIOD_S, speed=speed, clock=clock, name=name)
        self.arm = Arm(model, self.engine.data)
        self.planner = ArmPlanner(model, model_path, period_s=PERIOD_S, lead_s=LEAD_S)
        self.starts = table.places(seed)
        self._mux: CommandMux[Task] = CommandMux(self.engine.lock, on_halt=self._freeze)
        self._build()

    def control(self) -> bool:
        """Do one period. If time can be held, it does not pass while a task is being planned."""
        self._wait_for_a_plan()
        return self.arm.tick()

    def advance(self, seconds: float) -> None:
        """Let time pass. Where it can be held, a task knows how to go on when this returns."""
        self.engine.advance(seconds)
        with self.engine.lock:
            self._wait_for_a_plan()

    def _wait_for_a_plan(self) -> None:
        if self.engine.waits:
            self.engine.lock.wait_for(self._knows_what_to_do, _THINKING_S)

    @property
    def task(self) -> Task | None:
        """The task in progress or planning, if any."""
        return self._mux.motion

    def _knows_what_to_do(self) -> bool:
        return self.task is None or self.arm.motion is not None

    def put_back(self) -> None:
        self.end(SkillFailed(BROKE))
        self._build()

    def reset(self) -> None:
        """Put everything back to the start; time goes on."""
        with self.engine.lock:
            self.end(Cancelled(called_off("world_reset")))
            mujoco.mj_resetData(self.engine.model, self.engine.data)
            self._build()

    def end(self, error: BaseException) -> bool:
        """End the task and stop the arm. True if anything was going on."""
        with self.engine.lock:
            moved = self.arm.moving
            return self._mux.halt(error) or moved

    def _freeze(self, _task: Task | None, error: BaseException) -> None:
        self.arm.freeze(error)
        self.engine.lock.notify_all()
        self.engine.wake()

    @contextmanager
    def begin(
        self,
        skill: str,
        about: Mapping[str, Any],
        motions: int,
        token: CancelToken,
        report: Report,
    ) -> Iterator[Task]:
        """Run a task; it ends whatever runs. The token, a halt or the next one ends it."""
        token.check()
        task = Task(skill, about, motions=motions, report=report)
        with self.engine.lock:
            if not self.engine.running:
                raise SkillFailed(because("switched_off"))
            if self._mux.busy:
                self.end(Cancelled(because("preempted", skill=skill)))
            self._mux.start(lambda: task)
        with self._mux.cancelled_by(token, task):
            try:
                yield task
                token.check()
                task.end()
            except BaseException as error:
                task.end(error)
                raise
            finally:
                with self.engine.lock:
                    self.engine.lock.notify_all()

    def move(
        self, task: Task, pose: HandPose, pace: Pace, allowed: frozenset[Touch] = NOTHING
    ) -> None:
        """The hand straight there, pointing down."""
        (leg,) = self.plan((pose, pace, allowed))
        self.follow(task, leg)

    def plan(self, *lines: tuple[HandPose, Pace, frozenset[Touch]]) -> list[ArmSegment]:
        """Straight lines from where the arm is, one after the other, in the scene of now."""
        scene, start, held = self.engine.snapshot(), self.arm.target, self.arm.hand.held
        legs: list[ArmSegment] = []
        for pose, pace, allowed in lines:
            legs.append(self.planner.line(scene, start, pose, pace, held=held, allowed=allowed))
            start = legs[-1].end
        return legs

    def swing(self, task: Task, end: Joints, pace: Pace) -> None:
        """Every joint straight there."""
        scene, start, held = self.engine.snapshot(), self.arm.target, self.arm.hand.held
        self.follow(task, self.planner.swing(scene, start, end, pace, held=held))

    def follow(self, task: Task, leg: ArmSegment) -> None:
        """A motion that was planned from where the arm is now."""
        self._run(task, lambda: self.arm.follow(leg.rows, leg.end))

    def grip(self, task: Task, width_m: float) -> None:
        """Open or close the hand until it stops."""
        self._run(task, lambda: self.arm.grip(width_m))

    def rest(self, task: Task, seconds: float) -> None:
        """Let the world come to rest."""
        self._run(task, lambda: self.arm.rest(max(1, round(seconds / PERIOD_S))))

    def take(self, name: str) -> bool:
        """Make sure that the hand holds this cube."""
        with self.engine.lock:
            return self.arm.hand.take(name)

    def let_go(self) -> str | None:
        """The hand is about to open: what it held is not held any more."""
        with self.engine.lock:
            held, self.arm.hand.held = self.arm.hand.held, None
            return held

    def things(self) -> Things:
        """Return the cubes' places."""
        with self.engine.lock:
            return {name: self._placed(name) for name in table.CUBES}

    def hand_m(self) -> NDArray[np.float64]:
        """(3,) metres: the point between the fingertips."""
        with self.engine.lock:
            return np.array(self.engine.data.site(TCP).xpos)

    def progress(self) -> dict[str, Any] | None:
        """Return the task's part of `robot_state`, if there is a task."""
        with self.engine.lock:
            task = self.task
            return task.describe() if task else None

    def _run(self, task: Task, begin: Callable[[], ArmMotion]) -> None:
        with self.engine.lock:
            task.check()
            task.motion = motion = begin()
            self.engine.lock.notify_all()
        self.engine.wake()
        motion.wait(task.report)
        with self.engine.lock:
            task.moved()
        task.report()

    def _placed(self, name: str) -> Placed:
        body = self.engine.data.body(name)
        x, y, z = (float(value) for value in body.xpos)
        axes = body.xmat.reshape(3, 3)
        level = axes[:, int(np.argmax(np.hypot(axes[0], axes[1])))]
        yaw = float(np.arctan2(level[1], level[0]))
        quarter = np.pi / 2
        return Placed(x, y, z, yaw - quarter * round(yaw / quarter))

    def _build(self) -> None:
        model, data = self.engine.model, self.engine.data
        self.arm.put()
        for name, start in self.starts.items():
            place = data.joint(name).qpos
            place[:3] = start.x_m, start.y_m, table.CUBE_SIZE_M / 2
            turned = lift(Pose2D(0.0, 0.0, start.yaw_rad))
            place[3:] = turned.qw, turned.qx, turned.qy, turned.qz
        mujoco.mj_forward(model, data)
