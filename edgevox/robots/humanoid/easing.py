"""Speeds that rise evenly and fall at once: a robot must not be torn off its feet."""

from edgevox.robots.humanoid.walking_policy import WalkingCommand

RISE_M_S2 = 1.0
RISE_RAD_S2 = 2.0


def eased(now: WalkingCommand, wanted: WalkingCommand, seconds: float) -> WalkingCommand:
    """What to walk at next: `wanted`, or as near to it as speeds may rise in this time."""
    if wanted == now:
        return now
    return WalkingCommand(
        _risen(now.forward_m_s, wanted.forward_m_s, RISE_M_S2 * seconds),
        _risen(now.left_m_s, wanted.left_m_s, RISE_M_S2 * seconds),
        _risen(now.turn_rad_s, wanted.turn_rad_s, RISE_RAD_S2 * seconds),
    )


def _risen(now: float, wanted: float, most: float) -> float:
    if wanted >= 0.0:
        return min(wanted, max(now, 0.0) + most)
    return max(wanted, min(now, 0.0) - most)
