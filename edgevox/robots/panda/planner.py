"""A planner for the hand: straight lines as joint angles that are in reach and touch nothing.

`Collisions` asks the geometry before the arm moves.
"""

import re
import threading
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from pathlib import Path

import mujoco
import numpy as np
from numpy.typing import NDArray

from edgevox.agent.skills import SkillFailed
from edgevox.agent.text.reasons import because
from edgevox.core.transforms import turn_between
from edgevox.robots.mujoco.renderer import Snapshot
from edgevox.robots.panda.kinematics import ARM_JOINTS, READY, HandPose, Joints, Kinematics
from edgevox.robots.panda.motion import Pace, Rows, steps, written
from edgevox.robots.panda.scene import TCP
from edgevox.robots.panda.table import FAR_M

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


Point = NDArray[np.float64]
"""(3,) metres, map frame."""

_FOUND_M = 0.004
_SHOULDER_M = np.array([0.0, 0.0, 0.333])
_SURELY_M = 0.55
_LOWEST_M = 0.02
_BISECTIONS = 8
_CANDIDATES = 30
_PART = re.compile(r"link\d|hand|(left|right)_finger")


class OutOfReach(SkillFailed):
    """No joint angles bring the hand there."""


class InTheWay(SkillFailed):
    """The arm would touch something on its way."""


class Reach:
    """Answers for the scene that `collisions` looks at."""

    def __init__(self, kinematics: Kinematics, collisions: Collisions) -> None:
        self._kinematics, self._collisions = kinematics, collisions

    def joints(self, point_m: Point, seed: Joints) -> Joints:
        """Joints that bring the hand there, pointing down if it can, however it must otherwise.

        Raises `OutOfReach`, or `InTheWay` if the arm would touch something there.
        """
        touched: frozenset[Touch] = frozenset()
        for joints in self._candidates(point_m, seed):
            if np.linalg.norm(self._kinematics.hand_at(joints) - point_m) < _FOUND_M:
                touched = self._collisions.touched(joints)
                if not touched:
                    return joints
        if touched:
            raise in_the_way(min(touched))
        raise OutOfReach(because("too_far"))

    def nearest(self, point_m: Point) -> Point:
        """A point near this one, in whole centimetres, for which `joints` has an answer."""
        aim = np.clip(point_m, (-FAR_M, -FAR_M, _LOWEST_M), FAR_M)
        near, far = self._surely(aim), aim
        for _ in range(_BISECTIONS):
            middle = (near + far) / 2
            near, far = (middle, far) if self._can(middle) else (near, middle)
        return self._rounded(near)

    def _candidates(self, point_m: Point, seed: Joints) -> list[Joints]:
        down = (self._kinematics.solve(HandPose.at(point_m), start) for start in (seed, READY))
        found = [joints for joints in down if joints is not None]
        return found or [self._kinematics.closest(point_m, start) for start in (seed, READY)]

    def _can(self, point_m: Point) -> bool:
        try:
            self.joints(point_m, READY)
        except SkillFailed:
            return False
        return True

    def _surely(self, aim: Point) -> Point:
        """A point that is reached, if possible on the line from the shoulder to `aim`."""
        away = aim - _SHOULDER_M
        start = _SHOULDER_M + _SURELY_M * away / max(float(np.linalg.norm(away)), 1e-6)
        return start if self._can(start) else self._kinematics.hand_at(READY)

    def _rounded(self, point_m: Point) -> Point:
        home = self._kinematics.hand_at(READY)
        for part in np.linspace(0.0, 1.0, _CANDIDATES):
            rounded: Point = np.round(point_m + part * (home - point_m), 2)
            if self._can(rounded):
                return rounded
        return home


def in_the_way(touched: Touch) -> InTheWay:
    """Return the error for a touch, in a person's words.

    The arm's part first, by its common name.
    """
    mine = [name for name in touched if _PART.fullmatch(name)]
    if len(mine) == len(touched):
        return InTheWay(because("would_touch_itself"))
    other = next(name for name in reversed(touched) if name not in mine)
    part = mine[0] if mine else touched[0]
    said = "arm" if part.startswith("link") else spoken(part)
    return InTheWay(because("would_touch", part=said, thing=spoken(other)))


def spoken(name: str) -> str:
    """A name as a person says it."""
    return name.replace("_", " ")


_KNOT_M = 0.13
_KNOT_RAD = 0.6
_KNOT_JOINT_RAD = 0.3
_JUMP_RAD = 1.2
NOTHING: frozenset[Touch] = frozenset()


