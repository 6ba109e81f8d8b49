"""The choice of OpenGL for pictures, and the message if there is none.

`MUJOCO_GL` decides (`egl`, `osmesa`, `glfw` or `cgl`). Without it, Linux draws with `egl`, which
needs no display and no graphics card.
"""

import ctypes
import importlib
import os
import sys
from typing import Any

from edgevox.core.errors import EdgeVoxError

_LIBRARIES = {"egl": "libEGL.so.1", "osmesa": "libOSMesa.so.8"}
_NEEDS = {
    "egl": "the Debian packages libegl1, libgl1 and libgl1-mesa-dri",
    "osmesa": "the Debian package libosmesa6",
    "glfw": "a display; MUJOCO_GL=egl needs none",
    "cgl": "a Mac",
}


class NoPicture(EdgeVoxError):
    """No picture can be taken; the robot itself goes on."""


def backend() -> str:
    """The name of the OpenGL that will draw."""
    without = {"linux": "egl", "darwin": "cgl"}.get(sys.platform, "glfw")
    return os.environ.get("MUJOCO_GL", "").lower().strip() or without


def shield_import() -> Any:
    """The module mujoco. Its import fails by itself if `MUJOCO_GL` names what is not installed."""
    asked = os.environ.get("MUJOCO_GL")
    library = _LIBRARIES.get((asked or "").lower().strip())
    if asked is None or library is None or _loads(library):
        return importlib.import_module("mujoco")
    os.environ["MUJOCO_GL"] = "disable"
    try:
        return importlib.import_module("mujoco")
    finally:
        os.environ["MUJOCO_GL"] = asked


def open_context(width_px: int, height_px: int) -> Any:
    """A current OpenGL context for the calling thread. Raises `NoPicture`."""
    name = backend()
    if name not in _NEEDS:
        raise NoPicture(f"MUJOCO_GL is {name!r}; one of {', '.join(_NEEDS)} draws pictures.")
    try:
        context = importlib.import_module(f"mujoco.{name}").GLContext(width_px, height_px)
        context.make_current()
    except (ImportError, OSError, AttributeError, RuntimeError) as error:
        raise NoPicture(
            f"No picture without OpenGL ({name}). It needs {_NEEDS[name]}: {error}"
        ) from error
    return context


def _loads(library: str) -> bool:
    try:
        ctypes.CDLL(library)
    except OSError:
        return False
    return True
