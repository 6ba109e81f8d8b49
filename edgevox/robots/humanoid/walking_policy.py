"""Walking policies: their observation, their answer, and the interface for one of your own.

`OnnxWalkingPolicy` reads an ONNX file of the kind that holosoma trains for the Unitree G1. The
file's metadata brings `dof_names`, `kp` and `kd` as JSON lists of n values. Its one input is a row
of 3 n + 13 float32, its one output the action, a row of n:

    input   last action n | 0.25 x angular velocity 3 | turn command 1 | forward, left command 2 |
            cos of both feet's phase 2 | angle - stand angle n | 0.05 x joint speed n |
            gravity 3 | sin of both feet's phase 2
    output  target angle = stand angle + 0.25 x action

The phases, left foot first, start at 0 and pi and go round once a second; standing, both are pi.
A file with another layout needs a small `WalkingPolicy` of its own.
"""

import json
import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from edgevox.core.errors import InvalidValue

Vector = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class WalkingCommand:
    """The velocity to walk at, in the robot's own frame: m/s ahead, m/s to the left, rad/s left."""

    forward_m_s: float = 0.0
    left_m_s: float = 0.0
    turn_rad_s: float = 0.0

    @property
    def stands(self) -> bool:
        """Whether no motion is asked for at all."""
        return not (self.forward_m_s or self.left_m_s or self.turn_rad_s)


STAND = WalkingCommand()


@dataclass(frozen=True, slots=True)
class Observation:
    """A policy's observation, all of it measurable on a real robot."""

    command: WalkingCommand
    turning_rad_s: Vector
    """The pelvis's angular velocity, (3,), in the pelvis's own axes."""
    gravity: Vector
    """The unit vector that points down, (3,), in the pelvis's own axes."""
    angles_rad: Vector
    """The joints' angles, (n,), in the policy's order."""
    speeds_rad_s: Vector
    """The joints' speeds, (n,), in the policy's order."""


@dataclass(frozen=True)
class WalkingPlan:
    """A policy's demands on the robot: its joints, their servos, the rates."""

    joints: tuple[str, ...]
    """Names of the MJCF's hinges, in the order of all vectors (n,)."""
    stand_rad: Vector
    """The angles of a calm stand."""
    stiffness: Vector
    """N m/rad."""
    damping: Vector
    """N m s/rad."""
    armature: Vector
    """Rotor inertia, kg m^2."""
    period_s: float = 0.02
    """Between two calls of the policy; a whole multiple of `timestep_s`."""
    timestep_s: float = 0.005
    """Of the physics."""
    max_forward_m_s: float = 1.0
    """The fastest command that keeps it on its feet; likewise the next two."""
    max_left_m_s: float = 0.5
    max_turn_rad_s: float = 1.0
    follows: tuple[float, float, float] = (1.0, 1.0, 1.0)
    """The share of a commanded speed (ahead, left, turning) that it really walks at."""

    def __post_init__(self) -> None:
        wanted = (len(self.joints),)
        for field in ("stand_rad", "stiffness", "damping", "armature"):
            shape = getattr(self, field).shape
            if shape != wanted:
                raise InvalidValue(field, shape, f"a vector of shape {wanted}, one for each joint")
        if self.timestep_s <= 0 or self.steps < 1 or not self._whole():
            expected = f"a whole multiple of timestep_s, which is {self.timestep_s}"
            raise InvalidValue("period_s", self.period_s, expected)

    @property
    def steps(self) -> int:
        """Physics steps for each call of the policy."""
        return round(self.period_s / self.timestep_s)

    def _whole(self) -> bool:
        return abs(self.steps * self.timestep_s - self.period_s) < 1e-9


class WalkingPolicy(Protocol):
    """Decides where the joints shall go."""

    @property
    def name(self) -> str:
        """Its name in `robot_state`."""

    @property
    def plan(self) -> WalkingPlan:
        """Its demands on the robot; they do not change."""

    def reset(self) -> None:
        """The robot was put somewhere else: forget what was."""

    def act(self, seen: Observation) -> Vector:
        """Target angles (n,) in radians, in the plan's order of joints."""


class FunctionPolicy:
    """A policy that remembers nothing: one function."""

    def __init__(
        self,
        plan: WalkingPlan,
        function: Callable[[Observation], Vector],
        name: str = "function",
    ) -> None:
        self.name, self.plan, self._function = name, plan, function

    def reset(self) -> None:
        """Do nothing: a function has no state."""

    def act(self, seen: Observation) -> Vector:
        return self._function(seen)


