"""What DDS security adds to a round trip.

Two processes of plain rclpy echo texts over UDP on loopback, encrypted and authenticated as
`edgevox-security` sets it up: one has a `tools` enclave, the other a `robot` enclave. A pair
without security takes turns with them on another domain. Needs a Fast DDS with security, as in the
official image; `tests/ros2/with_secure_dds` has one for tests.
"""

import os
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory

from peer import RELIABLE, Peer
from secured_rig import AGENT, new_keystore, security
from std_msgs.msg import String

from benchmarks import ROOT
from benchmarks.core.figures import Figure, Measured, NotHere
from benchmarks.core.talker import isolate
from edgevox.core.probe import probe_apart

TABLE = "A round trip over ROS 2, with DDS security and without"
SIZES = {100: "100 bytes", 4_000: "4 kB", 32_000: "32 kB"}
TOOLS, NAMESPACE, NODE = "/tools", "/edgevox", "edgevox"
SAID, ECHOED = "text_input", "response"
"""What tools may say to a robot, and it to them."""
PROBE = "edgevox.ros2.doctor:middleware_build"
FIRST = 20
"""Trips that do not count: what is discovered, exchanged and cached once."""


def measure(quick: bool = False) -> Measured:
    """Milliseconds by size; the pairs take turns, message by message."""
    if not probe_apart(PROBE)["security"]:
        raise NotHere("a Fast DDS with DDS security (tests/ros2/with_secure_dds)")
    trips = 50 if quick else 500
    with TemporaryDirectory() as folder:
        domain = isolate()
        keystore = new_keystore(Path(folder) / "keystore", domain + 1)
        with pair(domain, None) as plain, pair(domain + 1, keystore) as secured:
            return Measured(figures=tuple(figures({"plain": plain, "secured": secured}, trips)))


def figures(pairs: dict[str, "Pair"], trips: int) -> Iterator[Figure]:
    """A row for each size."""
    for size, what in SIZES.items():
        taken: dict[str, list[float]] = {name: [] for name in pairs}
        for _ in range(FIRST + trips):
            for name, one in pairs.items():
                taken[name].append(one.trip_ms(size))
        for name, column in (("plain", "without"), ("secured", "with")):
            yield Figure.of(
                f"trip.{size}.{name}", TABLE, what, taken[name][FIRST:], "ms", column=column,
                baseline="" if name == "plain" else f"trip.{size}.plain",
            )  # fmt: skip


class Pair:
    """A node that asks, of another one that echoes."""

    def __init__(self, peer: Peer) -> None:
        self._peer = peer
        self._heard = peer.listen(ECHOED, RELIABLE)

    def trip_ms(self, size: int) -> float:
        """How long a text of so many bytes takes to come back."""
        number, text = len(self._heard.messages), "x" * size
        begun_s = time.monotonic()
        self._peer.send(SAID, text)
        self._heard.wait_for(lambda _: True, since=number)
        return 1000 * (self._heard.times[number] - begun_s)


@contextmanager
def pair(domain: int, keystore: Path | None) -> Iterator[Pair]:
    """Both, in their enclaves of this keystore, or without security."""
    command = [sys.executable, "-m", "benchmarks.wire.security"]
    command += ["--ros-args", "--enclave", AGENT] if keystore else []
    asked = ["--ros-args", "--enclave", TOOLS] if keystore else None
    with security(keystore):
        environment = {**os.environ, "ROS_DOMAIN_ID": str(domain)}
        with subprocess.Popen(command, env=environment, cwd=ROOT) as other:
            peer = Peer(domain, name=TOOLS[1:], args=asked)
            try:
                yield Pair(peer)
            finally:
                peer.close()
                other.terminate()


def echo() -> None:
    """Be the other one, until it is ended."""
    import rclpy
    from rclpy.executors import ExternalShutdownException

    rclpy.init(args=sys.argv)
    node = rclpy.create_node(NODE, namespace=NAMESPACE)
    answers = node.create_publisher(String, ECHOED, RELIABLE)
    node.create_subscription(String, SAID, answers.publish, RELIABLE)
    try:
        rclpy.spin(node)
    except (ExternalShutdownException, KeyboardInterrupt):
        return


if __name__ == "__main__":
    echo()
