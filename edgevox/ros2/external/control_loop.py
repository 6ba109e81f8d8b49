"""The control loop: at 20 Hz, tells the robot to go on with a drive, to stand, or nothing.

Velocities leave from here and from a drive that steers, never from both, and none leaves while the
robot drives by itself.
"""

from contextlib import AbstractContextManager

from edgevox.agent.skills import SkillFailed
from edgevox.agent.text.reasons import because
from edgevox.core.clock import Clock
from edgevox.core.log import get_logger
from edgevox.core.reason import Reason
from edgevox.robots.capabilities import Twist2D
from edgevox.robots.command_mux import STILL, CommandMux
from edgevox.robots.motion import Motion, Progress
from edgevox.ros2.external.inputs import SensorInputs
from edgevox.ros2.external.motion import GoalTopicBackend, PoseEstimate, VelocityPublisher
from edgevox.ros2.external.navigation import ExternalMotion

log = get_logger(__name__)

RECALL_EVERY_S = 0.25
"""A goal on its way when it was cancelled would survive it: so it is cancelled again."""
HOLD_AT_LEAST_S = 1.0


class ZeroVelocity(Motion):
    """Sends zero velocity until the robot stands; fails if the robot plainly does not obey."""

    def __init__(self, now_s: float) -> None:
        super().__init__()
        self.since_s = now_s
        self.recalled_s = now_s

    def progress(self) -> Progress:
        """Return 0 or 1: the time until it stands is unknown."""
        return Progress(1.0 if self.done else 0.0)


class ControlLoop:
    """The loop; the body holds the lock for `start` and `tick`.

    `mux` decides what moves the robot. `hold` is the newest halt's.
    """

    def __init__(
        self,
        lock: AbstractContextManager[object],
        senses: SensorInputs,
        wheels: VelocityPublisher,
        goals: GoalTopicBackend,
        *,
        clock: Clock,
        obey_s: float,
    ) -> None:
        self.mux: CommandMux[ExternalMotion] = CommandMux(lock, on_halt=self._stand)
        self.hold = ZeroVelocity(clock.now())
        self.hold.end()
        self._senses, self._wheels, self._goals = senses, wheels, goals
        self._clock, self._obey_s = clock, obey_s

    def start(self, drive: ExternalMotion, estimate: PoseEstimate) -> None:
        """Drive from now on. What takes goals drops the old one for the new one by itself.

        Where a backend raises, the drive has ended with that and the robot is held.
        """
        before = self.mux.motion
        self.mux.start(lambda: drive)
        try:
            if before is not None and not drive.replaces(before):
                before.cancel(estimate)
            self.hold.end()
            drive.begin(estimate)
        except Exception as error:
            self.mux.halt(error)
            raise

    def steer(self, twist: Twist2D) -> None:
        """Turn the wheels for a drive that steers them, no faster than it may."""
        self._wheels.turn(self.mux.limit(twist))

    def tick(self) -> None:
        """Go on with what is asked."""
        now_s, drive = self._clock.now(), self.mux.motion
        if drive is not None:
            self._go_on(drive, now_s)
        elif not self.hold.done:
            self._hold_on(self.hold, now_s)

    def _go_on(self, drive: ExternalMotion, now_s: float) -> None:
        estimate = self._senses.estimate()
        try:
            if estimate is None:
                raise SkillFailed(because("robot_silent", topic=self._senses.odom_topic))
            drive.tick(now_s, estimate)
        except SkillFailed as failure:
            self.mux.halt(failure)

    def _stand(self, drive: ExternalMotion | None, _error: BaseException) -> None:
        """Zero velocity at once, and until the robot is seen to stand."""
        estimate, now_s = self._senses.estimate(), self._clock.now()
        held = not self.hold.done
        self._wheels.turn(STILL)
        if drive is not None:
            drive.cancel(estimate)
        else:
            moving = not self._senses.odometry_history.still()
            self._goals.recall(estimate if moving and not held else None)
        if not held:
            self.hold = ZeroVelocity(now_s)
        self.hold.since_s = now_s

    def _hold_on(self, hold: ZeroVelocity, now_s: float) -> None:
        self._wheels.turn(STILL)
        if now_s - hold.recalled_s >= RECALL_EVERY_S:
            hold.recalled_s = now_s
            self._goals.recall(None)
        held_s = now_s - hold.since_s
        if held_s >= HOLD_AT_LEAST_S and self._senses.odometry_history.stands(hold.since_s):
            hold.end()
        elif held_s > self._obey_s:
            problem = self._problem()
            log.error("robot_disobeys", reason=str(problem))
            hold.end(SkillFailed(problem))

    def _problem(self) -> Reason:
        if self._senses.odometry_history.fresh() is None:
            return because("stop_unseen", topic=self._senses.odom_topic)
        return because("still_moves")
