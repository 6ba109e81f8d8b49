"""Serves health over HTTP, as container engines and clusters ask for it: GET /live, GET /ready."""

from collections.abc import Callable
from http import HTTPStatus

from edgevox.ops.health_checks import Health, Report
from edgevox.ops.http_server import HttpServer, Page, json_page


class HealthServer(HttpServer):
    """Answers with 200 where all is well, else with 503. Raises `InvalidValue`."""

    def __init__(self, health: Health, host: str, port: int) -> None:
        pages = {"/live": _page(health.live), "/ready": _page(health.ready)}
        super().__init__(pages, host, port, setting="health_port", name="edgevox-health")


def _page(look: Callable[[], Report]) -> Callable[[], Page]:
    def page() -> Page:
        report = look()
        status = HTTPStatus.OK if report.well else HTTPStatus.SERVICE_UNAVAILABLE
        return json_page(report.as_json(), status)

    return page
