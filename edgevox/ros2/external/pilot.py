"""Decides what the robot is asked for: a drive, to stand, or nothing.

Velocities leave from here and from a drive that steers, never from both, and none leaves while the
robot drives by itself.
"""

import threading

from edgevox.agent.reasons import because
from edgevox.agent.skills import SkillFailed
from edgevox.core.cancel import Cancelled
from edgevox.core.log import get_logger
from edgevox.core.reasons import NO_REASON, Reason
from edgevox.ros2.external.drive import Drive
from edgevox.ros2.external.drivers import STILL, GoalTopic, Wheels
from edgevox.ros2.external.senses import Senses
from edgevox.ros2.external.target import Fix

log = get_logger(__name__)

RECALL_EVERY_S = 0.25
"""A goal on its way when it was cancelled would survive it: so it is cancelled again."""
HOLD_AT_LEAST_S = 1.0


class Hold:
    """Zero velocity until the robot is seen to stand, or until it is plain that it does not obey.

    `problem` is why it ended without, once `done`; empty if it stands.
    """

    def __init__(self, now_s: float) -> None:
        self.since_s = now_s
        self.recalled_s = now_s
        self.done = threading.Event()
        self.problem = NO_REASON

    def end(self, problem: Reason = NO_REASON) -> None:
        self.problem = problem
        self.done.set()


class Pilot:
    """Not thread-safe; the body locks. `tick` is called 20 times a second."""

    def __init__(self, senses: Senses, wheels: Wheels, goals: GoalTopic, obey_s: float) -> None:
        self._senses, self._wheels, self._goals = senses, wheels, goals
        self._obey_s = obey_s
        self._drive: Drive | None = None
        self._hold: Hold | None = None

    @property
    def drive(self) -> Drive | None:
        """The drive that runs."""
        return self._drive

    def follow(self, drive: Drive, fix: Fix) -> None:
        """Drive from now on. What takes goals drops the old one for the new one by itself."""
        before, self._drive = self._drive, None
        if before is not None:
            if before.driver is not drive.driver:
                before.driver.cancel(fix)
            before.end(Cancelled("a new goal came"))
        if self._hold:
            self._hold.end()
            self._hold = None
        self._drive = drive
        drive.driver.begin(drive.target, fix)

    def stand(self, reason: BaseException, now_s: float) -> Hold:
        """Stand from now on: zero velocity at once, and until the robot is seen to stand."""
        fix = self._senses.fix()
        self._wheels.turn(STILL)
        if self._drive is None:
            moving = not self._senses.sightings.still()
            self._goals.recall(fix if moving and self._hold is None else None)
        self._end_drive(reason, fix)
        if self._hold is None:
            self._hold = Hold(now_s)
        self._hold.since_s = now_s
        return self._hold

    def tick(self, now_s: float) -> None:
        """Go on with what is asked."""
        if self._drive is not None:
            self._go_on(self._drive, now_s)
        elif self._hold is not None:
            self._hold_on(self._hold, now_s)

    def _go_on(self, drive: Drive, now_s: float) -> None:
        fix = self._senses.fix()
        if fix is None:
            silent = SkillFailed(because("robot_silent", topic=self._senses.odom_topic))
            self.stand(silent, now_s)
            return
        drive.tick(now_s, fix)
        if not drive.done.is_set():
            return
        if drive.error is None:
            self._drive = None
        else:
            self.stand(drive.error, now_s)

    def _hold_on(self, hold: Hold, now_s: float) -> None:
        self._wheels.turn(STILL)
        if now_s - hold.recalled_s >= RECALL_EVERY_S:
            hold.recalled_s = now_s
            self._goals.recall(None)
        held_s = now_s - hold.since_s
        if held_s >= HOLD_AT_LEAST_S and self._senses.sightings.stands(hold.since_s):
            self._hold = None
            hold.end()
        elif held_s > self._obey_s:
            self._hold = None
            problem = self._problem()
            log.error("robot_disobeys", reason=str(problem))
            hold.end(problem)

    def _problem(self) -> Reason:
        if self._senses.sightings.fresh() is None:
            return because("stop_unseen", topic=self._senses.odom_topic)
        return because("still_moves")

    def _end_drive(self, reason: BaseException, fix: Fix | None) -> None:
        if self._drive is not None:
            self._drive.driver.cancel(fix)
            self._drive.end(reason)
            self._drive = None
