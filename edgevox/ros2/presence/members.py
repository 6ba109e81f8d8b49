"""Who is here, and who is in charge: the same answer in every process that hears the same claims.

The rule: whoever was told to take over last, else who has been here alone, else who started first.
So the later one waits, and the clocks of two machines need not agree, unless both start within
seconds of each other; then one of them is in charge all the same, and only one.

Time is counted in own words that came back over the wire, once a second: whoever is frozen, or
whose executor is held up, counts nothing, and takes nobody for gone whom it did not listen to.
"""

from dataclasses import replace

from edgevox.core.errors import InvalidValue
from edgevox.ros2.presence.claim import MOST_TERM, Claim

GONE_BEATS = 4
"""Who is not heard for so many of our own beats is gone."""
SETTLED_BEATS = 5
"""Alone for so many is to have been here first: discovery takes 3 s at most."""
MOST_OTHERS = 32


class Members:
    """The claims of all agents of a namespace. Not thread-safe."""

    def __init__(self, me: Claim) -> None:
        self.me = me
        self._others: dict[str, Claim] = {}
        self._missed: dict[str, int] = {}
        self._alone_beats = 0

    @property
    def others(self) -> tuple[Claim, ...]:
        """Those that are here beside this one, the best claim first."""
        return tuple(sorted(self._others.values(), key=lambda claim: claim.rank))

    @property
    def charge(self) -> Claim | None:
        """Who moves the robot; None if nobody here has one."""
        able = [claim for claim in (self.me, *self.others) if claim.robot]
        return min(able, key=lambda claim: claim.rank, default=None)

    @property
    def in_charge(self) -> bool:
        """Whether this one does."""
        return self.charge == self.me

    def hear(self, claim: Claim) -> None:
        """Take what another agent says of itself."""
        if claim.leaving:
            self._forget(claim.id)
        elif claim.id in self._others or len(self._others) < MOST_OTHERS:
            self._others[claim.id] = claim
            self._missed[claim.id] = 0
            self._alone_beats = 0

    def give(self, agent_id: str) -> bool:
        """Put this agent in charge, if it is this one; whether it is. Raises `InvalidValue`."""
        if agent_id != self.me.id:
            if agent_id not in self._others:
                known = (self.me.id, *self._others)
                raise InvalidValue("take_over", agent_id, f"one of {', '.join(known)}")
            return False
        if not self.me.robot:
            raise InvalidValue("take_over", agent_id, "an agent that has a robot")
        if not self.in_charge:
            highest = max(claim.term for claim in self.others)
            self.me = replace(self.me, term=min(highest + 1, MOST_TERM))
        return True

    def beat(self) -> None:
        """Another second has passed in which this agent listened."""
        for agent_id in list(self._others):
            self._missed[agent_id] += 1
            if self._missed[agent_id] >= GONE_BEATS:
                self._forget(agent_id)
        if not self._others:
            self._alone_beats += 1
        if self._alone_beats >= SETTLED_BEATS and not self.me.term:
            self.me = replace(self.me, term=1)

    def _forget(self, agent_id: str) -> None:
        self._others.pop(agent_id, None)
        self._missed.pop(agent_id, None)
