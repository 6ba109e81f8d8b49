"""`edgevox-health`: asks a node that runs on this machine whether it is well; 0 if it is, else 1.

With `--drain` it has an agent let what moves come to its end and begin nothing new, and waits until
its robot stands. With `--end-frozen` it kills an agent that is frozen, and the container's restart
policy starts it again: Docker restarts what ended, and not what is only unhealthy. Run every few
seconds by container engines, it imports nothing that is slow to import.
"""

import argparse
import http.client
import ipaddress
import json
import os
import re
import signal
import time
from collections.abc import Iterator, Sequence
from contextlib import suppress
from pathlib import Path

from edgevox.apps.streams import show, with_streams
from edgevox.core.files.text import one_line

WELL, UNWELL, USAGE_ERROR = 0, 1, 2
PORT, HOST = "EDGEVOX_HEALTH_PORT", "EDGEVOX_HEALTH_HOST"
LOOPBACK = {4: "127.0.0.1", 6: "::1"}
TIMEOUT_S = 3.0
FROZEN_TIMEOUT_S = 1.2
"""With `--end-frozen` a health check asks twice, and must have ended before its engine ends it."""
FROZEN_S = 15.0
"""An agent whose `/live` does not pass for this long is frozen."""
AGENT = re.compile(r"^Name:\t(edgevox|edgevox-agent)$.*^PPid:\t1$", re.MULTILINE | re.DOTALL)
"""What /proc tells of the program of a container, and not of one that somebody's shell started."""
FROZEN_NOTE = Path("/tmp/edgevox-health-frozen")  # noqa: S108 - a container's own
"""Not there before the agent has passed once. Its time is when the agent passed no more, by the
machine's monotonic clock, and 0 while it passes. It is empty, since a full /tmp has room for that;
`tempfile.gettempdir` would fail there."""
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
    look = _drain if arguments.path == DRAIN else ask
    host = reachable(arguments.host)
    try:
        timeout_s = FROZEN_TIMEOUT_S if arguments.end_frozen else TIMEOUT_S
        status, text = look(host, arguments.port, arguments.path, timeout_s=timeout_s)
    except (OSError, http.client.HTTPException) as error:
        show(f"edgevox-health: {arguments.host}:{arguments.port}: {error}", error=True)
        status = 0
    else:
        show(one_line(_readable(text)))
    if arguments.end_frozen:
        answered = bool(status) and (status == http.client.OK or _lives(host, arguments.port))
        note_frozen(answered, time.monotonic())
    return WELL if status == http.client.OK else UNWELL


def _lives(host: str, port: int) -> bool:
    try:
        return ask(host, port, "/live", timeout_s=FROZEN_TIMEOUT_S)[0] == http.client.OK
    except (OSError, http.client.HTTPException):
        return False


def note_frozen(lives: bool, now_s: float) -> None:
    """Note since when the agent is frozen; kill it if that is too long ago."""
    try:
        since_s = FROZEN_NOTE.stat().st_mtime
    except OSError:
        since_s = None
    with suppress(OSError):  # without a note nothing is killed
        if lives and since_s != 0:
            FROZEN_NOTE.touch()
            os.utime(FROZEN_NOTE, (0, 0))
        elif not lives and since_s == 0:
            os.utime(FROZEN_NOTE, (now_s, now_s))
        elif not lives and since_s and now_s - since_s >= FROZEN_S:
            FROZEN_NOTE.unlink()
            for agent in agents_of_init():
                os.kill(agent, signal.SIGKILL)
            show(f"edgevox-health: frozen for {FROZEN_S:g} s; killed it", error=True)


def agents_of_init(proc: Path = Path("/proc")) -> Iterator[int]:
    """The agents that process 1 started."""
    for status in proc.glob("[0-9]*/status"):
        with suppress(OSError):
            if AGENT.search(status.read_text("utf-8", "replace")):
                yield int(status.parent.name)


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
        "--end-frozen",
        action="store_true",
        help=f"in a container: kill an agent that was alive, and is frozen for {FROZEN_S:g} s",
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


def _drain(host: str, port: int, path: str, *, timeout_s: float) -> tuple[int, str]:
    """Begin it, and ask until it is over or later than it said. Raises where the agent has gone."""
    status, text = ask(host, port, path, "PUT", timeout_s=timeout_s)
    until_s = time.monotonic() + _within_s(text) + MARGIN_S
    while status == http.client.ACCEPTED and time.monotonic() < until_s:
        time.sleep(LOOK_S)
        status, text = ask(host, port, path, timeout_s=timeout_s)
    return status, text


def _within_s(text: str) -> float:
    try:
        return float(json.loads(text)["within_s"])
    except (ValueError, KeyError, TypeError, RecursionError):
        return 0.0


def ask(
    host: str,
    port: int,
    path: str,
    method: str = "GET",
    *,
    timeout_s: float,
    most_bytes: int = 1 << 16,
) -> tuple[int, str]:
    """A program's answer: its HTTP status, and what it says. Raises `OSError`, `HTTPException`."""
    connection = http.client.HTTPConnection(host, port, timeout=timeout_s)
    try:
        connection.request(method, path)
        answer = connection.getresponse()
        return answer.status, answer.read(most_bytes).decode("utf-8", "replace")
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
