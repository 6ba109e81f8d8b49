"""A policy file that may change under way: looked at when somebody asks, and read if it did.

What counts is the file that its name leads to now: one written in place, one put in its place, and
a folder's link that is swapped, as Kubernetes does with a ConfigMap.
"""

import threading
from pathlib import Path

from edgevox.agent.policy.policy import Policy, load_policy
from edgevox.core.errors import InvalidValue
from edgevox.core.log import get_logger

log = get_logger(__name__)

Stamp = tuple[int, ...] | str
"""What a file changes with it, or why nothing can be known of it."""


class WatchedFile:
    """Any thread may look; the policy changes as a whole or not at all."""

    def __init__(self, file: Path) -> None:
        """Raises `InvalidValue` for a file that cannot be used."""
        self._lock = threading.Lock()
        self._file = file
        self._seen = _stamp(file)
        self.policy = load_policy(file)
        self.fault = ""
        """Why the file as it is now is not in force; empty if it is."""

    def look(self) -> Policy:
        """The policy in force: the file's, unless that cannot be read since it changed."""
        if _stamp(self._file) == self._seen:
            return self.policy
        with self._lock:
            now = _stamp(self._file)  # before it is read: what changes meanwhile is read again
            if now != self._seen:
                self._read(now)
        return self.policy

    def _read(self, stamp: Stamp) -> None:
        try:
            policy = load_policy(self._file)
        except InvalidValue as error:
            self.fault = str(error)
            # No traceback: the reason says it all.
            log.error("policy_broken", file=str(self._file), reason=self.fault)  # noqa: TRY400
        else:
            self.policy, self.fault = policy, ""
            log.info("policy_changed", file=str(self._file))
        self._seen = stamp


def _stamp(file: Path) -> Stamp:
    try:
        found = file.stat()
    except (OSError, ValueError) as error:
        return str(error)
    return (found.st_dev, found.st_ino, found.st_size, found.st_mtime_ns, found.st_ctime_ns)
