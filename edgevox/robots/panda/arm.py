"""The motors of arm and gripper, period by period. Everything here needs the world's lock."""

import mujoco
import numpy as np

from edgevox.agent.skills import SkillFailed
from edgevox.agent.text.reasons import because
from edgevox.robots.panda.kinematics import ARM_JOINTS, READY, Joints
from edgevox.robots.panda.motion import NO_ROWS, ArmMotion, Rows
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
        """Return whether the fingers stand."""
        return bool(np.abs(self._speeds).max() < _STILL_M_S)

    def touches(self, name: str) -> bool:
        """Return whether both fingers press on this cube."""
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


_ARRIVED_RAD = 0.006
_STILL_RAD_S = 0.03
_STRAINED_RAD = 0.45
_WATCH_EVERY = 5
_COAST = 15
_BRAKE = 6
_IMPATIENT = 60
_GRIP = 6


class Arm:
    """Follows one motion at a time. `target` is where the joints are held when there is none."""

    def __init__(self, model: mujoco.MjModel, data: mujoco.MjData) -> None:
        self.hand = Hand(model, data)
        self._joints = data.qpos[:ARM_JOINTS]
        self._speeds = data.qvel[:ARM_JOINTS]
        self._control = data.ctrl[:ARM_JOINTS]
        self.target: Joints = READY.copy()
        self.motion: ArmMotion | None = None
        self._end: Joints = READY.copy()
        self._coast = 0

    @property
    def still(self) -> bool:
        """Whether no joint turns."""
        return bool(np.abs(self._speeds).max() < _STILL_RAD_S)

    @property
    def moving(self) -> bool:
        """Whether it follows a motion, or a joint still turns."""
        return self.motion is not None or not self.still

    @property
    def speeds(self) -> Joints:
        """(7,) radians per second, as they are now."""
        return np.array(self._speeds)

    @property
    def joints(self) -> Joints:
        """(7,) radians, as they are now."""
        return np.array(self._joints)

    def put(self) -> None:
        """Put the arm at home at once, with an open hand: for the start of a world."""
        self._joints[:] = self._control[:] = self.target = READY.copy()
        self._coast = 0  # it is at rest; what it was slowing down from is over
        self.hand.put_open()

    def follow(self, rows: Rows, end: Joints) -> ArmMotion:
        """Move. Fails if something holds the arm back."""
        self._end = end
        blocked = SkillFailed(because("held_back"))
        return self._begin(
            ArmMotion(rows, settled=self._arrived, patience=_IMPATIENT, impatient=blocked)
        )

    def grip(self, width_m: float) -> ArmMotion:
        """Open or close the hand so far, or until it holds something."""
        self._end = self.target
        self.hand.command(width_m)
        return self._begin(
            ArmMotion(settled=self.hand.has_stopped, patience=_IMPATIENT, least=_GRIP)
        )

    def rest(self, periods: int) -> ArmMotion:
        """Keep still while the world comes to rest."""
        self._end = self.target
        return self._begin(ArmMotion(NO_ROWS, settled=lambda: False, patience=periods))

    def freeze(self, error: BaseException) -> None:
        """Stop where it is, with what it holds. The motion ends with `error`."""
        self.hand.freeze()
        self._coast = _COAST
        self._brake()
        self._finish(error)

    def tick(self) -> bool:
        """Set the motors for one period; True while there is more to do."""
        motion = self.motion
        if motion is None:
            return self._brake()
        if motion.row < len(motion.rows):
            self._control[:] = motion.rows[motion.row]
            motion.row += 1
            if motion.row % _WATCH_EVERY == 0:
                self._watch()
        else:
            self._settle(motion)
        return True

    def _brake(self) -> bool:
        """Let the motors only damp for a moment.

        A spring to the stopping point would swing back.
        """
        if self._coast > _COAST - _BRAKE:
            self.target = self.joints
            self._control[:] = self.target
        self._coast = max(0, self._coast - 1)
        return self._coast > 0

    def _begin(self, motion: ArmMotion) -> ArmMotion:
        self._coast = 0
        self.motion = motion
        return motion

    def _settle(self, motion: ArmMotion) -> None:
        motion.left -= 1
        if self._lost():
            return
        motion.least -= 1
        if motion.least <= 0 and motion.settled():
            self._reach()
        elif motion.left <= 0 and motion.impatient is not None:
            self.freeze(motion.impatient)
        elif motion.left <= 0:
            self._reach()

    def _reach(self) -> None:
        self.target = self._end
        self._finish(None)

    def _finish(self, error: BaseException | None) -> None:
        motion, self.motion = self.motion, None
        if motion is not None:
            motion.end(error)

    def _arrived(self) -> bool:
        return self.still and bool(np.abs(self._joints - self._end).max() < _ARRIVED_RAD)

    def _watch(self) -> None:
        if not self._lost() and np.abs(self._control - self._joints).max() > _STRAINED_RAD:
            self.freeze(SkillFailed(because("held_back")))

    def _lost(self) -> bool:
        """Notice that what was held slipped away, and stop."""
        lost = self.hand.lost()
        if lost is None:
            return False
        self.freeze(SkillFailed(because("dropped", thing=lost.replace("_", " "))))
        return True
