"""The lease: one operator commands at a time. The robot gives it, hands it over, takes it back."""

from dataclasses import dataclass, field

from edgevox.core.clock import Clock

IDLE_S = 60.0
"""A holder that commands nothing for this long loses the lease to a client that waits."""
GONE_S = 10.0
"""A holder that is away for this long loses the lease; a page that reloads is not away."""


@dataclass(frozen=True, slots=True)
class LeaseState:
    """The lease, in clients' ids."""

    holder: str | None = None
    """The client that commands."""
    waiting: tuple[str, ...] = ()
    """The clients that asked for it, the first one first."""


@dataclass
class Lease:
    """The lease, for one thread. Clients are operators, which the caller has checked."""

    clock: Clock
    state: LeaseState = field(default_factory=LeaseState)
    _used_s: float = 0.0
    _left_s: float | None = None

    def take(self, client: str) -> bool:
        """Take it if it is free; return whether this client holds it now."""
        if self.state.holder is None:
            self._hand_to(client)
        return self.state.holder == client

    def request(self, client: str) -> None:
        """Take it, or stand in line."""
        if not self.take(client) and client not in self.state.waiting:
            self.state = LeaseState(self.state.holder, (*self.state.waiting, client))

    def withdraw(self, client: str) -> None:
        """Let a client wait no longer."""
        waiting = tuple(one for one in self.state.waiting if one != client)
        self.state = LeaseState(self.state.holder, waiting)

    def give(self, client: str, to: str | None = None) -> bool:
        """Let the holder give it to a waiting client, by default the first.

        Return whether that worked.
        """
        if self.state.holder != client or (to is not None and to not in self.state.waiting):
            return False
        self._hand_to(to or self._first())
        return True

    def used(self, client: str) -> None:
        """A client has commanded something."""
        if self.state.holder == client:
            self._used_s = self.clock.now()

    def gone(self, client: str) -> None:
        """None of this client's pages is there; it no longer waits."""
        self.withdraw(client)
        if self.state.holder == client:
            self._left_s = self.clock.now()

    def came(self, client: str) -> None:
        """A page of this client is there."""
        if self.state.holder == client:
            self._left_s = None

    def revoke(self, client: str) -> None:
        """A client is no longer let in."""
        self.gone(client)
        if self.state.holder == client:
            self._hand_to(self._first())

    def tick(self) -> None:
        """Take it back from an absent holder, or from an idle one while another client waits."""
        now, waiting = self.clock.now(), self.state.waiting
        away = self._left_s is not None and now - self._left_s >= GONE_S
        idle = bool(waiting) and now - self._used_s >= IDLE_S
        if self.state.holder is not None and (away or idle):
            self._hand_to(self._first())

    def _first(self) -> str | None:
        return self.state.waiting[0] if self.state.waiting else None

    def _hand_to(self, client: str | None) -> None:
        waiting = tuple(one for one in self.state.waiting if one != client)
        self.state = LeaseState(client, waiting)
        self._used_s, self._left_s = self.clock.now(), None
