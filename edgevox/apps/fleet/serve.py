"""Serves the page of a fleet, on this machine only, until somebody leaves."""

import threading
from collections.abc import Callable
from contextlib import ExitStack
from importlib.resources import files
from pathlib import Path

from edgevox.apps.fleet.robots_file import load_fleet
from edgevox.apps.fleet.watch import FleetWatch
from edgevox.apps.run_program import run_program, set_up_logs
from edgevox.apps.shutdown_signals import ShutdownSignals
from edgevox.core.settings import Settings, load_settings
from edgevox.ops.http_server import HttpServer, Page, json_page

PROGRAM = "edgevox-console"
LOOPBACK = "127.0.0.1"
FLEET_PORT = 8440
_STATIC = {
    "/": ("index.html", "text/html; charset=utf-8"),
    "/fleet.js": ("fleet.js", "text/javascript; charset=utf-8"),
    "/fleet.css": ("fleet.css", "text/css; charset=utf-8"),
}


def run_fleet(robots: Path, port: int = FLEET_PORT) -> int:
    """Serve the page of the robots that a file names; the process's exit code."""
    return run_program(PROGRAM, lambda: lambda: _serve(robots, port, load_settings({})))


def fleet_server(watch: FleetWatch, port: int) -> HttpServer:
    """The page and what it asks for. Raises `InvalidValue` where it cannot listen."""
    pages = {path: _page(*static) for path, static in _STATIC.items()}
    pages["/robots"] = lambda: json_page({"robots": watch.as_json()})
    return HttpServer(pages, LOOPBACK, port, setting="fleet_port", name="edgevox-fleet-page")


def _page(name: str, content_type: str) -> Callable[[], Page]:
    body = files("edgevox.apps.fleet").joinpath("page", name).read_bytes()
    page = Page(body, content_type)
    return lambda: page


def _serve(robots: Path, port: int, settings: Settings) -> bool:
    watch = FleetWatch(load_fleet(robots))
    set_up_logs(PROGRAM, settings)
    with ExitStack() as stack, ShutdownSignals(settings.leave_s):
        server = fleet_server(watch, port)
        for part in (watch, server):
            stack.callback(part.close)
            part.start()
        print(f"{len(watch.as_json())} robots on http://localhost:{server.port}", flush=True)
        threading.Event().wait()
    return True
