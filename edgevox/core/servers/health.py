"""Whether a server is asked now: the breaker, and what the status says of the server."""

import threading
from typing import Literal

from edgevox.core.clock import Clock, SystemClock
from edgevox.core.log import get_logger
from edgevox.core.servers.errors import OddAnswer, RequestRefused, ServerBusy, ServerFailed

log = get_logger(__name__)

FIRST_REST_S, LONGEST_REST_S = 15.0, 240.0

MOST_ODD = 3
"""So many odd answers in a row are a failure; fewer are none."""

Part = Literal["llm", "stt", "tts"]


class Breaker:
    """A circuit breaker: each failure on end doubles the rest, one success ends it."""

    def __init__(self, clock: Clock | None = None) -> None:
        self._clock = clock or SystemClock()
        self._lock = threading.Lock()
        self._rest_s = 0.0
        self._until_s = 0.0

    @property
    def resting(self) -> bool:
        """True while it is too early to try again."""
        return self._rest_s > 0 and self._clock.now() < self._until_s

    def failed(self) -> bool:
        """Record a failure; True for the first of a row."""
        with self._lock:
            first = self._rest_s == 0
            self._rest_s = FIRST_REST_S if first else min(2 * self._rest_s, LONGEST_REST_S)
            self._until_s = self._clock.now() + self._rest_s
            return first

    def succeeded(self) -> bool:
        """Record a success; True if the last attempt had failed."""
        with self._lock:
            recovered = self._rest_s > 0
            self._rest_s = 0.0
            return recovered


class ServerHealth:
    """What came of asking a server; logs when it fails and when it is back. For any thread.

    `part` is what the server does; `instead` is what answers while it cannot. A server that is full
    is asked again by the next request: it has not failed. Neither has one that refused a request,
    or gave an odd answer now and then.
    """

    def __init__(
        self, part: Part, server: str, instead: str, breaker: Breaker | None = None
    ) -> None:
        self.server = server
        self.fault = ""
        """The reason why the server rests; empty once it answers again."""
        self.fallbacks = 0
        """Requests that had to be answered on board."""
        self.turned_away = 0
        """Requests for which the server had no room."""
        self._part: Part = part
        self._instead = instead
        self._breaker = breaker or Breaker()
        self._full = False
        self._odd = 0

    @property
    def resting(self) -> bool:
        """True while it is too early to ask again."""
        return self._breaker.resting

    def works(self) -> None:
        """Record an answer."""
        self.fault = ""
        if self._breaker.succeeded():
            log.warning("model_server_back", part=self._part, server=self.server)
        self._full = False
        self._odd = 0

    def fails(self, error: ServerFailed) -> None:
        """Record a failure."""
        told = {"part": self._part, "server": self.server, "reason": str(error)}
        if isinstance(error, ServerBusy):
            self.turned_away += 1
            if not self._full:
                log.warning("model_server_full", **told, instead=self._instead)
            self._full = True
            return
        if isinstance(error, RequestRefused):
            log.warning("model_server_refused", **told)
            return
        if isinstance(error, OddAnswer):
            self._odd += 1
            if self._odd < MOST_ODD:
                log.warning("model_server_odd", **told)
                return
        self.fault = str(error)
        if self._breaker.failed():
            log.warning("model_server_failed", **told, instead=self._instead)

    def figures(self) -> dict[str, bool | int]:
        """What the status says of the server."""
        return {
            "server_up": not self.fault,
            "fallbacks": self.fallbacks,
            "turned_away": self.turned_away,
        }