ACTION_SCALE = 0.25
MOST_ACTION = 100.0
GAIT_PERIOD_S = 1.0
PERIOD_S = 0.02
SERVO_HZ = 10.0
"""The servos' natural frequency; with the stiffness it gives the rotor inertia."""

STAND_RAD = {
    "hip_pitch": -0.312,
    "knee": 0.669,
    "ankle_pitch": -0.363,
    "shoulder_pitch": 0.2,
    "left_shoulder_roll": 0.2,
    "right_shoulder_roll": -0.2,
    "elbow": 0.6,
}
"""The calm stand by parts of the joints' names; every other joint is at zero."""

_TURNING_SCALE = 0.25
_SPEED_SCALE = 0.05
_STANDING = np.full(2, math.pi)
_FIRST_STEP = np.array([0.0, math.pi])


class OnnxWalkingPolicy:
    """Runs on one thread that never spins. Raises `InvalidValue` for a file of another kind."""

    def __init__(self, path: Path) -> None:
        self.name = path.stem
        self._session = _open(path)
        self.plan = _read_plan(path, self._session)
        count = len(self.plan.joints)
        self._input = self._session.get_inputs()[0].name
        width = self._session.get_inputs()[0].shape[-1]
        if width != 3 * count + 13:
            expected = f"an ONNX policy whose input has {3 * count + 13} values, not {width}"
            raise InvalidValue("policy", str(path), expected)
        self.reset()

    def reset(self) -> None:
        self._action = np.zeros(len(self.plan.joints))
        self._phase = _STANDING

    def act(self, seen: Observation) -> Vector:
        self._advance(stands=seen.command.stands)
        row = self._row(seen).astype(np.float32)[np.newaxis]
        action = self._session.run(None, {self._input: row})[0][0].astype(np.float64)
        self._action = action.clip(-MOST_ACTION, MOST_ACTION)
        return self.plan.stand_rad + ACTION_SCALE * self._action

    def _advance(self, *, stands: bool) -> None:
        if stands:
            self._phase = _STANDING
        elif self._phase is _STANDING:
            self._phase = _FIRST_STEP
        else:
            self._phase = self._phase + math.tau * PERIOD_S / GAIT_PERIOD_S

    def _row(self, seen: Observation) -> Vector:
        asked = seen.command
        return np.concatenate(
            (
                self._action,
                _TURNING_SCALE * seen.turning_rad_s,
                (asked.turn_rad_s, asked.forward_m_s, asked.left_m_s),
                np.cos(self._phase),
                seen.angles_rad - self.plan.stand_rad,
                _SPEED_SCALE * seen.speeds_rad_s,
                seen.gravity,
                np.sin(self._phase),
            )
        )


def _open(path: Path) -> Any:
    import onnxruntime

    if not path.is_file():
        raise InvalidValue("policy", str(path), "an ONNX file that exists")
    options = onnxruntime.SessionOptions()
    options.intra_op_num_threads = options.inter_op_num_threads = 1
    options.add_session_config_entry("session.intra_op.allow_spinning", "0")
    try:
        return onnxruntime.InferenceSession(str(path), options, providers=["CPUExecutionProvider"])
    except Exception as error:  # noqa: BLE001 - onnxruntime's have no common root
        expected = f"an ONNX model that can be run ({str(error).splitlines()[0]})"
        raise InvalidValue("policy", str(path), expected) from None


def _read_plan(path: Path, session: Any) -> WalkingPlan:
    facts: Mapping[str, str] = session.get_modelmeta().custom_metadata_map
    try:
        joints = tuple(str(name) for name in json.loads(facts["dof_names"]))
        stiffness = np.array(json.loads(facts["kp"]), dtype=np.float64)
        damping = np.array(json.loads(facts["kd"]), dtype=np.float64)
    except (KeyError, ValueError, TypeError):
        expected = "an ONNX policy with dof_names, kp and kd in its metadata"
        raise InvalidValue("policy", str(path), expected) from None
    return WalkingPlan(
        joints=joints,
        stand_rad=np.array([_stand_angle(name) for name in joints]),
        stiffness=stiffness,
        damping=damping,
        armature=stiffness / (math.tau * SERVO_HZ) ** 2,
        period_s=PERIOD_S,
        follows=(0.72, 0.85, 0.92),
    )


def _stand_angle(joint: str) -> float:
    return next((angle for part, angle in STAND_RAD.items() if part in joint), 0.0)
