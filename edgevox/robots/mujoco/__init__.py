"""What the bodies that are simulated with MuJoCo share: stepping a world, and pictures of it.

Imports core and the robots' own protocols. A module that imports mujoco itself imports this package
first, because a machine without OpenGL must not lose its robot with its camera.
"""

import logging

from edgevox.robots.mujoco.gl import NoPicture, shield_import

_mujoco = shield_import()
_mujoco.set_mju_user_warning(logging.getLogger(__name__).warning)  # else it writes a file here

__all__ = ["NoPicture"]
