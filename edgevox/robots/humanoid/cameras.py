"""The humanoid's cameras: the view from its head, and the view of a person who walks beside it."""

import math
from dataclasses import replace

import mujoco
import numpy as np
from numpy.typing import NDArray

from edgevox.core.transforms import Pose2D, compose_on_floor, pitch
from edgevox.robots.capabilities import CameraImage, CameraSpec
from edgevox.robots.humanoid.environment import MujocoHumanoidEnvironment
from edgevox.robots.humanoid.scene import HEAD_CAMERA
from edgevox.robots.mujoco.cameras import PICTURE_PX
from edgevox.robots.mujoco.renderer import Renderer, Snapshot

WIDTH_PX, HEIGHT_PX = 320, 240
VERTICAL_FOV_RAD = math.radians(60.0)
DOWN_RAD = math.radians(25.0)
"""The tilt of the head camera: a robot that walks looks where it goes."""
_HEAD = 1.6
"""Height of the eyes, of the pelvis's when it stands."""
_FACE_M = 0.22
"""The camera's distance ahead of the pelvis: in front of the face, even while the body leans."""
_BESIDE_RAD = math.radians(145.0)
_ABOVE_DEG = -12.0
_AWAY = 3.4


class HumanoidCameras:
    """Renders on its own thread. `look` needs the world's lock, the others do not.

    The head camera hangs in the frame of the robot's pose on the floor, always level and at one
    height, as if a gimbal held it. So its picture agrees with its transform, which it would not if
    the camera swayed with the body; and a robot that lies on the floor still sees from there.
    """

    def __init__(self, environment: MujocoHumanoidEnvironment, *, name: str) -> None:
        self._environment = environment
        self._stand_m = environment.stand_height_m
        self._height_m = _HEAD * self._stand_m
        self.camera_spec = CameraSpec(
            WIDTH_PX,
            HEIGHT_PX,
            VERTICAL_FOV_RAD,
            replace(pitch(DOWN_RAD), x_m=_FACE_M, z_m=self._height_m),
        )
        environment.model.cam(HEAD_CAMERA).fovy[:] = math.degrees(VERTICAL_FOV_RAD)
        self._renderer = Renderer(environment.model, *PICTURE_PX, name=name)

    def look(self, time_s: float) -> Snapshot:
        """A copy of this moment, to be drawn."""
        face = compose_on_floor(self._environment.pose, Pose2D(_FACE_M, 0.0, 0.0))
        return self._environment.snapshot(time_s, face, self._height_m, DOWN_RAD)

    def head(self, moment: Snapshot) -> CameraImage:
        """Return the head camera's picture of that moment."""
        size = (WIDTH_PX, HEIGHT_PX)
        return CameraImage(moment.time_s, self._renderer.render(HEAD_CAMERA, moment, size_px=size))

    def beside(self, moment: Snapshot, pose: Pose2D) -> NDArray[np.uint8]:
        """The robot, which stood there, from ahead and beside, (480, 640, 3)."""
        camera = mujoco.MjvCamera()
        camera.type = mujoco.mjtCamera.mjCAMERA_FREE
        camera.lookat[:] = pose.x_m, pose.y_m, 0.85 * self._stand_m
        camera.distance = _AWAY * self._stand_m
        camera.azimuth = math.degrees(pose.yaw_rad + _BESIDE_RAD)
        camera.elevation = _ABOVE_DEG
        return self._renderer.render(camera, moment, fine=True)

    def close(self) -> None:
        """Free OpenGL and join the thread."""
        self._renderer.close()
