"""`edgevox-console`: lets browsers in to a robot's console, lists them, and shows them out.

It works on the console's folder, whether the robot runs or not: a robot that runs notices.
"""

import argparse
import sys
from collections.abc import Callable, Sequence
from datetime import UTC, datetime
from pathlib import Path

from edgevox import __version__
from edgevox.apps.flags import add_flags, given_flags
from edgevox.apps.folders import console_folder
from edgevox.apps.run_program import run_program
from edgevox.apps.streams import show, with_streams
from edgevox.core.errors import EdgeVoxError, InvalidValue, install_extra
from edgevox.core.files.text import one_line
from edgevox.core.settings import Settings, load_settings

FLEET_PORT = 8440
SETTINGS = (
    *("console_host", "console_port", "console_tls", "console_names", "console_folder"),
    *("console_certificate", "console_key", "console_plain"),
)


@with_streams("edgevox-console")
def main(argv: Sequence[str] | None = None) -> int:
    """Do what is asked; the process's exit code."""
    return run_program("edgevox-console", lambda: _prepare(sys.argv[1:] if argv is None else argv))


def _prepare(argv: Sequence[str]) -> Callable[[], bool]:
    parser = _parser()
    arguments = parser.parse_args(argv)
    settings = load_settings(given_flags(arguments), arguments.config)
    if arguments.robots:
        return lambda: _serve_fleet(arguments.robots, arguments.robots_port, settings)
    if not arguments.run:
        parser.error("a COMMAND, or --robots FILE")
    folder = console_folder(settings)

    def run() -> bool:
        try:
            return bool(arguments.run(arguments, settings, folder))
        except OSError as error:
            raise EdgeVoxError(f"console_folder: {folder}: {error.strerror or error}") from None

    return run


def _serve_fleet(robots: Path, port: int, settings: Settings) -> bool:
    try:
        from edgevox.apps.fleet.serve import serve_fleet
    except ModuleNotFoundError as error:
        raise EdgeVoxError(f"{error.name}: not here, expected {install_extra('console')}") from None
    folder = console_folder(settings)
    try:
        return serve_fleet(robots, port, settings)
    except OSError as error:
        raise EdgeVoxError(f"console_folder: {folder}: {error.strerror or error}") from None


def _pair(arguments: argparse.Namespace, settings: Settings, folder: Path) -> bool:
    from edgevox.console.certificates import console_url
    from edgevox.console.sessions import Pairing, Role

    role = Role.VIEWER if arguments.viewer else Role.OPERATOR
    if arguments.phone:
        return _pair_phone(arguments, settings, folder)
    code = Pairing(folder).offer(role)
    host, port, names = settings.console_host, settings.console_port, settings.console_names
    url = console_url(host, port, settings.console_tls != "off", names)
    show(shown_code(url, code.code, code.shown, str(role)))
    return True


def _pair_phone(arguments: argparse.Namespace, settings: Settings, folder: Path) -> bool:
    from edgevox.apps.console.phone import NotOpen, pair_phone
    from edgevox.console.sessions import Role

    def agree(url: str) -> bool:
        if arguments.open or not sys.stdin.isatty():
            return bool(arguments.open)
        show(f"The console answers on this machine only. Open it to this network, at {url}?")
        show("A browser still needs a code. `edgevox-console close` closes it again. [y/N]")
        return sys.stdin.readline().strip().lower() in ("y", "yes")

    role = Role.VIEWER if arguments.viewer else Role.OPERATOR
    try:
        one = pair_phone(settings, folder, role, agree)
    except NotOpen as error:
        raise EdgeVoxError(f"{error}: --open") from None
    show(shown_code(one.url, one.code.code, one.code.shown, str(role), phone=True))
    return True


def _close(_arguments: argparse.Namespace, _settings: Settings, folder: Path) -> bool:
    from edgevox.console.sessions import Opened

    show("Closed to the network." if Opened(folder).close() else "It was not opened.")
    return True


