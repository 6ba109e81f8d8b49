"""What Fast DDS makes of its servers' list, and who is found by it."""

import os
import re
import shutil
import socket
import subprocess
import sys
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path

import pytest
from guards import HUNG_S
from waiting import wait_until

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


@contextmanager
def _server(number: int, port: int) -> Iterator[None]:
    """A discovery server of this machine; the wheels' own needs to be told where its library is."""
    prefix = Path(sys.prefix)
    folders = [*prefix.glob("lib/python3.*/site-packages/ros_*.libs"), prefix / "lib"]
    here = f"{prefix / 'bin'}{os.pathsep}{os.environ['PATH']}"
    library = os.pathsep.join([*map(str, folders), os.environ.get("LD_LIBRARY_PATH", "")])
    program = shutil.which("fast-discovery-server", path=here)
    assert program, "there is no fast-discovery-server beside ROS 2"
    command = [program, "-i", str(number), "-l", "127.0.0.1", "-p", str(port)]
    with subprocess.Popen(
        command, env=os.environ | {"LD_LIBRARY_PATH": library}, stdout=subprocess.DEVNULL
    ) as one:
        try:
            wait_until(lambda: _is_bound(port))
            yield
        finally:
            one.kill()


def _is_bound(port: int) -> bool:
    return bool(re.search(f":{port:04X} ", Path("/proc/net/udp").read_text("ascii")))


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
            servers.enter_context(_server(number, port))
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
