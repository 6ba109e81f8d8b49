"""A fleet's page, behind the console's door: encryption, pairing, roles, and its own name only."""

import threading
from contextlib import ExitStack
from pathlib import Path

from aiohttp import web

from edgevox.apps.console_command import shown_code
from edgevox.apps.fleet.watch import FleetWatch, load_fleet
from edgevox.apps.folders import console_folder
from edgevox.apps.run_program import ShutdownSignals
from edgevox.apps.streams import show
from edgevox.console.certificates import Tls
from edgevox.console.console_server import names_of, tls_of
from edgevox.console.page_files import PageFiles
from edgevox.console.page_server import PageServer
from edgevox.console.sessions import Role
from edgevox.core.clock import Clock
from edgevox.core.files.state_files import StateFiles
from edgevox.core.settings import Settings

PAGE = Path(__file__).parent / "page"
NAME = "edgevox-fleet-page"


def serve_fleet(robots: Path, port: int, settings: Settings) -> bool:
    """Serve the page of the robots that a file names, until somebody leaves.

    Raises `InvalidValue` for a file that is wrong and for a port that is taken.
    """
    watch = FleetWatch(load_fleet(robots))
    folder, state = console_folder(settings), StateFiles()
    with ExitStack() as stack, ShutdownSignals(settings.leave_s):
        server = fleet_server(
            watch,
            folder,
            settings.console_host,
            port,
            tls=tls_of(settings, folder, state),
            names=settings.console_names,
            hosts=frozenset({*names_of(settings), settings.console_host}),
            state=state,
        )
        for part in (watch, server):
            stack.callback(part.close)
            part.start()
        show(f"{len(watch.as_json())} robots on {server.url}")
        code, _ = server.offer_code(Role.VIEWER)
        show(shown_code(server.url, code.code, code.shown, str(code.role)))
        threading.Event().wait()
    return True


def fleet_server(
    watch: FleetWatch,
    folder: Path,
    host: str,
    port: int,
    *,
    tls: Tls | None = None,
    names: str = "",
    hosts: frozenset[str],
    clock: Clock | None = None,
    state: StateFiles | None = None,
) -> PageServer:
    """The page and what it asks for. Raises `InvalidValue` where it cannot listen.

    `hosts` are the names and addresses by which a browser may ask for it.
    """
    server = PageServer(
        folder,
        host,
        port,
        name=NAME,
        setting="robots_port",
        files=PageFiles(PAGE),
        tls=tls,
        names=names,
        clock=clock,
        state=state,
        cookie="edgevox-fleet",
        hosts=hosts,
    )
    access = server.access

    async def robots(request: web.Request) -> web.Response:
        access.session(request)
        return web.json_response({"robots": watch.as_json()}, headers={"Cache-Control": "no-store"})

    def application() -> web.Application:
        app = access.application()
        app.router.add_get("/robots", robots)
        return app

    server.serve(application)
    return server