def shown_code(url: str, code: str, shown: str, role: str, *, phone: bool = False) -> str:
    """A pairing code as a terminal shows it, with a QR code for a phone's camera.

    A page that a `phone` opens so offers sound and control at once.
    """
    import io

    address = f"{url}/#pair={code}{'&phone' if phone else ''}"
    text = io.StringIO()
    try:
        import segno
    except ModuleNotFoundError:
        raise EdgeVoxError(f"segno: not here, expected {install_extra('console')}") from None
    segno.make(address, micro=False).terminal(text, border=2, compact=True)
    return f"{text.getvalue()}\n{address}\ncode {shown}, once, as {role}, for ten minutes"


def _list(_arguments: argparse.Namespace, _settings: Settings, folder: Path) -> bool:
    from edgevox.console.sessions import Sessions

    for one in Sessions(folder).all():
        began = datetime.fromtimestamp(one.began_s, UTC)
        line = f"{one.id}  {one.role:8}  {began:%Y-%m-%d %H:%M}Z  {one.address:15}  {one.name}"
        show(one_line(line))
    return True


def _revoke(arguments: argparse.Namespace, _settings: Settings, folder: Path) -> bool:
    from edgevox.console.sessions import Sessions

    sessions = Sessions(folder)
    if arguments.all:
        for one in sessions.all():
            sessions.revoke(one.id)
        return True
    for name in arguments.id:
        if not sessions.revoke(name):
            raise InvalidValue("id", name, "one of edgevox-console list")
    return True


def _ca(arguments: argparse.Namespace, settings: Settings, folder: Path) -> bool:
    from edgevox.console.certificates import own_tls
    from edgevox.console.console_server import found_names, names_of

    if arguments.new:
        for name in ("ca.crt", "ca.key", "console.crt", "console.key"):
            (folder / name).unlink(missing_ok=True)
    authority = own_tls(folder, names_of(settings), spare=found_names(settings)).authority
    if authority:
        show(authority.read_text("utf-8").removesuffix("\n"))
    return True


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="edgevox-console",
        description="Pair browsers with a robot's console, list them and revoke them.",
    )
    parser.add_argument("--version", action="version", version=__version__)
    add_flags(parser, SETTINGS)
    parser.add_argument(
        "--robots",
        type=Path,
        metavar="FILE",
        help="without COMMAND: serve a page with the health of these robots, to paired browsers",
    )
    parser.add_argument(
        "--robots-port", type=int, default=FLEET_PORT, metavar="PORT", help="port of that page"
    )
    parser.set_defaults(run=None)
    verbs = parser.add_subparsers(metavar="COMMAND")
    pair = verbs.add_parser("pair", help="make a code that lets one browser in")
    pair.add_argument(
        "--viewer", action="store_true", help="the browser may only watch and stop the robot"
    )
    pair.add_argument(
        "--phone",
        action="store_true",
        help="find the address by which a phone reaches the running robot, and offer to open the"
        " console there",
    )
    pair.add_argument(
        "--open", action="store_true", help="with --phone: open it without a question"
    )
    pair.set_defaults(run=_pair)
    verbs.add_parser("close", help="close the console to the network again").set_defaults(
        run=_close
    )
    verbs.add_parser("list", help="list the paired browsers").set_defaults(run=_list)
    revoke = verbs.add_parser("revoke", help="revoke a browser's pairing")
    which = revoke.add_mutually_exclusive_group(required=True)
    which.add_argument("id", nargs="*", default=[], metavar="ID", help="id from `list`")
    which.add_argument("--all", action="store_true", help="all browsers")
    revoke.set_defaults(run=_revoke)
    ca = verbs.add_parser("ca", help="print the CA certificate for browsers to trust")
    ca.add_argument("--new", action="store_true", help="make a new CA; each browser must trust it")
    ca.set_defaults(run=_ca)
    return parser
