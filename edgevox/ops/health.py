"""Health: is the process able to do its work, and is everything there that it needs?

Alive means not frozen: a long answer or a slow model is work, and no reason to end a robot. Ready
means alive, everything loaded and started, and nothing missing that it was asked to have.

Serves health over HTTP, as container engines and clusters ask for it: GET /live, GET /ready.

GET /status tells more to whoever watches many robots: the version, the image, and the status of
each component.

PUT /drain, from this machine only, begins a drain; GET /drain tells how far it is.
"""

import os
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from http import HTTPStatus

from edgevox import __version__
from edgevox.core.agent_events import DrainStatus
from edgevox.core.motion.drain import Drain
from edgevox.core.status import Components, HealthCheck
from edgevox.ops.http_server import HttpServer, Page, json_page

IMAGE = "EDGEVOX_IMAGE"
"""The variable by which a container is told of what image it is."""
_TOLD_WHOLE = ("sim", "interlock", "recordings", "disk", "clock", "recorder")
"""The components of which /status tells the values: whoever reaches the port may read them."""


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

    def status(self) -> Mapping[str, object]:
        """What it is and how each component is, JSON-ready. May hang where a component does."""
        return {
            "version": __version__,
            "image": os.environ.get(IMAGE, ""),
            "components": [
                {
                    "name": one.name,
                    "level": int(one.level),
                    "message": one.message,
                    "values": dict(one.values) if one.name in _TOLD_WHOLE else {},
                }
                for one in self._components.statuses()
            ],
        }

    def _checks(self) -> list[HealthCheck]:
        return [*self._own, *self._components.checks]


ASKED_HERE = "edgevox-health"
"""Who asked for a drain that came this way."""


class HealthServer(HttpServer):
    """Answers with 200 where all is well, else with 503. Raises `InvalidValue`.

    Of a drain: 200 once the robot stands, 202 until then, 500 if it is not seen to, 404 before
    anybody asked, 503 where there is nothing that could be drained.
    """

    def __init__(self, health: Health, host: str, port: int) -> None:
        pages = {
            "/live": _page(health.live),
            "/ready": _page(health.ready),
            "/drain": lambda: _drain_page(health),
        }
        orders = {"/drain": lambda: _begin_drain(health)}
        super().__init__(
            pages,
            host,
            port,
            setting="health_port",
            name="edgevox-health",
            orders=orders,
            slow_pages={"/status": lambda: json_page(health.status())},
        )


def _page(look: Callable[[], Report]) -> Callable[[], Page]:
    def page() -> Page:
        report = look()
        status = HTTPStatus.OK if report.well else HTTPStatus.SERVICE_UNAVAILABLE
        return json_page(report.as_json(), status)

    return page


_DRAIN = {
    None: HTTPStatus.NOT_FOUND,
    DrainStatus.DRAINING: HTTPStatus.ACCEPTED,
    DrainStatus.DRAINED: HTTPStatus.OK,
    DrainStatus.NOT_STANDING: HTTPStatus.INTERNAL_SERVER_ERROR,
}


def _begin_drain(health: Health) -> Page:
    if health.drain is None:
        error = {"error": "nothing that could be drained has started here"}
        return json_page(error, HTTPStatus.SERVICE_UNAVAILABLE)
    health.drain.begin(ASKED_HERE)
    return _drain_page(health)


def _drain_page(health: Health) -> Page:
    drain = health.drain
    status = drain.status if drain else None
    told = {"status": str(status or "none"), "within_s": drain.limit_s if drain else 0.0}
    return json_page(told, _DRAIN[status])
