"""A planner for the hand: straight lines as joint angles that are in reach and touch nothing."""

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
from edgevox.robots.panda.collisions import Collisions, Touch
from edgevox.robots.panda.kinematics import READY, HandPose, Joints, Kinematics
from edgevox.robots.panda.motion import Pace, Rows, steps, written
from edgevox.robots.panda.table import FAR_M

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
