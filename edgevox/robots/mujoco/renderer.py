"""Draws a MuJoCo world from any thread, on one thread and with one OpenGL context of its own."""

from concurrent.futures import CancelledError, ThreadPoolExecutor

import mujoco
import numpy as np
from numpy.typing import NDArray

from edgevox.robots.mujoco.gl import NoPicture
from edgevox.robots.mujoco.offscreen import Camera, Offscreen
from edgevox.robots.mujoco.snapshot import Snapshot


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
