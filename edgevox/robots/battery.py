"""The skill `battery`, of any body that has one."""

from edgevox.agent.skills import GoalHandle, Result, Skill, skill
from edgevox.robots.capabilities import HasBattery


def battery_skill(body: HasBattery) -> Skill:
    """Make the skill that tells the charge.

    Each language has its sentence in `core/languages/*.toml`.
    """

    @skill(moves=False)
    def battery(goal: GoalHandle) -> Result:
        """Say how full the battery is."""
        goal.token.check()
        charge = body.battery()
        return {"charge": round(charge, 4), "percent": round(100 * charge)}

    return battery
