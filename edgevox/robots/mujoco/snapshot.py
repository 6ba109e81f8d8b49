"""A frozen moment of a MuJoCo world, cheap to take under a lock and enough to draw it later."""

from dataclasses import dataclass

import mujoco
import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True, slots=True)
class Snapshot:
    """Joint and mocap positions (in the model's order, metres and radians) at `time_s`."""

    time_s: float
    qpos: NDArray[np.float64]
    mocap_pos: NDArray[np.float64]
    mocap_quat: NDArray[np.float64]

    @classmethod
    def of(cls, data: mujoco.MjData, time_s: float) -> "Snapshot":
        """A copy of this moment. Hold the world's lock."""
        return cls(time_s, data.qpos.copy(), data.mocap_pos.copy(), data.mocap_quat.copy())

    def show_in(self, model: mujoco.MjModel, data: mujoco.MjData) -> None:
        """Put all bodies, cameras and lights of `data` to where they were."""
        data.qpos[:] = self.qpos
        data.mocap_pos[:] = self.mocap_pos
        data.mocap_quat[:] = self.mocap_quat
        mujoco.mj_kinematics(model, data)
        mujoco.mj_comPos(model, data)
        mujoco.mj_camlight(model, data)
