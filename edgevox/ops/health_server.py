"""Serves health over HTTP, as container engines and clusters ask for it: GET /live, GET /ready.

PUT /drain, from this machine only, begins a drain; GET /drain tells how far it is.
"""

from collections.abc import Callable
from http import HTTPStatus

from edgevox.core.agent_events import DrainStatus
from edgevox.ops.health_checks import Health, Report
from edgevox.ops.http_server import HttpServer, Page, json_page

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
            pages, host, port, setting="health_port", name="edgevox-health", orders=orders
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
