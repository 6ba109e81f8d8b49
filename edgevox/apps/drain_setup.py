"""What a drain is made of in an agent."""

from edgevox.agent.conversation import Conversation
from edgevox.agent.reasons import because
from edgevox.core.bus import Bus
from edgevox.core.drain import Drain
from edgevox.core.interlock import Interlock
from edgevox.core.settings import Settings
from edgevox.robots.capabilities import Body, HasPose

STANDS_M_S, STANDS_RAD_S = 0.01, 0.01
"""What is slower stands: a simulated robot comes to rest, a real one never measures zero."""


def build_drain(
    settings: Settings, interlock: Interlock, bus: Bus, body: Body | None, talk: Conversation
) -> Drain:
    """It waits for goals as long as the settings say, and to stand for half of `leave_s`."""
    return Drain(
        interlock,
        bus,
        halt=body.halt if body else lambda _: False,
        busy=lambda: talk.busy,
        stands=lambda: stands(body),
        reason=because("draining"),
        bound_s=settings.drain_s,
        stand_s=settings.leave_s / 2,
    )


def stands(body: Body | None) -> bool:
    """Whether it is seen to stand; one that does not say how it moves stands once it was halted."""
    if not isinstance(body, HasPose):
        return True
    now = body.velocity()
    return abs(now.linear_m_s) < STANDS_M_S and abs(now.angular_rad_s) < STANDS_RAD_S
