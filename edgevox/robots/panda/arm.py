"""The motors of arm and hand, period by period. Everything here needs the world's lock."""

import mujoco
import numpy as np

from edgevox.agent.reasons import because
from edgevox.agent.skills import SkillFailed
from edgevox.robots.panda.arm_motion import NO_ROWS, ArmMotion
from edgevox.robots.panda.hand import Hand
from edgevox.robots.panda.kinematics import ARM_JOINTS, READY, Joints
from edgevox.robots.panda.path import Rows

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
        """At home, with an open hand, at once: for the start of a world."""
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
        """For a moment the motors only damp; a spring to where they stopped would swing it back."""
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
