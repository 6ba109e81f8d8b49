"""Limits and counts of bad requests; a count leaves a line without the request's contents."""

import asyncio
import logging
import ssl
import threading
from collections import Counter, OrderedDict
from collections.abc import Mapping
from enum import StrEnum
from typing import Any

from aiohttp.client_exceptions import ClientPayloadError
from aiohttp.http_exceptions import HttpProcessingError
from aiohttp.web import RequestPayloadError

from edgevox.core.clock import Clock
from edgevox.core.log import get_logger, worth_a_line

log = get_logger(__name__)


MOST_KEYS = 1024
"""The most keys that are remembered, those seen last."""


class PageRateLimit:
    """Up to `burst` at once and `per_s` a second for each key, such as a client or an address."""

    def __init__(self, clock: Clock, per_s: float, burst: int) -> None:
        self._clock = clock
        self._per_s = per_s
        self._burst = burst
        self._left: OrderedDict[str, tuple[float, float]] = OrderedDict()

    def allows(self, key: str) -> bool:
        """Count this request, and return whether it is within the limit."""
        now = self._clock.now()
        left, at = self._left.pop(key, (float(self._burst), now))
        left = min(self._burst, left + (now - at) * self._per_s)
        allowed = left >= 1
        self._left[key] = (left - 1 if allowed else left, now)
        while len(self._left) > MOST_KEYS:
            self._left.popitem(last=False)
        return allowed


class BadRequest(StrEnum):
    """The kinds of bad requests."""

    HTTP = "http"
    """No HTTP, or too much of it."""
    TLS = "tls"
    """A failed encryption."""
    CONNECTION = "connection"
    """A connection that broke off."""
    COOKIE = "cookie"
    """A session that does not exist."""
    ORIGIN = "origin"
    """Another site's page asks."""
    HOST = "host"
    """A name that is not the page's."""
    CODE = "code"
    """A wrong pairing code."""
    MESSAGE = "message"
    """Data on a socket that is no message."""
    CROWD = "crowd"
    """Too many connections, so that an older one was ended."""


UNREADABLE = (HttpProcessingError, ClientPayloadError, RequestPayloadError, UnicodeError)
"""The errors that an unreadable request raises."""


class BadRequests:
    """Counts them. Any thread may."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._counts: Counter[BadRequest] = Counter(dict.fromkeys(BadRequest, 0))

    @property
    def counts(self) -> Mapping[str, int]:
        """The numbers of bad requests, by kind."""
        with self._lock:
            return {str(kind): count for kind, count in self._counts.items()}

    @property
    def total(self) -> int:
        """The number of bad requests."""
        return sum(self.counts.values())

    def count(self, kind: BadRequest) -> None:
        """Count one request; the 1st, 2nd, 4th, 8th, ... of a kind leaves a line."""
        with self._lock:
            self._counts[kind] += 1
            count = self._counts[kind]
        if worth_a_line(count):
            log.warning("console_bad_request", kind=str(kind), count=count)

    def loop_failed(self, _loop: asyncio.AbstractEventLoop, context: Mapping[str, Any]) -> None:
        """The loop's exception handler: what a connection raises is counted."""
        error = context.get("exception")
        if error is None or isinstance(error, (OSError, ssl.SSLError)):
            self.count(BadRequest.CONNECTION)
        else:
            log.error("console_broke", exc_info=error)


class ServerLog(logging.Logger):
    """A substitute for aiohttp's logger, which would write a request's content, and a traceback."""

    def __init__(self, bad: BadRequests) -> None:
        super().__init__("aiohttp.server")
        self._bad = bad

    def debug(self, *_: Any, **told: Any) -> None:
        """Count a request that is no HTTP; ignore the rest, since ended connections are no news."""
        if isinstance(told.get("exc_info"), HttpProcessingError):
            self._bad.count(BadRequest.HTTP)

    def exception(self, *_: Any, **told: Any) -> None:
        """Count what a request raised by its contents; only what is our fault is told."""
        error = told.get("exc_info")
        if isinstance(error, (*UNREADABLE, ConnectionError, TimeoutError)):
            self._bad.count(BadRequest.HTTP)
        else:
            log.error("console_broke", exc_info=error)