@dataclass(frozen=True, slots=True)
class ArmSegment:
    """A motion from rest to rest: what the motors follow, and the joints at its end."""

    rows: Rows
    end: Joints


class ArmPlanner:
    """Plans in the scene of one moment, given by `look`; from any thread, one plan at a time."""

    def __init__(
        self, model: mujoco.MjModel, model_path: Path, *, period_s: float, lead_s: float
    ) -> None:
        self._kinematics = Kinematics(model_path)
        self._collisions = Collisions(model)
        self._reach = Reach(self._kinematics, self._collisions)
        self._period_s, self._lead_s = period_s, lead_s
        self._lock = threading.Lock()

    def line(
        self,
        scene: Snapshot,
        start: Joints,
        pose: HandPose,
        pace: Pace,
        *,
        held: str | None = None,
        allowed: frozenset[Touch] = NOTHING,
    ) -> ArmSegment:
        """Straight to `pose`, with the hand pointing down. Raises `OutOfReach`, `InTheWay`."""
        with self._lock:
            self._collisions.look(scene, held)
            return self._leg(self._line(start, pose), pace, allowed)

    def swing(
        self, scene: Snapshot, start: Joints, end: Joints, pace: Pace, *, held: str | None = None
    ) -> ArmSegment:
        """Every joint straight to its end. Raises `InTheWay`."""
        with self._lock:
            self._collisions.look(scene, held)
            return self._leg(_between(start, end), pace, NOTHING)

    def reach(self, scene: Snapshot, start: Joints, point_m: Point, *, held: str | None) -> Joints:
        """Joints that bring the hand to (x, y, z), pointing down if it can. Raises as `line`."""
        with self._lock:
            self._collisions.look(scene, held)
            return self._reach.joints(point_m, start)

    def nearest(self, scene: Snapshot, point_m: Point, *, held: str | None) -> Point:
        """(3,) metres in whole centimetres: a point near this one that `reach` reaches."""
        with self._lock:
            self._collisions.look(scene, held)
            return self._reach.nearest(point_m)

    def pose_at(self, joints: Joints) -> HandPose | None:
        """The hand's pose with these joints; None unless it points down."""
        with self._lock:
            return self._kinematics.pose_at(joints)

    def _line(self, start: Joints, goal: HandPose) -> list[Joints]:
        """Knots of a line; with a hand that does not point down, or a wrist at its end, a swing."""
        pose = self._kinematics.pose_at(start)
        if pose is None:
            return _between(start, self._solved(goal, READY))
        turn = turn_between(pose.yaw_rad, goal.yaw_rad)
        way = goal.point - pose.point
        count = steps((float(np.linalg.norm(way)), abs(turn)), (_KNOT_M, _KNOT_RAD))
        knots = [start]
        for part in np.arange(1, count + 1) / count:
            there = HandPose.at(pose.point + part * way, pose.yaw_rad + part * turn)
            joints = self._kinematics.solve(there, knots[-1])
            if joints is None or np.abs(joints - knots[-1]).max() > _JUMP_RAD:
                return _between(start, self._solved(goal, READY))
            knots.append(joints)
        return knots

    def _solved(self, pose: HandPose, seed: Joints) -> Joints:
        joints = self._kinematics.solve(pose, seed)
        if joints is None:
            at = {"x": pose.x_m, "y": pose.y_m, "z": pose.z_m}
            point = {axis: f"{metres:.2f}" for axis, metres in at.items()}
            raise OutOfReach(because("point_too_far", **point))
        return joints

    def _leg(self, knots: Sequence[Joints], pace: Pace, allowed: frozenset[Touch]) -> ArmSegment:
        middles = [(a + b) / 2 for a, b in pairwise(knots)]
        way = [knots[0]]
        for middle, knot in zip(middles, knots[1:], strict=True):
            way += [middle, knot]
        found = self._collisions.first(way, allowed)
        if found is not None:
            raise in_the_way(found)
        points = np.array([self._kinematics.hand_at(knot) for knot in knots])
        rows = written(np.array(knots), points, pace, self._period_s, self._lead_s)
        return ArmSegment(rows, knots[-1])


def above(pose: HandPose, height_m: float) -> HandPose:
    """The same pose at another height."""
    return replace(pose, z_m=height_m)


def _between(start: Joints, end: Joints) -> list[Joints]:
    count = steps((float(np.abs(end - start).max()),), (_KNOT_JOINT_RAD,))
    return [start + part * (end - start) for part in np.linspace(0.0, 1.0, count + 1)]
