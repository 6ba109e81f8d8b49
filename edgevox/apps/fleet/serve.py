"""Serves the page of a fleet, on this machine only, until somebody leaves."""

import threading
from collections.abc import Callable
from contextlib import ExitStack
from importlib.resources import files
from pathlib import Path

from edgevox.apps.fleet.robots_file import load_fleet
from edgevox.apps.fleet.watch import FleetWatch
from edgevox.apps.shutdown_signals import ShutdownSignals
from edgevox.apps.streams import show
from edgevox.core.settings import Settings
from edgevox.ops.http_server import HttpServer, Page, json_page

LOOPBACK = "127.0.0.1"
FLEET_PORT = 8440
_STATIC = {
    "/": ("index.html", "text/html; charset=utf-8"),
    "/fleet.js": ("fleet.js", "text/javascript; charset=utf-8"),
    "/fleet.css": ("fleet.css", "text/css; charset=utf-8"),
}


def serve_fleet(robots: Path, port: int, settings: Settings) -> bool:
    """Serve the page of the robots that a file names, until somebody leaves.

    Raises `InvalidValue` for a file that is wrong and for a port that is taken.
    """
    watch = FleetWatch(load_fleet(robots))
    with ExitStack() as stack, ShutdownSignals(settings.leave_s):
        server = fleet_server(watch, port)
        for part in (watch, server):
            stack.callback(part.close)
            part.start()
        show(f"{len(watch.as_json())} robots on http://localhost:{server.port}")
        threading.Event().wait()
    return True


def fleet_server(watch: FleetWatch, port: int) -> HttpServer:
    """The page and what it asks for. Raises `InvalidValue` where it cannot listen."""
    pages = {path: _page(*static) for path, static in _STATIC.items()}
    pages["/robots"] = lambda: json_page({"robots": watch.as_json()})
    return HttpServer(pages, LOOPBACK, port, setting="fleet_port", name="edgevox-fleet-page")


def _page(name: str, content_type: str) -> Callable[[], Page]:
    body = files("edgevox.apps.fleet").joinpath("page", name).read_bytes()
    page = Page(body, content_type)
    return lambda: page
