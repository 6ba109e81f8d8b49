"""`edgevox-security`: who is let in to a robot's ROS 2, by DDS security.

It works on a keystore, which stays with whoever runs the robots; robots and laptops get exports.
"""

import argparse
import base64
import os
import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import yaml

from edgevox import __version__
from edgevox.apps.run_program import run_program
from edgevox.apps.streams import show, with_streams
from edgevox.core.errors import EdgeVoxError, InvalidValue, install_extra
from edgevox.core.settings import check_settings
from edgevox.ros2.open import LAST_DOMAIN, domain_of

if TYPE_CHECKING:
    from edgevox.security.keystore import Keystore

ROLES = ("robot", "recorder", "tools", "listener")
MOST_DAYS = 36500
WARN_DAYS = 30


@with_streams("edgevox-security", results=True)
def main(argv: Sequence[str] | None = None) -> int:
    """Do what is asked; the process's exit code."""
    return run_program("edgevox-security", lambda: _prepare(sys.argv[1:] if argv is None else argv))


def _prepare(argv: Sequence[str]) -> Callable[[], bool]:
    arguments = _parser().parse_args(argv)

    def run() -> bool:
        try:
            return bool(arguments.run(arguments))
        except ModuleNotFoundError as error:
            if error.name != "cryptography":
                raise
            expected = install_extra("console")
            raise EdgeVoxError(f"cryptography: not here, expected {expected}") from None
        except OSError as error:
            where = error.filename or arguments.keystore
            raise EdgeVoxError(f"{where}: {error.strerror or error}") from None

    return run


def _create(arguments: argparse.Namespace) -> bool:
    """Make a keystore with its own certificate authority."""
    from edgevox.core.certificates import utc_now
    from edgevox.security.keystore import AUTHORITY_DAYS, Keystore

    made = Keystore.create(arguments.keystore, utc_now(), arguments.days or AUTHORITY_DAYS)
    ends = made.authority.not_valid_after_utc
    show(f"{arguments.keystore}: made; its authority ends {ends:%Y-%m-%d}")
    return True


def _add(arguments: argparse.Namespace) -> bool:
    """Add an enclave for a robot, a recorder, a shell with tools, or a listener."""
    from edgevox.core.certificates import utc_now
    from edgevox.security.keystore import DAYS, Purpose
    from edgevox.security.roles import EXTERNAL_ROBOT, EnclaveRole, Graph, node_name

    store = _open(arguments)
    if arguments.robot_file and arguments.robot != EXTERNAL_ROBOT:
        raise InvalidValue("--robot-file", str(arguments.robot_file), f"--robot {EXTERNAL_ROBOT}")
    settings = check_settings(
        {"agent_namespace": arguments.namespace, "robot_namespace": arguments.robot_namespace}
    )
    file = arguments.robot_file and arguments.robot_file.absolute()
    graph = Graph(settings.agent_namespace, _robot(arguments), settings.robot_namespace, file)
    role = EnclaveRole(arguments.role)
    enclave = arguments.enclave or graph.at(node_name(role))
    store.add(enclave, Purpose(role, graph, _domain(arguments), arguments.days or DAYS), utc_now())
    show(_line(store, enclave))
    return True


def _list(arguments: argparse.Namespace) -> bool:
    """List enclaves and when they expire; fails if one has expired or will within --warn-days."""
    store = _open(arguments)
    ends = store.authority.not_valid_after_utc
    show(f"{'authority':40}  {'':8}  {'':10}  until {ends:%Y-%m-%d}")
    for enclave in store.names():
        show(_line(store, enclave))
    late = _late(store, arguments.warn_days)
    for said in late:
        show(f"edgevox-security: {said}", error=True)
    return not late


def _renew(arguments: argparse.Namespace) -> bool:
    """Give enclaves new keys, certificates and permissions; then export each again."""
    from edgevox.core.certificates import utc_now

    store = _open(arguments)
    if bool(arguments.enclave) == arguments.all:
        raise InvalidValue("ENCLAVE", " ".join(arguments.enclave), "some enclaves, or --all")
    chosen = store.names() if arguments.all else arguments.enclave
    for enclave in chosen:
        store.purpose(enclave)  # all are there, before one is changed
    for enclave in chosen:
        store.renew(enclave, utc_now(), arguments.days)
        show(_line(store, enclave))
    return True


def _revoke(arguments: argparse.Namespace) -> bool:
    """Revoke enclaves; then export and restart the others."""
    from edgevox.core.certificates import utc_now

    store = _open(arguments)
    for enclave in arguments.enclave:
        store.at(enclave)
    for enclave in dict.fromkeys(arguments.enclave):
        store.revoke(enclave, utc_now())
        show(f"{enclave}: revoked")
    left = " ".join(store.names())
    if left:
        show(f"Re-export and restart these enclaves to enforce the revocation: {left}")
    return True


def _export(arguments: argparse.Namespace) -> bool:
    """Write the keystore of one participant, or a Kubernetes Secret with it."""
    from edgevox.security.keystore import write_export

    files = _open(arguments).export(arguments.enclave)
    if bool(arguments.dir) == arguments.kubernetes:
        raise InvalidValue("DIR", str(arguments.dir or ""), "a folder, or --kubernetes without one")
    if arguments.kubernetes:
        show(secret(files, arguments.enclave, arguments.name).removesuffix("\n"))
        return True
    write_export(files, arguments.enclave, arguments.dir)
    show(f"{arguments.dir}: {arguments.enclave}")
    return True


