"""How fast the network learns at which step."""

import math

FASTEST = 3e-3
WARMING_STEPS = 50
_SLOWEST = 0.01  # of the fastest


def rate(step: int, steps: int) -> float:
    """The learning rate of this step of so many, counted from 0: up soon, then down to the end."""
    done = step / steps
    falling = max(_SLOWEST, math.cos(done * math.pi / 2) ** 2)
    return FASTEST * min(1.0, (step + 1) / WARMING_STEPS) * falling
