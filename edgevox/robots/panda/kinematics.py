"""Inverse kinematics of the arm: differential steps with mink, iterated until they settle."""

from dataclasses import dataclass
from pathlib import Path

import mink
import numpy as np
from numpy.typing import NDArray

from edgevox.robots.panda.scene import TCP, arm_spec

Joints = NDArray[np.float64]
"""(7,) radians, from the base to the hand."""

READY = np.array([0.0, -np.pi / 4, 0.0, -3 * np.pi / 4, 0.0, np.pi / 2, np.pi / 4])
"""The joints at home: the hand over the table, pointing down."""
ARM_JOINTS = 7
"""The first joints of the model; the two fingers follow."""
_OPEN = (0.04, 0.04)
"""The fingers' positions in metres while the arm is solved for: the open hand."""
_NEAR_M = 2e-4
"""A solution may miss the wanted point by this much."""
_NEAR_RAD = 2e-3
"""A solution may miss the wanted direction by this much."""
_ROUNDS = 40
"""The most iterations."""
_UPRIGHT_RAD = 0.05
"""A hand within this angle of the vertical points straight down."""
_STALLED_RAD = 3e-3
"""The iteration ends after a step in which every joint turned by less than this."""
_STEP_RAD = 0.7
"""The most that a joint may turn in one iteration; a longer step is shortened as a whole."""


@dataclass(frozen=True, slots=True)
class HandPose:
    """A pose of the hand that points straight down, map frame."""

    x_m: float
    """The point between the fingertips; likewise the next two."""
    y_m: float
    z_m: float
    yaw_rad: float = 0.0
    """The turn about the vertical; at 0 the fingers open along y."""

    @classmethod
    def at(cls, point_m: NDArray[np.float64], yaw_rad: float = 0.0) -> "HandPose":
        """Make a pose at this point, (3,) metres."""
        x, y, z = (float(value) for value in point_m)
        return cls(x, y, z, yaw_rad)

    @property
    def point(self) -> NDArray[np.float64]:
        """(3,) metres."""
        return np.array([self.x_m, self.y_m, self.z_m])


class Kinematics:
    """Solves for the joints of the arm alone, without geometry. For one thread at a time."""

    def __init__(self, model_path: Path) -> None:
        spec = arm_spec(model_path)
        for shape in (*spec.geoms, *spec.meshes):
            spec.delete(shape)
        model = spec.compile()
        self._configuration = mink.Configuration(model)
        self._hand = mink.FrameTask(TCP, "site", position_cost=1.0, orientation_cost=0.5)
        self._point = mink.FrameTask(TCP, "site", position_cost=1.0, orientation_cost=0.0)
        # Seven joints are more than a pose needs: a small cost picks the solution near READY.
        self._posture = mink.PostureTask(model, cost=1e-3)
        self._posture.set_target(_whole(READY))
        self._limits = [mink.ConfigurationLimit(model)]
        self._site = model.site(TCP).id

    def solve(self, pose: HandPose, seed: Joints) -> Joints | None:
        """Return joints for this pose, searched from `seed`; None if it is out of reach."""
        down = mink.SO3.from_z_radians(pose.yaw_rad) @ mink.SO3.from_x_radians(np.pi)
        self._hand.set_target(mink.SE3.from_rotation_and_translation(down, pose.point))
        joints = self._run(self._hand, seed)
        error = self._hand.compute_error(self._configuration)
        near = np.linalg.norm(error[:3]) < _NEAR_M and np.linalg.norm(error[3:]) < _NEAR_RAD
        return joints if near else None

    def closest(self, point_m: NDArray[np.float64], seed: Joints) -> Joints:
        """Return joints that bring the hand nearest to `point_m`, in any direction of the hand."""
        goal = mink.SE3.from_translation(point_m)
        self._point.set_target(goal)
        return self._run(self._point, seed)

    def hand_at(self, joints: Joints) -> NDArray[np.float64]:
        """Return the point between the fingertips with these joints: (3,) metres, map frame."""
        self._configuration.update(_whole(joints))
        return np.array(self._configuration.data.site_xpos[self._site])

    def pose_at(self, joints: Joints) -> HandPose | None:
        """Return the hand's pose with these joints; None unless it points nearly straight down."""
        x, y, z = self.hand_at(joints)
        turn = self._configuration.data.site_xmat[self._site].reshape(3, 3)
        if turn[2, 2] > -np.cos(_UPRIGHT_RAD):
            return None
        return HandPose(x, y, z, float(np.arctan2(turn[1, 0], turn[0, 0])))

    def _run(self, task: mink.FrameTask, seed: Joints) -> Joints:
        configuration = self._configuration
        configuration.update(_whole(seed))
        for _ in range(_ROUNDS):
            # 1.0 is mink's time step, no physical time: so its velocity is the joints' step.
            step = mink.solve_ik(
                configuration, [task, self._posture], 1.0, "daqp", limits=self._limits, damping=1e-6
            )
            step[ARM_JOINTS:] = 0.0  # the fingers stay open
            largest = np.abs(step).max()
            configuration.integrate_inplace(step * min(1.0, _STEP_RAD / max(largest, 1e-9)), 1.0)
            if largest < _STALLED_RAD:
                break
        return np.array(configuration.q[:ARM_JOINTS])


def _whole(joints: Joints) -> NDArray[np.float64]:
    return np.concatenate([joints, _OPEN])
