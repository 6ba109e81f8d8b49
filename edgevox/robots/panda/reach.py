"""Points in the room: which the hand can come to, and which is the next best."""

import re

import numpy as np
from numpy.typing import NDArray

from edgevox.agent.reasons import because
from edgevox.agent.skills import SkillFailed
from edgevox.robots.panda.collisions import Collisions, Touch
from edgevox.robots.panda.kinematics import READY, HandPose, Joints, Kinematics
from edgevox.robots.panda.layout import FAR_M

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
    """What would touch what, as a person says it: the arm's parts first, by their common names."""
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
