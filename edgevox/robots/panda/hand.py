"""The gripper: how wide it is, and what it holds. Everything here needs the world's lock."""

import mujoco
import numpy as np

from edgevox.robots.panda.kinematics import ARM_JOINTS
from edgevox.robots.panda.scene import TCP

OPEN_M = 0.08
_FULL = 255.0
FINGERS = ("left_finger", "right_finger")
_STILL_M_S = 0.002
_THIN_M = 0.03
_NEAR_M = 0.035


class Hand:
    """Two fingers that move together. `held` is the cube in it, once `take` has made sure."""

    def __init__(self, model: mujoco.MjModel, data: mujoco.MjData) -> None:
        self._model, self._data = model, data
        self._fingers = data.qpos[ARM_JOINTS : ARM_JOINTS + 2]
        self._speeds = data.qvel[ARM_JOINTS : ARM_JOINTS + 2]
        self._pads = [model.body(name).id for name in FINGERS]
        self._point = data.site(TCP).xpos
        self.held: str | None = None

    @property
    def width_m(self) -> float:
        """Between the fingers."""
        return float(self._fingers.sum())

    def command(self, width_m: float) -> None:
        """Go there, as far as nothing is between."""
        self._data.ctrl[ARM_JOINTS] = _FULL * min(max(width_m / OPEN_M, 0.0), 1.0)

    def put_open(self) -> None:
        """Open at once, holding nothing."""
        self._fingers[:] = OPEN_M / 2
        self.command(OPEN_M)
        self.held = None

    def freeze(self) -> None:
        """Stop the fingers, but keep hold of what is between them."""
        between = self.held or any(self.touches(name) for name in self._cubes())
        if not between:
            self.command(self.width_m)

    def has_stopped(self) -> bool:
        """Whether the fingers stand."""
        return bool(np.abs(self._speeds).max() < _STILL_M_S)

    def touches(self, name: str) -> bool:
        """Whether both fingers press on this cube."""
        contact = self._data.contact
        bodies = self._model.geom_bodyid[contact.geom]
        cube = self._model.body(name).id
        pressed = {int(a if b == cube else b) for a, b in bodies if cube in (a, b)}
        return pressed.issuperset(self._pads)

    def take(self, name: str) -> bool:
        """Make sure that this cube is between the fingers; from then on it is held."""
        if self.touches(name) and self._holds(name):
            self.held = name
        return self.held == name

    def lost(self) -> str | None:
        """The cube that was held and is not any more, once."""
        if self.held is None or self._holds(self.held):
            return None
        name, self.held = self.held, None
        return name

    def _holds(self, name: str) -> bool:
        away = self._data.body(name).xpos - self._point
        return self.width_m > _THIN_M and float(away @ away) < _NEAR_M**2

    def _cubes(self) -> list[str]:
        names = [self._model.body(number).name for number in range(self._model.nbody)]
        return [name for name in names if name.endswith("_cube")]
