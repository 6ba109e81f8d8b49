"""Collision checks: whether the arm would touch a thing, asked of the geometry before it moves."""

from collections.abc import Sequence

import mujoco
import numpy as np

from edgevox.robots.mujoco.renderer import Snapshot
from edgevox.robots.panda.kinematics import ARM_JOINTS, Joints
from edgevox.robots.panda.scene import TCP

_DEPTH_M = 0.001
"""The overlap of two shapes that is no collision yet: a hand works by light touch."""

Touch = tuple[str, str]
"""Two bodies, in alphabetical order."""


class Collisions:
    """Tests the scene of one moment with the arm put elsewhere. For one thread at a time.

    The thing in the hand moves with it. The world itself (table, floor) is called "table".
    """

    def __init__(self, model: mujoco.MjModel) -> None:
        self._model = model
        self._data = mujoco.MjData(model)
        self._names = [model.body(number).name for number in range(model.nbody)]
        self._names[0] = "table"
        self._arm = _below(model, model.body("link0").id)
        self._site = model.site(TCP).id
        self._held: str | None = None
        self._grip: tuple[np.ndarray, np.ndarray] = (np.zeros(3), np.zeros(4))

    def look(self, scene: Snapshot, held: str | None) -> None:
        """Test this moment from now on, in which the hand holds `held`."""
        scene.show_in(self._model, self._data)
        self._held = held
        if held is not None:
            self._grip = self._relative(held)

    def touched(self, joints: Joints) -> frozenset[Touch]:
        """Return the overlaps of the arm, or of the thing that it holds, with other things."""
        self._data.qpos[:ARM_JOINTS] = joints
        mujoco.mj_kinematics(self._model, self._data)
        if self._held is not None:
            self._carry(self._held)
            mujoco.mj_kinematics(self._model, self._data)
        mujoco.mj_collision(self._model, self._data)
        return frozenset(self._overlaps())

    def first(self, way: Sequence[Joints], allowed: frozenset[Touch]) -> Touch | None:
        """The first overlap on this way that is neither allowed nor there at its start."""
        known = allowed | self.touched(way[0])
        for joints in way[1:]:
            fresh = self.touched(joints) - known
            if fresh:
                return min(fresh)
        return None

    def _overlaps(self) -> list[Touch]:
        contact = self._data.contact
        deep = contact.dist < -_DEPTH_M
        bodies = self._model.geom_bodyid[contact.geom[deep]]
        moved = self._arm | ({self._model.body(self._held).id} if self._held else set())
        return [
            touch(self._names[a], self._names[b]) for a, b in bodies if a in moved or b in moved
        ]

    def _relative(self, held: str) -> tuple[np.ndarray, np.ndarray]:
        """Return the held thing's position and quaternion in the hand."""
        data, turn = self._data, np.zeros(4)
        mujoco.mju_mat2Quat(turn, data.site_xmat[self._site])
        away, back = np.zeros(3), np.zeros(4)
        mujoco.mju_negQuat(back, turn)
        mujoco.mju_rotVecQuat(away, data.body(held).xpos - data.site_xpos[self._site], back)
        inside = np.zeros(4)
        mujoco.mju_mulQuat(inside, back, data.body(held).xquat)
        return away, inside

    def _carry(self, held: str) -> None:
        data, turn = self._data, np.zeros(4)
        mujoco.mju_mat2Quat(turn, data.site_xmat[self._site])
        place = data.joint(held).qpos
        away = np.zeros(3)
        mujoco.mju_rotVecQuat(away, self._grip[0], turn)
        place[:3] = data.site_xpos[self._site] + away
        mujoco.mju_mulQuat(place[3:], turn, self._grip[1])


def touch(one: str, other: str) -> Touch:
    """Two bodies that overlap."""
    return (one, other) if one < other else (other, one)


def _below(model: mujoco.MjModel, root: int) -> set[int]:
    """The ids of this body and of all that hang on it."""
    found = {root}
    for number in range(root + 1, model.nbody):
        if model.body_parentid[number] in found:
            found.add(number)
    return found
