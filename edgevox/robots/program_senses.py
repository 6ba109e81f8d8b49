"""A body's facts for programs: its charge, and the way back to its place."""

from edgevox.agent.programs.senses import Senses
from edgevox.agent.skills import Call, SkillFailed
from edgevox.robots.capabilities import Body, HasBattery, HasPose, TellsStalls

_STALLED_S = 1.0
"""A world that has stood still for this long may hold the lock that guards its battery."""
_POINT = "navigate_xy"


def senses_of(body: Body) -> Senses:
    """The senses of this body."""
    return Senses(
        battery=(lambda: _charge(body)) if isinstance(body, HasBattery) else None,
        way_back=lambda: _way_back(body),
    )


def _charge(body: HasBattery) -> float | None:
    stalled_s = body.stalled_s if isinstance(body, TellsStalls) else 0.0
    try:
        return body.battery() if stalled_s < _STALLED_S else None
    except SkillFailed:
        return None


def _way_back(body: Body) -> Call | None:
    """Return the call that drives to the present point; None if the body cannot drive to points."""
    skills = {one.name for one in body.skills}
    if not isinstance(body, HasPose) or _POINT not in skills:
        return None
    pose = body.pose()
    return Call(_POINT, {"x": round(pose.x_m, 2), "y": round(pose.y_m, 2)})
