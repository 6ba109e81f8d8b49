"""The charge of any body that has a battery, and the skill that tells it."""

import math

from edgevox.agent.skills import GoalHandle, Result, Skill, SkillFailed, skill
from edgevox.robots.capabilities import Body, HasBattery, KnowsPowerDraw


def charge_of(body: Body) -> float | None:
    """Return the charge, from 0 to 1; None without a battery, or while it is not known."""
    try:
        return body.battery() if isinstance(body, HasBattery) else None
    except SkillFailed:
        return None


def battery_skill(body: HasBattery) -> Skill:
    """Make the skill that tells the charge.

    Its sentence is `[skills.battery] done` of `core/languages/*.toml`, by `Phrasebook.report`.
    """

    @skill(moves=False)
    def battery(goal: GoalHandle) -> Result:
        """Say how full the battery is."""
        goal.token.check()
        charge = body.battery()
        result = {"charge": round(charge, 4), "percent": round(100 * charge)}
        lasts_s = body.battery_lasts_s() if isinstance(body, KnowsPowerDraw) else math.inf
        return {**result, "lasts_s": round(lasts_s)} if math.isfinite(lasts_s) else result

    return battery
