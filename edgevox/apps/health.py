"""`edgevox-health`: asks a node that runs on this machine whether it is well; 0 if it is, else 1.

With `--drain` it has an agent let what moves come to its end and begin nothing new, and waits until
its robot stands. Run every few seconds by container engines, it imports nothing that is slow to
import.
"""

import argparse
import http.client
import ipaddress
import json
import os
import time
from collections.abc import Sequence

from edgevox.apps.streams import show, with_streams
from edgevox.core.files.text import one_line

WELL, UNWELL, USAGE_ERROR = 0, 1, 2
PORT, HOST = "EDGEVOX_HEALTH_PORT", "EDGEVOX_HEALTH_HOST"
LOOPBACK = {4: "127.0.0.1", 6: "::1"}
TIMEOUT_S = 3.0
DRAIN = "/drain"
LOOK_S = 0.2
"""Seconds between two looks at a drain."""
MARGIN_S = 2.0
"""Seconds to wait for a drain beyond its own estimate."""


@with_streams("edgevox-health")
def main(argv: Sequence[str] | None = None) -> int:
    """Ask; the process's exit code."""
    arguments = _parser().parse_args(argv)
    if not 0 < arguments.port < 1 << 16:
        show(f"edgevox-health: {PORT} or --port: a port from 1 to 65535", error=True)
        return USAGE_ERROR
    look = _drain if arguments.path == DRAIN else _ask
    try:
        status, text = look(reachable(arguments.host), arguments.port, arguments.path)
    except (OSError, http.client.HTTPException) as error:
        show(f"edgevox-health: {arguments.host}:{arguments.port}: {error}", error=True)
        return UNWELL
    show(one_line(_readable(text)))
    return WELL if status == http.client.OK else UNWELL


def reachable(host: str) -> str:
    """The address to ask where a node listens at this one: on all addresses is on loopback, too."""
    try:
        address = ipaddress.ip_address(host)
    except ValueError:
        return host
    return LOOPBACK[address.version] if address.is_unspecified else host


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="edgevox-health", description="Ask a node on this machine whether it is healthy."
    )
    what = parser.add_mutually_exclusive_group()
    for name, about in (
        ("live", "can it work, or should it be restarted?"),
        ("ready", "is everything loaded and started? (default)"),
        ("drain", "start nothing new, and wait until the robot stands; this cannot be undone"),
    ):
        what.add_argument(
            f"--{name}",
            dest="path",
            action="store_const",
            const=f"/{name}",
            default="/ready",
            help=about,
        )
    parser.add_argument(
        "--port",
        type=int,
        default=os.environ.get(PORT, "0"),
        help=f"where it listens ({PORT})",
    )
    parser.add_argument(
        "--host",
        default=os.environ.get(HOST) or LOOPBACK[4],
        help=f"where it listens ({HOST})",
    )
    return parser


def _drain(host: str, port: int, path: str) -> tuple[int, str]:
    """Begin it, and ask until it is over or later than it said. Raises where the agent has gone."""
    status, text = _ask(host, port, path, "PUT")
    until_s = time.monotonic() + _within_s(text) + MARGIN_S
    while status == http.client.ACCEPTED and time.monotonic() < until_s:
        time.sleep(LOOK_S)
        status, text = _ask(host, port, path)
    return status, text


def _within_s(text: str) -> float:
    try:
        return float(json.loads(text)["within_s"])
    except (ValueError, KeyError, TypeError, RecursionError):
        return 0.0


def _ask(host: str, port: int, path: str, method: str = "GET") -> tuple[int, str]:
    connection = http.client.HTTPConnection(host, port, timeout=TIMEOUT_S)
    try:
        connection.request(method, path)
        answer = connection.getresponse()
        return answer.status, answer.read(1 << 16).decode("utf-8", "replace")
    finally:
        connection.close()


def _readable(text: str) -> str:
    """Return one line: the status, and the result of each check."""
    try:
        report = json.loads(text)
        checks = ", ".join(f"{k} {v}" for k, v in report.get("checks", {}).items())
        return f"{report['status']}: {checks}" if checks else str(report["status"])
    except (ValueError, KeyError, TypeError, AttributeError, RecursionError):
        return text.strip()[:500]
