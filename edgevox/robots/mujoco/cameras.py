"""Cameras that stand in the room, declared once for MuJoCo and for readers of the pictures."""

import math
from dataclasses import dataclass

import mujoco
import numpy as np
from numpy.typing import NDArray

from edgevox.core.transforms import Pose3D
from edgevox.robots.capabilities import CameraSpec

PICTURE_PX = (640, 480)
"""The size of pictures for people."""

Point3 = tuple[float, float, float]


@dataclass(frozen=True, slots=True)
class RoomCamera:
    """Stands at `position_m` and looks at `target_m` (map frame), upright."""

    name: str
    position_m: Point3
    target_m: Point3
    vertical_fov_rad: float = math.radians(45.0)

    def add_to(self, spec: mujoco.MjSpec) -> None:
        """Put it into a model that is being built, whose world is the map frame."""
        axes = self.rotation()
        quaternion = np.zeros(4)
        mujoco.mju_mat2Quat(
            quaternion, np.column_stack([-axes[:, 1], axes[:, 2], -axes[:, 0]]).flatten()
        )
        spec.worldbody.add_camera(
            name=self.name,
            pos=self.position_m,
            quat=quaternion,
            fovy=math.degrees(self.vertical_fov_rad),
        )

    def rotation(self) -> NDArray[np.float64]:
        """(3, 3): its forward, left and up axes as columns, map frame."""
        forward = np.subtract(self.target_m, self.position_m)
        forward /= np.linalg.norm(forward)
        left = np.cross([0.0, 0.0, 1.0], forward)
        left /= np.linalg.norm(left)
        return np.column_stack([forward, left, np.cross(forward, left)])

    def spec(self, width_px: int, height_px: int) -> CameraSpec:
        """Return the camera's specification for pictures of this size."""
        quaternion = np.zeros(4)
        mujoco.mju_mat2Quat(quaternion, self.rotation().flatten())
        w, x, y, z = (float(value) for value in quaternion)
        mount = Pose3D(*self.position_m, x, y, z, w)
        return CameraSpec(width_px, height_px, self.vertical_fov_rad, mount, "map")
