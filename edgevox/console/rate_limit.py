"""How often somebody may do something: a bucket of tokens that fills at a steady rate."""

from collections import OrderedDict

from edgevox.core.clock import Clock

MOST_KEYS = 1024
"""So many are remembered, those seen last."""


class PageRateLimit:
    """Up to `burst` at once and `per_s` a second for each key, such as a client or an address."""

    def __init__(self, clock: Clock, per_s: float, burst: int) -> None:
        self._clock = clock
        self._per_s = per_s
        self._burst = burst
        self._left: OrderedDict[str, tuple[float, float]] = OrderedDict()

    def allows(self, key: str) -> bool:
        """Whether this one is within the limit; it counts."""
        now = self._clock.now()
        left, at = self._left.pop(key, (float(self._burst), now))
        left = min(self._burst, left + (now - at) * self._per_s)
        allowed = left >= 1
        self._left[key] = (left - 1 if allowed else left, now)
        while len(self._left) > MOST_KEYS:
            self._left.popitem(last=False)
        return allowed
