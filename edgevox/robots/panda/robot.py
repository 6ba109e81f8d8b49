"""`robot-panda`: a body with an arm, a hand and a camera in the room, simulated with MuJoCo."""

from collections.abc import Mapping
from dataclasses import astuple
from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray

from edgevox.agent.skills import Skill, SkillFailed
from edgevox.agent.text.reasons import because
from edgevox.core.cancel import Cancelled, CancelToken
from edgevox.core.errors import finite
from edgevox.core.reason import Reason
from edgevox.core.transforms import Pose3D
from edgevox.robots.capabilities import CameraImage, CameraSpec, Report
from edgevox.robots.mujoco.renderer import PICTURE_PX, Renderer
from edgevox.robots.panda import table, tasks
from edgevox.robots.panda.planner import InTheWay, OutOfReach
from edgevox.robots.panda.scene import CAMERA, SHOW, TCP
from edgevox.robots.panda.skills import manipulation_skills, table_facts
from edgevox.robots.panda.workcell import Workcell
from edgevox.robots.sim_loop import SimulatedBody

CAMERA_PX = (320, 240)
_POSE = ("x", "y", "z", "qx", "qy", "qz", "qw")


class PandaRobot(SimulatedBody):
    """A Franka Panda at a table with three cubes and two bins. The map frame is the arm's base.

    `cell` is its world; nothing else may use the cell's arm. Every method may be called from any
    thread. The skills block until they are done; a cancelled or halted arm stands within 0.1 s of
    its own time and keeps its grip.
    """

    name = "robot-panda"

    def __init__(self, cell: Workcell) -> None:
        self._cell = cell
        self._engine = cell.engine
        self._renderer = Renderer(self._engine.model, *PICTURE_PX, name=self.name)
        self._camera_spec = CAMERA.spec(*CAMERA_PX)
        self._skills = manipulation_skills(self)
        self._facts = table_facts(self)

    @property
    def skills(self) -> tuple[Skill, ...]:
        return self._skills

    @property
    def facts(self) -> tuple[Skill, ...]:
        return self._facts

    @property
    def time_s(self) -> float:
        return self._engine.time_s

    @property
    def real_time_factor(self) -> float:
        """Seconds that pass in the world each second."""
        return self._engine.real_time_factor

    @property
    def pace(self) -> float | None:
        return self._engine.pace

    @property
    def breaks(self) -> int:
        """The number of the world's steps that failed, or whose numbers broke."""
        return self._engine.breaks

    @property
    def stalled_s(self) -> float:
        return self._engine.stalled_s

    def start(self) -> None:
        self._engine.start(self._cell)

    def _close(self) -> None:
        self._engine.close()
        self._renderer.close()

    def halt(self, reason: str) -> bool:
        return self._cell.end(Cancelled(reason))

    def reset(self) -> None:
        """Arm and cubes back where they started; time goes on."""
        self._cell.reset()

    @property
    def in_motion(self) -> bool:
        """Whether a goal moves it."""
        return self._cell.task is not None

    def advance(self, seconds: float) -> None:
        """Block until this much of the world's time has passed."""
        self._cell.advance(seconds)

    def end_effector(self) -> Pose3D:
        quaternion = np.zeros(4)
        with self._engine.lock:
            site = self._engine.data.site(TCP)
            x, y, z = (float(value) for value in site.xpos)
            mujoco.mju_mat2Quat(quaternion, site.xmat)
        qw, qx, qy, qz = (float(value) for value in quaternion)
        return Pose3D(x, y, z, qx, qy, qz, qw)

    @property
    def camera_spec(self) -> CameraSpec:
        return self._camera_spec

    def camera(self) -> CameraImage:
        """Take a picture from above the far side of the table.

        Raises `NoPicture` without OpenGL.
        """
        scene = self._engine.snapshot()
        pixels = self._renderer.render(CAMERA.name, scene, size_px=CAMERA_PX)
        return CameraImage(scene.time_s, pixels)

    def picture(self) -> NDArray[np.uint8]:
        return self._renderer.render(SHOW.name, self._engine.snapshot(), fine=True)

    def joints(self) -> Mapping[str, tuple[float, float, float]]:
        """The angle of each joint and its two limits, radians."""
        with self._engine.lock:
            angles = self._cell.arm.joints
        limits = self._engine.model.jnt_range[: len(angles)]
        return {
            f"joint{number}": (float(angle), float(low), float(high))
            for number, (angle, (low, high)) in enumerate(zip(angles, limits, strict=True), 1)
        }

    def state(self) -> Mapping[str, Any]:
        with self._engine.lock:
            time_s, hand = self.time_s, self.end_effector()
            turning = self._cell.arm.speeds
            width_m, held = self._cell.arm.hand.width_m, self._cell.arm.hand.held
            things, goal = self._cell.things(), self._cell.progress()
        return {
            "name": self.name,
            "time": round(time_s, 3),
            "simulation": "physics",
            "pose": {
                name: round(value, 4) for name, value in zip(_POSE, astuple(hand), strict=True)
            },
            "velocity": {"joints": [round(float(value), 4) for value in turning]},
            "gripper_width": round(width_m, 4),
            "held": held,
            "objects": {name: _point(one) for name, one in things.items()},
            "goal": goal,
        }

    def describe_hand(self) -> dict[str, Any]:
        """Describe the hand's position and the thing in it."""
        hand, held = self._cell.hand_m(), self._cell.arm.hand.held
        x, y, z = (round(float(value), 3) + 0.0 for value in hand)
        return {
            "x": x,
            "y": y,
            "z": z,
            "held": held,
        }

    def describe_objects(self) -> dict[str, Any]:
        """Every object and where it is."""
        things, held = self._cell.things(), self._cell.arm.hand.held
        places = {name: table.where(name, things, held) for name in things}
        return {
            "objects": {name: {**_point(things[name]), "on": places[name]} for name in things},
            "count": len(things),
        }

    def move_to(
        self, x_m: float, y_m: float, z_m: float, *, token: CancelToken, report: Report
    ) -> None:
        """Block until the hand is there. Raises `SkillFailed` with a reason, `Cancelled`."""
        goal = np.array([finite("x", x_m), finite("y", y_m), finite("z", z_m)])
        target = {name: round(float(v), 3) for name, v in zip("xyz", goal, strict=True)}
        with self._cell.begin("move_to", {"target": target}, 1, token, report) as task:
            task.phase = "moving"
            held, scene = self._cell.arm.hand.held, self._engine.snapshot()
            try:
                end = self._cell.planner.reach(scene, self._cell.arm.target, goal, held=held)
            except (OutOfReach, InTheWay) as failure:
                near = self._cell.planner.nearest(scene, goal, held=held)
                raise SkillFailed(_refusal(goal, near, failure)) from failure
            tasks.go(self._cell, task, end)

    def grasp(self, name: str, *, token: CancelToken, report: Report) -> None:
        """Block until this cube is held. Raises `SkillFailed` with a reason, `Cancelled`."""
        tasks.check_pick(self._cell, name)
        motions = tasks.PICK_MOTIONS
        with self._cell.begin("grasp", {"target": name}, motions, token, report) as task:
            tasks.pick(self._cell, task, name)

    def place(self, name: str | None, target: str, *, token: CancelToken, report: Report) -> str:
        """Block until the cube (or what is held) lies there; which it is. Raises as `grasp`."""
        held = self._cell.arm.hand.held
        name = name or held
        if name is None:
            raise SkillFailed(because("holds_nothing"))
        if held != name:
            tasks.check_pick(self._cell, name)
        tasks.spot_for(self._cell, name, target)
        motions = tasks.PLACE_MOTIONS + (0 if held == name else tasks.PICK_MOTIONS)
        about = {"object": name, "target": target}
        with self._cell.begin("place", about, motions, token, report) as task:
            if held != name:
                tasks.pick(self._cell, task, name)
            tasks.place(self._cell, task, name, target)
        return name

    def release(self, *, token: CancelToken, report: Report) -> str | None:
        """Block until the hand is open; what it held."""
        with self._cell.begin("release", {}, 2, token, report) as task:
            return tasks.release(self._cell, task)

    def go_home(self, *, token: CancelToken, report: Report) -> None:
        """Block until the arm is at home, with whatever it holds."""
        with self._cell.begin("goto_home", {}, 2, token, report) as task:
            tasks.home(self._cell, task)


def _point(one: table.Placed) -> dict[str, float]:
    return {"x": round(one.x_m, 4), "y": round(one.y_m, 4), "z": round(one.z_m, 4)}


def _refusal(goal: NDArray[np.float64], near: NDArray[np.float64], failure: SkillFailed) -> Reason:
    asked, offered = (
        f"x {point[0]:.2f}, y {point[1]:.2f}, z {point[2]:.2f}" for point in (goal, near)
    )
    if isinstance(failure, OutOfReach):
        return because("beyond", point=asked, nearest=offered)
    return because("blocked", point=asked, why=failure.reason, nearest=offered)
