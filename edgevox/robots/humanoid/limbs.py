"""Finds a robot's legs and arms by what its joints are called and how they turn."""

import re
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import mujoco

Side = Literal["left", "right"]
SIDES: tuple[Side, Side] = ("left", "right")
_PART = {
    "hip": re.compile("hip"),
    "knee": re.compile("knee"),
    "ankle": re.compile("ank"),
    "shoulder": re.compile("sho"),
    "elbow": re.compile("elbow|(?:^|[_.])el(?=[_.]|$)"),
}
_SIDE = {
    "left": re.compile(r"left|(?:^|[_.])l(?=[_.]|$)"),
    "right": re.compile(r"right|(?:^|[_.])r(?=[_.]|$)"),
}
_PITCH = 0.7
"""A joint that turns about the y axis, to less than 45 degrees, swings a limb ahead and back."""


@dataclass(frozen=True, slots=True)
class Hinge:
    """One joint: its number in the model, where its angle is in `qpos`, where its speed is.

    `sign` says which way is positive: 1 if, as about the y axis, what hangs down swings back.
    `pitches` is whether it swings ahead and back at all.
    """

    joint: int
    angle: int
    speed: int
    sign: int
    pitches: bool


@dataclass(frozen=True)
class Limbs:
    """The hinges of one side by part ("hip", "knee", ...), in the order of the model."""

    parts: dict[str, tuple[Hinge, ...]]

    @property
    def leg(self) -> tuple[Hinge, ...]:
        """From the hip down."""
        return self.parts["hip"] + self.parts["knee"] + self.parts["ankle"]

    @property
    def steps(self) -> bool:
        """Whether this leg can set its foot somewhere: it has a hip and a knee that swing."""
        return all(self.swinging(part) is not None for part in ("hip", "knee"))

    def swinging(self, part: str) -> Hinge | None:
        """The joint of this part that swings ahead and back."""
        return next((hinge for hinge in self.parts[part] if hinge.pitches), None)


def find_limbs(model: mujoco.MjModel, data: mujoco.MjData) -> tuple[Limbs, Limbs]:
    """Left and right, whatever was found. The kinematics must be up to date, the base level."""
    names = [model.joint(number).name.lower() for number in range(model.njnt)]
    left, right = (_limbs(model, data, names, side) for side in SIDES)
    return left, right


def _limbs(model: mujoco.MjModel, data: mujoco.MjData, names: Sequence[str], side: Side) -> Limbs:
    own = [
        number
        for number, name in enumerate(names)
        if _SIDE[side].search(name) and model.jnt_type[number] == mujoco.mjtJoint.mjJNT_HINGE
    ]
    return Limbs(
        {
            part: tuple(
                _hinge(model, data, number) for number in own if called.search(names[number])
            )
            for part, called in _PART.items()
        },
    )


def _hinge(model: mujoco.MjModel, data: mujoco.MjData, number: int) -> Hinge:
    about_y = float(data.xaxis[number][1])
    return Hinge(
        joint=number,
        angle=int(model.jnt_qposadr[number]),
        speed=int(model.jnt_dofadr[number]),
        sign=1 if about_y >= 0 else -1,
        pitches=abs(about_y) > _PITCH,
    )
