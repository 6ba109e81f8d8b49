"""What Fast DDS makes of its servers' list, and who is found by it."""

import os
import socket
import subprocess
import sys
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager

import pytest
from discovery_server import discovery_server
from guards import HUNG_S

pytestmark = pytest.mark.long

ENTRYPOINT = (sys.executable, "-m", "edgevox.apps.container.start")
TALKS = """
import rclpy
from std_msgs.msg import String
rclpy.init()
node = rclpy.create_node("talker")
publisher = node.create_publisher(String, "said", 10)
node.create_timer(0.1, lambda: publisher.publish(String(data="hello")))
rclpy.spin(node)
"""
LISTENS = """
import sys, time, rclpy
from std_msgs.msg import String
rclpy.init()
node = rclpy.create_node("listener")
heard = []
node.create_subscription(String, "said", heard.append, 10)
until = time.monotonic() + float(sys.argv[1])
while not heard and time.monotonic() < until:
    rclpy.spin_once(node, timeout_sec=0.1)
print("heard" if heard else "nothing")
"""
SHORT_S = "5"
"""Far more than what being found takes, where it happens at all."""


def _environment(servers: str, domain: int) -> dict[str, str]:
    """A container's index of packages names the middlewares; here there is none before rclpy is."""
    ours = ("EDGEVOX_", "RMW_", "ROS_")
    others = {name: value for name, value in os.environ.items() if not name.startswith(ours)}
    given = {"ROS_DISCOVERY_SERVER": servers, "ROS_DOMAIN_ID": str(domain)}
    return others | given | {"EDGEVOX_PEERS_WAIT_S": "0", "FASTDDS_BUILTIN_TRANSPORTS": "UDPv4"}


def _free_port() -> int:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as one:
        one.bind(("127.0.0.1", 0))
        return one.getsockname()[1]


@contextmanager
def _talker(servers: str, domain: int) -> Iterator[None]:
    command = [*ENTRYPOINT, sys.executable, "-c", TALKS]
    with subprocess.Popen(command, env=_environment(servers, domain)) as one:
        try:
            yield
        finally:
            one.kill()


def _hears(servers: str, domain: int, *command: str, seconds: str = str(HUNG_S / 2)) -> bool:
    ran = subprocess.run(
        [*command, sys.executable, "-c", LISTENS, seconds],
        env=_environment(servers, domain),
        capture_output=True,
        text=True,
        check=True,
        timeout=HUNG_S,
    )
    return ran.stdout.endswith("heard\n")


@pytest.fixture
def ports() -> Iterator[tuple[int, int]]:
    """Those of two servers, numbers 0 and 1."""
    with ExitStack() as servers:
        both = _free_port(), _free_port()
        for number, port in enumerate(both):
            servers.enter_context(discovery_server(number, port))
        yield both


def test_the_entrypoint_keeps_the_server_that_is_there_in_its_place(domain, ports) -> None:
    both = ";".join(f"127.0.0.1:{port}" for port in ports)
    one_has_no_address = f"nobody.invalid:{ports[0]};127.0.0.1:{ports[1]}"
    in_the_first_place = f"127.0.0.1:{ports[1]}"

    with _talker(both, domain):
        assert _hears(both, domain, *ENTRYPOINT)
        assert _hears(one_has_no_address, domain, *ENTRYPOINT)
        # Without it the middleware takes none of the list, nor a server in another's place.
        assert not _hears(one_has_no_address, domain, seconds=SHORT_S)
        assert not _hears(in_the_first_place, domain, *ENTRYPOINT, seconds=SHORT_S)


def test_a_domain_keeps_nobody_apart_who_asks_the_same_server(domain, ports) -> None:
    with _talker(f"127.0.0.1:{ports[0]}", domain):
        assert _hears(f"127.0.0.1:{ports[0]}", domain + 1, *ENTRYPOINT)


def test_who_asks_a_server_is_not_found_by_multicast(domain, ports) -> None:
    with _talker(f"127.0.0.1:{ports[0]}", domain):
        assert not _hears("", domain, *ENTRYPOINT, seconds=SHORT_S)
