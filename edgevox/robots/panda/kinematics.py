"""Joint angles that bring the hand somewhere: differential inverse kinematics, run to its end."""

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
_OPEN = (0.04, 0.04)
_NEAR_M = 2e-4
_NEAR_RAD = 2e-3
_ROUNDS = 40
_UPRIGHT_RAD = 0.05
_STALLED_RAD = 3e-3
_STEP_RAD = 0.7


@dataclass(frozen=True, slots=True)
class HandPose:
    """The point between the fingertips (metres, map frame), the hand pointing straight down.

    `yaw_rad` turns it about the vertical; at 0 the fingers open along y.
    """

    x_m: float
    y_m: float
    z_m: float
    yaw_rad: float = 0.0

    @classmethod
    def at(cls, point_m: NDArray[np.float64], yaw_rad: float = 0.0) -> "HandPose":
        """At this point, (3,) metres."""
        x, y, z = (float(value) for value in point_m)
        return cls(x, y, z, yaw_rad)

    @property
    def point(self) -> NDArray[np.float64]:
        """(3,) metres."""
        return np.array([self.x_m, self.y_m, self.z_m])


class Kinematics:
    """Solves for the arm alone. For one thread at a time."""

    def __init__(self, model_path: Path) -> None:
        spec = arm_spec(model_path)
        for shape in (*spec.geoms, *spec.meshes):
            spec.delete(shape)
        model = spec.compile()
        self._configuration = mink.Configuration(model)
        self._hand = mink.FrameTask(TCP, "site", position_cost=1.0, orientation_cost=0.5)
        self._point = mink.FrameTask(TCP, "site", position_cost=1.0, orientation_cost=0.0)
        self._posture = mink.PostureTask(model, cost=1e-3)
        self._posture.set_target(_whole(READY))
        self._limits = [mink.ConfigurationLimit(model)]
        self._site = model.site(TCP).id

    def solve(self, pose: HandPose, seed: Joints) -> Joints | None:
        """Joints for this pose, sought from `seed`; None if it is out of reach."""
        down = mink.SO3.from_z_radians(pose.yaw_rad) @ mink.SO3.from_x_radians(np.pi)
        self._hand.set_target(mink.SE3.from_rotation_and_translation(down, pose.point))
        joints = self._run(self._hand, seed)
        error = self._hand.compute_error(self._configuration)
        near = np.linalg.norm(error[:3]) < _NEAR_M and np.linalg.norm(error[3:]) < _NEAR_RAD
        return joints if near else None

    def closest(self, point_m: NDArray[np.float64], seed: Joints) -> Joints:
        """Joints that bring the hand as near to (x, y, z) as it comes, however it points."""
        goal = mink.SE3.from_translation(point_m)
        self._point.set_target(goal)
        return self._run(self._point, seed)

    def hand_at(self, joints: Joints) -> NDArray[np.float64]:
        """(3,) metres: where these joints put the point between the fingertips."""
        self._configuration.update(_whole(joints))
        return np.array(self._configuration.data.site_xpos[self._site])

    def pose_at(self, joints: Joints) -> HandPose | None:
        """The hand's pose with these joints; None unless it points straight down, or nearly."""
        x, y, z = self.hand_at(joints)
        turn = self._configuration.data.site_xmat[self._site].reshape(3, 3)
        if turn[2, 2] > -np.cos(_UPRIGHT_RAD):
            return None
        return HandPose(x, y, z, float(np.arctan2(turn[1, 0], turn[0, 0])))

    def _run(self, task: mink.FrameTask, seed: Joints) -> Joints:
        configuration = self._configuration
        configuration.update(_whole(seed))
        for _ in range(_ROUNDS):
            step = mink.solve_ik(
                configuration, [task, self._posture], 1.0, "daqp", limits=self._limits, damping=1e-6
            )
            step[ARM_JOINTS:] = 0.0
            largest = np.abs(step).max()
            configuration.integrate_inplace(step * min(1.0, _STEP_RAD / max(largest, 1e-9)), 1.0)
            if largest < _STALLED_RAD:
                break
        return np.array(configuration.q[:ARM_JOINTS])


def _whole(joints: Joints) -> NDArray[np.float64]:
    return np.concatenate([joints, _OPEN])
