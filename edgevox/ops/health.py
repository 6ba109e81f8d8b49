"""Health: is the process able to do its work, and is everything there that it needs?

Alive means not frozen: a long answer or a slow model is work, and no reason to end a robot. Ready
means alive, everything loaded and started, and nothing missing that it was asked to have.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

Look = Callable[[], str]
"""Says what is wrong, in a few words; empty if nothing is. Quick, and from any thread."""

STALL_S = 6.0
"""What should move and has not for this long is frozen."""
STARTING = "starting"


@dataclass(frozen=True, slots=True)
class Report:
    """What each check said; empty is well."""

    checks: Mapping[str, str]

    @property
    def well(self) -> bool:
        """Whether no check found anything."""
        return not any(self.checks.values())

    def as_json(self) -> dict[str, object]:
        """JSON-ready, for people and programs."""
        return {
            "status": "ok" if self.well else "failing",
            "checks": {name: said or "ok" for name, said in self.checks.items()},
        }


class Health:
    """Checks by name, added as parts start. It is ready only once `started` was called."""

    def __init__(self) -> None:
        self._live: dict[str, Look] = {}
        self._ready: dict[str, Look] = {"start": lambda: STARTING}

    def watch(self, name: str, look: Look) -> None:
        """Without this the process cannot do its work, and should be started again."""
        self._live = {**self._live, name: look}

    def require(self, name: str, look: Look) -> None:
        """Without this it is not ready, but a new start would not help."""
        self._ready = {**self._ready, name: look}

    def started(self) -> None:
        """Everything is loaded and started."""
        self._ready = {name: look for name, look in self._ready.items() if name != "start"}

    def live(self) -> Report:
        """Whether it can do its work."""
        return Report({name: _ask(look) for name, look in self._live.items()})

    def ready(self) -> Report:
        """Whether it can be used."""
        return Report({name: _ask(look) for name, look in {**self._live, **self._ready}.items()})


def moves(stalled_s: Callable[[], float], limit_s: float = STALL_S) -> Look:
    """A check of something that says for how long it has stalled."""

    def look() -> str:
        seconds = stalled_s()
        return f"has not moved for {seconds:.1f} s" if seconds > limit_s else ""

    return look


def lives(alive: Callable[[], bool]) -> Look:
    """A check of something with threads."""
    return lambda: "" if alive() else "its thread has ended"


def _ask(look: Look) -> str:
    try:
        return look()
    except Exception as error:  # noqa: BLE001 - a check that breaks is a finding like any other
        return f"the check failed: {error!r}"
