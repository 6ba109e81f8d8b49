"""The velocity input: `cmd_vel`.

Any message takes over, as with twist_mux, even one that says zero: it ends a drive, whose goal ends
as cancelled. A stop must never be ignored. A sender of constant zeros, like a joystick without a
dead man's switch, therefore holds the robot: it should send only while a person steers. The body
halts 0.5 s after the last message.
"""

import math
from collections import Counter

from geometry_msgs.msg import Twist

from edgevox.agent.policy import Guard
from edgevox.agent.skills import SkillFailed
from edgevox.core.errors import EdgeVoxError, InvalidValue, Refusal
from edgevox.core.log import get_logger
from edgevox.core.motion.interlock import Interlock, StreamStopped
from edgevox.robots.limits import Steerable, Steering
from edgevox.ros2.backlog import Backlog
from edgevox.ros2.qos import profile
from edgevox.ros2.standard_topics import STANDARD

log = get_logger(__name__)


class VelocityInput:
    """Hands velocities to the body: `linear.x` and `angular.z`, the two it can follow.

    `refusals` counts refused messages by reason: a NaN or an infinity; any motion while the
    `interlock` is engaged, or after a stop has ended the stream and before the stream pauses; and
    motion that the policy forbids. Nothing of a refused message is used, and the body's watchdog
    runs on. Motion faster than the policy permits is slowed, both numbers by the same factor; the
    body clamps motion beyond its limits.
    """

    def __init__(
        self,
        backlog: Backlog,
        body: Steerable,
        interlock: Interlock | None = None,
        guard: Guard | None = None,
    ) -> None:
        self._steering = Steering(body, interlock or Interlock(), (guard or Guard()).velocity)
        self.refusals: Counter[Refusal] = Counter(
            dict.fromkeys((Refusal.INVALID, Refusal.NOT_FINITE, Refusal.FORBIDDEN), 0)
        )
        self._open = True
        backlog.subscribe(Twist, "cmd_vel", self._take, profile(STANDARD["cmd_vel"].qos))

    def close(self) -> None:
        """Take no more."""
        self._open = False

    def _take(self, message: Twist, mark: int) -> None:
        if not self._open:
            return
        one, two = message.linear, message.angular
        if not all(map(math.isfinite, (one.x, one.y, one.z, two.x, two.y, two.z))):
            wrong = InvalidValue("cmd_vel", _brief(message), "finite numbers")
            self._refuse(wrong, Refusal.NOT_FINITE)
            return
        try:
            self._steering.steer(one.x, two.z, mark)
        except StreamStopped:  # which was logged once, when the stop ended the stream
            self.refusals[Refusal.FORBIDDEN] += 1
        except SkillFailed as error:  # of the policy's `Denied`, too
            self._refuse(error, Refusal.FORBIDDEN)
        except InvalidValue as error:
            self._refuse(error, error.reason)

    def _refuse(self, error: EdgeVoxError, reason: Refusal) -> None:
        self.refusals[reason] += 1
        log.warning("velocity_refused", reason=str(error), refused=self.refusals.total())


def _brief(message: Twist) -> tuple[float, ...]:
    one, two = message.linear, message.angular
    return (one.x, one.y, one.z, two.x, two.y, two.z)
