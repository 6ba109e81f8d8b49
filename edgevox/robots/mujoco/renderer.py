"""Pictures of a MuJoCo world, for callers on any thread.

`RoomCamera` is a camera that stands in the room, declared once for MuJoCo and for readers of the
pictures. `Snapshot` freezes a moment, `Renderer` draws it on a thread of its own, and `Offscreen`
is the OpenGL context of that thread.
"""

import math
from concurrent.futures import CancelledError, ThreadPoolExecutor
from dataclasses import dataclass
from typing import TypeAlias

import mujoco
import numpy as np
from numpy.typing import NDArray

from edgevox.core.transforms import Pose3D
from edgevox.robots.capabilities import CameraSpec
from edgevox.robots.mujoco.gl import NoPicture, open_context


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


Camera: TypeAlias = str | mujoco.MjvCamera
"""The name of a camera of the model, or a free one."""
_MAX_GEOMS = 2000
_FINE = 2
"""A fine picture is drawn this many times as wide and high, and averaged."""
_SHADOW_PX = 2048


class Offscreen:
    """Draws pictures of up to `width_px` x `height_px`. Raises `NoPicture` without OpenGL."""

    def __init__(self, model: mujoco.MjModel, width_px: int, height_px: int) -> None:
        self._model = model
        self._data = mujoco.MjData(model)
        self._scene = mujoco.MjvScene(model, maxgeom=_MAX_GEOMS)
        self._option = mujoco.MjvOption()
        self._most = (width_px, height_px)
        self._gl = open_context(width_px, height_px)
        try:
            self._context = _context(model, width_px, height_px)
        except mujoco.FatalError as error:
            self._gl.free()
            raise NoPicture(f"OpenGL was found, but cannot draw: {error}") from error

    def draw(
        self,
        camera: Camera,
        state: Snapshot,
        size_px: tuple[int, int],
        *,
        fine: bool,
    ) -> NDArray[np.uint8]:
        """Draw a picture, see `Renderer.render`."""
        if size_px[0] > self._most[0] or size_px[1] > self._most[1]:
            raise NoPicture(f"a picture of {size_px} is larger than the largest, {self._most}")
        state.show_in(self._model, self._data)
        mujoco.mjv_updateScene(
            self._model,
            self._data,
            self._option,
            None,
            camera if isinstance(camera, mujoco.MjvCamera) else _fixed(self._model, camera),
            mujoco.mjtCatBit.mjCAT_ALL,
            self._scene,
        )
        self._scene.flags[mujoco.mjtRndFlag.mjRND_SHADOW] = fine
        self._scene.flags[mujoco.mjtRndFlag.mjRND_REFLECTION] = fine
        if not fine:
            return self._pixels(size_px)
        return _average(self._pixels((_FINE * size_px[0], _FINE * size_px[1])))

    def close(self) -> None:
        self._context.free()
        self._gl.free()

    def _pixels(self, size_px: tuple[int, int]) -> NDArray[np.uint8]:
        rect = mujoco.MjrRect(0, 0, *size_px)
        pixels = np.empty((size_px[1], size_px[0], 3), dtype=np.uint8)
        mujoco.mjr_render(rect, self._scene, self._context)
        mujoco.mjr_readPixels(pixels, None, rect, self._context)
        return np.ascontiguousarray(pixels[::-1])


def _context(model: mujoco.MjModel, width_px: int, height_px: int) -> mujoco.MjrContext:
    """No multisampling, which costs software rendering most; shadows only when asked for."""
    visual = model.vis
    visual.global_.offwidth, visual.global_.offheight = _FINE * width_px, _FINE * height_px
    visual.quality.offsamples, visual.quality.shadowsize = 0, _SHADOW_PX
    context = mujoco.MjrContext(model, mujoco.mjtFontScale.mjFONTSCALE_100)
    mujoco.mjr_setBuffer(mujoco.mjtFramebuffer.mjFB_OFFSCREEN, context)
    return context


def _fixed(model: mujoco.MjModel, name: str) -> mujoco.MjvCamera:
    number = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_CAMERA, name)
    if number < 0:
        raise NoPicture(f"the model has no camera called {name!r}")
    camera = mujoco.MjvCamera()
    camera.type, camera.fixedcamid = mujoco.mjtCamera.mjCAMERA_FIXED, number
    return camera


def _average(pixels: NDArray[np.uint8]) -> NDArray[np.uint8]:
    height, width, _ = pixels.shape
    blocks = pixels.reshape(height // _FINE, _FINE, width // _FINE, _FINE, 3)
    averaged: NDArray[np.uint8] = blocks.mean(axis=(1, 3)).astype(np.uint8)
    return averaged


class Renderer:
    """Draws pictures of `model` of up to `width_px` x `height_px`, one after another.

    It opens OpenGL with the first picture (0.2 to 0.75 s) and keeps it. It draws from copies, so
    the world may go on meanwhile; only the model is shared.
    """

    def __init__(
        self, model: mujoco.MjModel, width_px: int, height_px: int, *, name: str = "robot"
    ) -> None:
        self._model = model
        self._size = (width_px, height_px)
        self._offscreen: Offscreen | None = None
        self._failure: NoPicture | None = None
        self._thread = ThreadPoolExecutor(max_workers=1, thread_name_prefix=f"{name} renderer")

    def render(
        self,
        camera: Camera,
        state: Snapshot,
        *,
        size_px: tuple[int, int] | None = None,
        fine: bool = False,
    ) -> NDArray[np.uint8]:
        """Return the picture of `camera` at that moment: (height, width, 3), RGB.

        Blocks until it is drawn. `size_px` is (width, height), by default the largest. `fine` is
        slow and has shadows and smooth edges: for people. Raises `NoPicture` without OpenGL, or
        after `close`.
        """
        try:
            return self._thread.submit(
                self._draw, camera, state, size_px or self._size, fine
            ).result()
        except (CancelledError, RuntimeError) as error:
            raise NoPicture(f"No picture was taken: {error or 'closed'}") from error

    def close(self) -> None:
        """Take no more pictures, give OpenGL back and join the thread. May be called twice."""
        try:
            self._thread.submit(self._free)
        except RuntimeError:
            return
        self._thread.shutdown(wait=True)

    def _draw(
        self, camera: Camera, state: Snapshot, size_px: tuple[int, int], fine: bool
    ) -> NDArray[np.uint8]:
        return self._opened().draw(camera, state, size_px, fine=fine)

    def _opened(self) -> Offscreen:
        """Return the drawing context; without OpenGL, raise the first failure again."""
        if self._failure is not None:
            raise NoPicture(str(self._failure))
        if self._offscreen is None:
            try:
                self._offscreen = Offscreen(self._model, *self._size)
            except NoPicture as failure:
                self._failure = failure
                raise
        return self._offscreen

    def _free(self) -> None:
        if self._offscreen is not None:
            self._offscreen.close()
            self._offscreen = None


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
