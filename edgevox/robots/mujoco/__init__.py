"""Common parts of the MuJoCo bodies: stepping a world, and pictures of it.

Imports core and the robots' shared parts. A module that imports mujoco itself imports this package
first, because a machine without OpenGL must not lose its robot with its camera.
"""

from edgevox.core.log import get_logger
from edgevox.robots.mujoco.gl import NoPicture, shield_import

_mujoco = shield_import()
log = get_logger(__name__)

# Else it writes a file here.
_mujoco.set_mju_user_warning(lambda text: log.warning("mujoco", line=text))

__all__ = ["NoPicture"]