def _open(arguments: argparse.Namespace) -> "Keystore":
    from edgevox.security.keystore import Keystore

    return Keystore(arguments.keystore)


def _robot(arguments: argparse.Namespace) -> str:
    from edgevox.apps.robots import ROBOTS

    if arguments.robot not in ROBOTS:
        raise InvalidValue("--robot", arguments.robot, "one of " + ", ".join(ROBOTS))
    return str(arguments.robot)


def _domain(arguments: argparse.Namespace) -> int:
    return int(arguments.domain) if arguments.domain is not None else domain_of(os.environ)


def _line(store: "Keystore", enclave: str) -> str:
    ends = store.certificate(enclave).not_valid_after_utc
    try:
        purpose = store.purpose(enclave)
    except InvalidValue:  # another tool's
        return f"{enclave:40}  {'':8}  {'':10}  until {ends:%Y-%m-%d}"
    return f"{enclave:40}  {purpose.role:8}  domain {purpose.domain:<3}  until {ends:%Y-%m-%d}"


def _late(store: "Keystore", within_days: int) -> list[str]:
    from edgevox.core.certificates import utc_now

    certificates = {"authority": store.authority}
    certificates |= {enclave: store.certificate(enclave) for enclave in store.names()}
    left = {who: one.not_valid_after_utc - utc_now() for who, one in certificates.items()}
    return [
        f"{who}: ended" if time.total_seconds() <= 0 else f"{who}: ends in {time.days} days"
        for who, time in left.items()
        if time.days < within_days
    ]


def _number(least: int, most: int) -> Callable[[str], int]:
    def read(text: str) -> int:
        if text.isdecimal() and least <= int(text) <= most:
            return int(text)
        raise argparse.ArgumentTypeError(f"got {text!r}, expected {least} to {most}")

    return read


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser("edgevox-security", description=__doc__)
    parser.add_argument("--version", action="version", version=__version__)
    verbs = parser.add_subparsers(required=True, metavar="COMMAND")

    def verb(name: str, run: Callable[[argparse.Namespace], bool]) -> argparse.ArgumentParser:
        one = verbs.add_parser(name, help=run.__doc__, description=run.__doc__)
        one.add_argument("keystore", type=Path, metavar="KEYSTORE")
        one.set_defaults(run=run)
        return one

    days = _number(1, MOST_DAYS)
    create = verb("create", _create)
    create.add_argument("--days", type=days, help="days that the authority is valid (3650)")
    _add_arguments(verb("add", _add), days)
    listing = verb("list", _list)
    listing.add_argument("--warn-days", type=_number(0, MOST_DAYS), default=WARN_DAYS)
    renew = verb("renew", _renew)
    renew.add_argument("enclave", nargs="*", metavar="ENCLAVE", help="enclave from `list`")
    renew.add_argument("--all", action="store_true", help="all enclaves")
    renew.add_argument("--days", type=days, help="days that they are valid from now")
    revoke = verb("revoke", _revoke)
    revoke.add_argument("enclave", nargs="+", metavar="ENCLAVE", help="enclave from `list`")
    export = verb("export", _export)
    export.add_argument("enclave", metavar="ENCLAVE", help="enclave from `list`")
    export.add_argument("dir", nargs="?", type=Path, metavar="DIR", help="ROS_SECURITY_KEYSTORE")
    export.add_argument("--kubernetes", action="store_true", help="print a Secret's manifest")
    export.add_argument("--name", default="", help="name of that Secret")
    return parser


def _add_arguments(add: argparse.ArgumentParser, days: Callable[[str], int]) -> None:
    add.add_argument("role", choices=ROLES, metavar="|".join(ROLES))
    add.add_argument(
        "--namespace", default="/edgevox", help="namespace of the agent's node (/edgevox)"
    )
    add.add_argument("--robot", default="robot-apartment", help="robot (robot-apartment)")
    add.add_argument(
        "--robot-namespace",
        default="/",
        metavar="NS",
        help="robot-external: namespace of its topics",
    )
    add.add_argument(
        "--robot-file", type=Path, metavar="FILE", help="robot-external: the robot file"
    )
    add.add_argument(
        "--domain", type=_number(0, LAST_DOMAIN), metavar="N", help="default: ROS_DOMAIN_ID, or 0"
    )
    add.add_argument("--days", type=days, help="days that its certificate is valid (365)")
    add.add_argument(
        "--enclave", default="", metavar="PATH", help="another name, such as /edgevox/annas_laptop"
    )


def secret_name(enclave: str) -> str:
    """What the Secret of an enclave is called: ``edgevox-security-robot1-edgevox``."""
    return "edgevox-security" + enclave.replace("/", "-").replace("_", "-").lower()


def secret(files: dict[str, bytes], enclave: str, name: str = "") -> str:
    """The manifest of a Kubernetes Secret whose keys are the files of an enclave.

    Raises `InvalidValue` for a bad name.
    """
    called = name or secret_name(enclave)
    allowed = called.replace("-", "a").replace(".", "a")
    if not (allowed.isascii() and allowed.isalnum() and allowed == allowed.lower()):
        raise InvalidValue("--name", called, "lower-case letters, digits and dashes")
    manifest = {
        "apiVersion": "v1",
        "kind": "Secret",
        "metadata": {"name": called, "annotations": {"edgevox/enclave": enclave}},
        "type": "Opaque",
        "data": {key: base64.b64encode(data).decode() for key, data in files.items()},
    }
    return yaml.safe_dump(manifest, sort_keys=False)
