"""Health: is the process able to do its work, and is everything there that it needs?

Alive means not frozen: a long answer or a slow model is work, and no reason to end a robot. Ready
means alive, everything loaded and started, and nothing missing that it was asked to have.
"""

from collections.abc import Mapping
from dataclasses import dataclass

from edgevox.core.drain import Drain
from edgevox.core.status import Components, HealthCheck


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
    """Shows the checks of components, after those that were added and are of none.

    It is ready only once `started` was called.
    """

    def __init__(self, components: Components) -> None:
        self._components = components
        self.drain: Drain | None = None
        self._own: tuple[HealthCheck, ...] = (
            HealthCheck("start", lambda: "starting", vital=False),
        )

    def offer(self, drain: Drain) -> None:
        """Let whoever may ask for this drain; from its beginning on it is not ready."""
        self.drain = drain
        self.add(HealthCheck("drain", lambda: str(drain.status or ""), vital=False))

    def add(self, check: HealthCheck) -> None:
        """Ask this, too."""
        self._own = (*self._own, check)

    def started(self) -> None:
        """Everything is loaded and started."""
        self._own = tuple(one for one in self._own if one.name != "start")

    def live(self) -> Report:
        """Whether it can do its work."""
        return Report({one.name: one.said() for one in self._checks() if one.vital})

    def ready(self) -> Report:
        """Whether it can be used."""
        vital_first = sorted(self._checks(), key=lambda one: not one.vital)
        return Report({one.name: one.said() for one in vital_first})

    def _checks(self) -> list[HealthCheck]:
        return [*self._own, *self._components.checks]
